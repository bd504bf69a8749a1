// What perfect colours on the coarse forms of captured cuts would give: of the value that a cut loses, the share that is lost
// where both full detail and the form show something. No colour mends the rest. Forms are seen as from the eye, without
// perspective.
//   bench_perfect_colours MODEL.walk CAPTURE...
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/bake/form_picture.hpp"
#include "render/bake/picture_loss.hpp"
#include "render/capture/capture.hpp"
#include "render/model/model.hpp"
#include "render/model/walk_file.hpp"

using namespace surefoot;
using model::Index;

namespace {

constexpr std::uint32_t across_px = 64;

/// The greatest value that a candidate's subtree may have. A node whose children were not looked at is fine enough to count as
/// whole.
double full_value(const prepare::PreparedFrame& frame, Index candidate) {
    const prepare::Candidate& c = frame.candidates[candidate];
    if (c.child_count == 0 || c.first_child == model::none)
        return static_cast<double>(frame.choices[c.first_choice + c.choice_count - 1].value);
    double sum = 0;
    for (Index k = 0; k < c.child_count; ++k) sum += full_value(frame, c.first_child + k);
    return sum;
}

void draw_full_detail(const model::Model& m, const model::Node& node, bake::FormPicture& to) {
    if (node.child_count == 0) bake::draw_form(m, m.reps[node.first_rep + node.rep_count - 1], to);
    for (Index k = 0; k < node.child_count; ++k) draw_full_detail(m, m.nodes[node.first_child + k], to);
}

/// Of what a form loses as seen from the eye, the share that it loses where full detail shows something too. Negative: it loses
/// nothing.
double share_within(const model::Model& m, const select::CutItem& item, const dvec3& eye, double size_px) {
    const model::Node& node = m.nodes[item.node];
    const dvec3 to_eye = eye - node.box.centre();
    const auto from = bake::direction_of(std::atan2(to_eye.x, to_eye.z), std::atan2(to_eye.y, std::hypot(to_eye.x, to_eye.z)));
    const bake::FormView view = bake::view_of(node.box, from, node.box.centre(), across_px);
    bake::FormPicture full, form;
    full.clear(view);
    form.clear(view);
    draw_full_detail(m, node, full);
    bake::draw_form(m, m.reps[item.rep], form);
    bake::PictureDifference difference;
    difference.add(full, form);
    // The middle between two measured sizes, by their logarithm.
    const std::size_t level = size_px > 181 ? 0 : size_px > 22.6 ? 1 : 2;
    const double all =
        static_cast<double>(difference.loss(m.colours).colour[level]) * static_cast<double>(difference.full_detail);
    const double within = static_cast<double>(difference.both[level]) / (3.0 * 255 * 255);
    return all > 0 ? std::min(1.0, within / all) : -1.0;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) return fmt::print(stderr, "bench_perfect_colours MODEL.walk CAPTURE...\n"), 2;
    const auto m = model::read_walk(argv[1]);
    if (!m) return fmt::print(stderr, "{}\n", m.error().text()), 1;
    double lost = 0, within = 0;
    std::size_t forms = 0;
    for (int i = 2; i < argc; ++i) {
        const auto captured = capture::read_capture(argv[i]);
        if (!captured) return fmt::print(stderr, "{}\n", captured.error().text()), 1;
        const prepare::PreparedFrame& frame = captured->prepared;
        if (captured->node_count != m->nodes.size()) return fmt::print(stderr, "{} is of another model\n", argv[i]), 1;
        for (const select::CutItem& item : captured->items) {
            if (model::is_full_detail(m->nodes[item.node], item.rep, m->reps[item.rep].error_m)) continue;
            const double of_form = full_value(frame, item.candidate) - static_cast<double>(frame.choices[item.choice].value);
            if (of_form <= 0) continue;
            const double size_px = std::sqrt(static_cast<double>(frame.candidates[item.candidate].pixels));
            const double share = share_within(*m, item, frame.region.centre.position, size_px);
            if (share < 0) continue;
            lost += of_form;
            within += of_form * share;
            ++forms;
        }
    }
    if (lost <= 0) return fmt::print(stderr, "bench_perfect_colours: the captured cuts show all in full detail\n"), 77;
    fmt::print("{{\"captures\": {}, \"forms\": {}, \"within_percent\": {:.1f}, \"gain_db\": {:.2f}}}\n", argc - 2, forms,
               100 * within / lost, -10 * std::log10(std::max(1 - within / lost, 1e-9)));
    return 0;
}
