// Rows: the eye near and inside things, boxes against frustums of every shape, views of every size.
#include <array>
#include <cmath>
#include <limits>

#include "render/model/pixels.hpp"
#include "rt/base/random.hpp"
#include "tools/selftest/cut_fixture.hpp"
#include "tools/selftest/families.hpp"
#include "tools/selftest/separating.hpp"
#include "tools/selftest/shapes.hpp"
#include "tools/selftest/views.hpp"

namespace surefoot::selftest {

namespace {

constexpr double pi = 3.141592653589793;
constexpr double infinity = std::numeric_limits<double>::infinity();

void random_boxes(const Effort& effort, Outcome& out) {
    const std::uint64_t wanted = effort.count(10'000'000, 1000);
    Random random(9);
    std::uint64_t lost = 0, seen = 0, tried = 0;
    while (tried < wanted && !effort.stopped()) {
        const Pose pose = any_pose(random, 1000);
        const model::Viewport viewport = viewports[random.below(viewports.size())];
        const model::Frustum frustum = model::make_frustum(pose, viewport, 1000);
        const Pyramid pyramid = pyramid_of(pose, viewport);
        for (int i = 0; i < 100 && tried < wanted; ++i, ++tried) {
            Box box = any_box(random);
            box.min += pose.position;
            box.max += pose.position;
            const bool touches = overlap(pyramid, box) > touching;
            seen += touches ? 1 : 0;
            lost += touches && !model::visible(frustum, box) ? 1 : 0;
        }
    }
    out.none_of("visible boxes lost", lost);
    out.at_least("boxes that the exact test sees", static_cast<double>(seen), 0.1 * static_cast<double>(wanted));
    if (wanted < 10'000'000) out.scaled = std::to_string(wanted) + " boxes of 10000000";
    out.digest_of(seen);
    out.digest_of(lost);
}

/// Against the six planes alone, which keep large boxes beside the view.
void large_boxes(const Effort& effort, Outcome& out) {
    const std::uint64_t wanted = effort.count(300'000, 5000);
    Random random(10);
    std::uint64_t kept = 0, kept_by_planes = 0, unseen = 0;
    for (std::uint64_t i = 0; i < wanted && !effort.stopped(); ++i) {
        Pose pose;
        pose.position = {random.range(-50, 50), random.range(0, 20), random.range(-50, 50)};
        pose.orientation = any_turn(random);
        const dvec3 half{random.range(5, 100), random.range(5, 100), random.range(5, 100)};
        const dvec3 centre{random.range(-200, 200), random.range(-200, 200), random.range(-200, 200)};
        const Box box{centre - half, centre + half};
        if (overlap(pyramid_of(pose, {1280, 720}), box) > -touching) continue;
        ++unseen;
        const model::Frustum frustum = model::make_frustum(pose, {1280, 720}, 1000);
        kept += model::visible(frustum, box) ? 1 : 0;
        bool planes = true;
        for (const dvec4& p : frustum.planes) {
            const double reach = glm::dot(glm::abs(dvec3(p)), half);
            planes = planes && glm::dot(dvec3(p), centre) + p.w + reach >= 0;
        }
        kept_by_planes += planes ? 1 : 0;
    }
    out.at_least("large boxes outside the view", static_cast<double>(unseen), 0.1 * static_cast<double>(wanted));
    out.at_most("of them kept", static_cast<double>(kept) / static_cast<double>(std::max<std::uint64_t>(1, unseen)), 0.03);
    out.at_most("of those that the planes alone keep",
                static_cast<double>(kept) / static_cast<double>(std::max<std::uint64_t>(1, kept_by_planes)), 0.2);
}

/// Fields of view, sizes and poses at the ends of what numbers can say: what follows from a view must be finite.
void odd_views(const Effort&, Outcome& out) {
    std::uint64_t bad = 0, tried = 0;
    const double nan = std::nan("");
    for (const double fov : {0.0, -1.0, 1e-300, 1e-9, pi / 180, 1.0, 179 * pi / 180, pi, 4.0, 1e300, infinity, -infinity, nan}) {
        for (const model::Viewport viewport :
             {model::Viewport{0, 0}, {1, 1}, {8192, 1}, {1, 8192}, {16384, 16384}, {0xffffffffU, 1}, {1, 0xffffffffU}}) {
            Pose pose;
            pose.fov_y_rad = fov;
            ++tried;
            const bool fine = sound_view(pose, viewport) && model::visible(model::make_frustum(pose, viewport, 1000),
                                                                           {dvec3(-0.01, -0.01, -12), dvec3(0.01, 0.01, -10)});
            bad += fine ? 0 : 1;
        }
    }
    out.none_of("views with a number that is not finite and positive, or that lose what is straight ahead", bad);
    out.at_least("views", static_cast<double>(tried), 91);
    out.digest_of(bad);
}

void inside_boxes(const Effort& effort, Outcome& out) {
    auto model = import_and_bake(hard_town());
    if (!model) return out.none_of("bakes refused (" + model.error().text() + ")", 1);
    CutFixture fixture(*model);
    std::uint64_t numbers = 0, cuts = 0, differ = 0, coarse = 0, made = 0;
    for (const Placed& place : awkward_places(*model, effort.count(1000, 50))) {
        if (effort.stopped()) break;
        const prepare::PreparedFrame& frame = fixture.prepare({place.pose, 0, 0}, place.viewport);
        numbers += unsound(frame, fixture.costs());
        for (const std::string_view selector : select::selector_names()) {
            for (const double budget_us : {0.0, 2500.0, infinity}) {
                fixture.forget();
                const select::Cut& cut = fixture.select(selector, budget_us);
                cuts += illegal(frame, cut);
                const std::uint64_t hash = cut.hash;
                fixture.forget();
                differ += fixture.select(selector, budget_us).hash != hash ? 1 : 0;
                ++made;
                if (selector == select::usual_selector) out.digest_of(hash);
                if (selector == select::usual_selector && budget_us == infinity)
                    coarse += cut.worst_error_rad <= 1.00001F * frame.target_error_rad ? 0 : 1;
            }
        }
    }
    out.none_of("costs, errors and benefits that are not finite or out of order", numbers);
    out.none_of("cuts that are illegal or not finite", cuts);
    out.none_of("cuts that come out otherwise the second time", differ);
    out.none_of("unlimited cuts that stay coarser than was asked", coarse);
    out.at_least("cuts", static_cast<double>(made), 1000);
    out.cut_hash = out.digest;
    out.triangles = model->triangles();
}

/// Every leaf that the oracle sees is under some item of the cut.
void nothing_lost(const Effort& effort, Outcome& out) {
    auto model = import_and_bake(hard_town());
    if (!model) return out.none_of("bakes refused (" + model.error().text() + ")", 1);
    prepare::PrepareOptions options;
    options.occlusion = false;  // the oracle knows views only; what others hide has rows of its own
    CutFixture fixture(*model, options);
    std::uint64_t lost = 0, seen = 0;
    for (const Placed& place : awkward_places(*model, effort.count(3000, 100))) {
        if (effort.stopped()) break;
        fixture.prepare({place.pose, 0, 0}, place.viewport);
        const select::Cut& cut = fixture.select(select::usual_selector, 4000);
        const LeavesInView leaves = leaves_in_view(*model, cut, place.pose, place.viewport);
        seen += leaves.seen;
        lost += leaves.lost;
    }
    out.none_of("visible leaves that no item of the cut stands for", lost);
    out.at_least("visible leaves", static_cast<double>(seen), 500);
    out.digest_of(seen);
}

}  // namespace

std::span<const Row> near_and_inside_rows() {
    static constexpr std::array<Row, 5> table = {{
        {"N9a", "near_and_inside",
         "random boxes, from points to 1000 km, against views of 1 to 179 degrees and 1x1 to 16384x16384 pixels",
         "no box that the exact separating-axis test sees is dropped", random_boxes},
        {"N9b", "near_and_inside", "boxes of 10 to 200 m beside the view",
         "few of those outside are kept, and fewer than by the planes alone", large_boxes},
        {"N10", "near_and_inside",
         "fields of view and sizes at the ends: 0, 1 and 179 degrees, not a number; 1x1, 8192x1, 2^32 pixels",
         "every number of the view is finite and positive, and what is straight ahead is seen", odd_views},
        {"N11a", "near_and_inside",
         "eye on faces, corners, centres and inside of every box of a baked town, all selectors, three budgets",
         "finite costs and benefits in order, legal cuts, the same cut twice", inside_boxes},
        {"N11b", "near_and_inside", "the same eyes, each with a view of its own",
         "every leaf that the exact test sees is under an item of the cut", nothing_lost},
    }};
    return table;
}

}  // namespace surefoot::selftest
