// A walk that spends triangles in place of time: costs of one us a triangle on the virtual clock.
#include <memory>

#include "render/model/cost.hpp"
#include "tools/accuracy/compare.hpp"

namespace surefoot::accuracy {

model::CostModel triangle_costs() {
    model::CostModel costs = model::default_costs();
    model::CostGrid grid;
    grid.triangle_steps = 2;
    grid.pixel_steps = 1;
    grid.cells = {{1, 0}, {2, 0}};  // beyond it the cost goes on as a line
    costs.grids = {grid};
    costs.combine = {0, 1, 0, 0};
    costs.headroom = 1;
    costs.slice_us = 0;
    costs.ns_per_pixel = 0;
    costs.enlarge_ns_per_pixel = 0;
    return costs;
}

namespace {
constexpr double us_a_ms = 1e3, half = 0.5;  // half a triangle more: a frame of exactly as many fits, whatever the rounding
}

double triangle_budget_ms(double triangles) { return (triangles + half) / us_a_ms; }
std::uint64_t triangles_of_budget(double budget_ms) { return static_cast<std::uint64_t>(budget_ms * us_a_ms); }

void spend_triangles(walk::WalkRequest& request) {
    request.given_costs = std::make_shared<const model::CostModel>(triangle_costs());
    request.clock = rt::ClockKind::virtual_time;
    request.correct_costs = false;
    request.in_frame_check = false;
    request.stills = true;  // else triangles are spent on what is beside the picture
    request.slice_us = 1e5;
    request.rest_after_ms = 0;
    request.hysteresis = 1;
    request.resolution_pct = 100;
    request.filter = rt::TextureFilter::bilinear;
}

}  // namespace surefoot::accuracy
