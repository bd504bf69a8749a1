// Rows: pictures off axis, as the channels of a simulator show them: frustums, regions of poses, odd shifts, a wall of screens.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/measure/image_metrics.hpp"
#include "render/model/pixels.hpp"
#include "render/select/registry.hpp"
#include "tools/selftest/cut_fixture.hpp"
#include "tools/selftest/families.hpp"
#include "tools/selftest/picture.hpp"
#include "tools/selftest/separating.hpp"
#include "tools/selftest/shapes.hpp"
#include "tools/selftest/views.hpp"

namespace surefoot::selftest {

namespace {

constexpr double no_end = std::numeric_limits<double>::infinity();

/// From a little beside the middle to pictures that lie wholly beside where the pose looks; sometimes the side itself.
double any_shift(Random& random) {
    constexpr std::array<double, 6> marked = {0, 1, -1, 0.5, 8, -8};
    const std::uint32_t kind = random.below(12);
    return kind < marked.size() ? marked[kind] : random.range(-4, 4);
}

model::Viewport any_shifted_viewport(Random& random) {
    model::Viewport viewport = viewports[random.below(viewports.size())];
    viewport.shift_x = any_shift(random);
    viewport.shift_y = any_shift(random);
    return viewport;
}

void shifted_boxes(const Effort& effort, Outcome& out) {
    const std::uint64_t wanted = effort.count(3'000'000, 1000);
    Random random(91);
    std::uint64_t lost = 0, seen = 0, tried = 0, kept = 0;
    while (tried < wanted && !effort.stopped()) {
        const Pose pose = any_pose(random, 1000);
        const model::Viewport viewport = any_shifted_viewport(random);
        const model::Frustum frustum = model::make_frustum(pose, viewport, 1000);
        const Pyramid pyramid = pyramid_of(pose, viewport);
        Pyramid from_the_eye = pyramid;  // what lies before the near plane's rectangle may be kept
        from_the_eye.near_m = 0;
        for (int i = 0; i < 100 && tried < wanted; ++i, ++tried) {
            Box box = any_box(random);
            box.min += pose.position;
            box.max += pose.position;
            const bool touches = overlap(pyramid, box) > touching, visible = model::visible(frustum, box);
            seen += touches ? 1 : 0;
            lost += touches && !visible ? 1 : 0;
            kept += visible && !touches && overlap(from_the_eye, box) < -touching ? 1 : 0;
        }
    }
    out.none_of("visible boxes lost", lost);
    out.at_least("boxes that the exact test sees", static_cast<double>(seen), 0.05 * static_cast<double>(wanted));
    out.at_most("of those outside kept",
                static_cast<double>(kept) / static_cast<double>(std::max<std::uint64_t>(1, tried - seen)), 0.002);
    if (wanted < 3'000'000) out.scaled = std::to_string(wanted) + " boxes of 3000000";
    out.digest_of(seen);
    out.digest_of(lost);
}

/// About any axis.
dquat turned_up_to(double max_rad, Random& random) {
    const double angle = random.range(0, max_rad);
    const dquat to = any_turn(random);
    const dvec3 axis{to.x, to.y, to.z};
    return glm::length(axis) > 1e-6 ? glm::angleAxis(angle, glm::normalize(axis)) : dquat(1, 0, 0, 0);
}

void shifted_regions(const Effort& effort, Outcome& out) {
    const std::uint64_t wanted = effort.count(1'000'000, 2000);
    Random random(92);
    std::uint64_t lost = 0, seen = 0, tried = 0;
    while (tried < wanted && !effort.stopped()) {
        Pose centre = any_pose(random, 100);
        centre.fov_y_rad = random.range(0.05, 2.5);
        model::Viewport viewport = any_shifted_viewport(random);
        if (random.below(4) == 0) viewport.shift_x = viewport.shift_y = 0;
        const double radius_m = random.range(0, 3), angle_rad = random.range(0, 0.3);
        const model::Frustum frustum = model::make_frustum(centre, viewport, 1000, radius_m, angle_rad);
        for (int i = 0; i < 50 && tried < wanted; ++i, ++tried) {
            Pose pose = centre;
            pose.position +=
                glm::normalize(centre.right() + turned_up_to(6.28, random) * centre.up()) * random.range(0, radius_m);
            pose.orientation = turned_up_to(angle_rad, random) * pose.orientation;
            Box box = any_box(random);
            box.min += pose.position;
            box.max += pose.position;
            if (!(overlap(pyramid_of(pose, viewport), box) > touching)) continue;
            ++seen;
            lost += model::visible(frustum, box) ? 0 : 1;
        }
    }
    out.none_of("boxes that a pose of the region sees and its frustum drops", lost);
    out.at_least("boxes that a pose of the region sees", static_cast<double>(seen), 0.03 * static_cast<double>(wanted));
    out.digest_of(seen);
    out.digest_of(lost);
}

void odd_shifts(const Effort&, Outcome& out) {
    std::uint64_t bad = 0, tried = 0;
    for (const double fov : {0.0, 1e-9, 0.02, 1.0, 3.13, 1e300, std::nan("")}) {
        for (const double shift : {0.0, -1e-300, 0.5, 1.0, -8.0, 1e300, -no_end, std::nan("")}) {
            for (const bool across : {false, true}) {
                for (model::Viewport viewport : {model::Viewport{0, 0}, {1280, 720}, {8192, 1}, {1, 0xffffffffU}}) {
                    (across ? viewport.shift_x : viewport.shift_y) = shift;
                    Pose pose;
                    pose.fov_y_rad = fov;
                    ++tried;
                    const Pyramid shown = pyramid_of(pose, viewport);  // what lies in the picture's middle is in view
                    const dvec3 middle = 11.0 * (shown.forward + shown.middle_x * shown.right + shown.middle_y * shown.up);
                    const bool fine = sound_view(pose, viewport) &&
                                      model::visible(model::make_frustum(pose, viewport, 1000), {middle - 0.01, middle + 0.01});
                    bad += fine ? 0 : 1;
                }
            }
        }
    }
    out.none_of("views with a number that is not finite and positive, or that lose the middle of their picture", bad);
    out.at_least("views", static_cast<double>(tried), 448);
    out.digest_of(bad);
}

void shifted_cuts(const Effort& effort, Outcome& out) {
    auto model = import_and_bake(hard_town());
    if (!model) return out.none_of("bakes refused (" + model.error().text() + ")", 1);
    prepare::PrepareOptions options;
    options.occlusion = false;  // the oracle knows views only
    CutFixture fixture(*model, options);
    Random random(93);
    std::uint64_t numbers = 0, cuts = 0, lost = 0, seen = 0;
    for (const Placed& place : awkward_places(*model, effort.count(1500, 400))) {
        if (effort.stopped()) break;
        const model::Viewport viewport = any_shifted_viewport(random);
        const prepare::PreparedFrame& frame = fixture.prepare({place.pose, 0, 0}, viewport);
        numbers += unsound(frame, fixture.costs());
        for (const std::string_view selector : select::selector_names()) {
            fixture.forget();
            cuts += illegal(frame, fixture.select(selector, 2500));
        }
        fixture.forget();
        const select::Cut& cut = fixture.select(select::usual_selector, 4000);
        out.digest_of(cut.hash);
        const LeavesInView leaves = leaves_in_view(*model, cut, place.pose, viewport);
        seen += leaves.seen;
        lost += leaves.lost;
    }
    out.none_of("costs, errors and benefits that are not finite or out of order", numbers);
    out.none_of("cuts that are illegal or not finite", cuts);
    out.none_of("visible leaves that no item of the cut stands for", lost);
    out.at_least("visible leaves", static_cast<double>(seen), 500);
    out.cut_hash = out.digest;
    out.triangles = model->triangles();
}

/// Sixteen screens, each with its part of one picture.
void wall_of_screens(const Effort& effort, Outcome& out) {
    constexpr std::uint32_t screens = 4, width = 160, height = 120;
    const auto town = import_and_bake(hard_town());
    if (!town) return out.none_of("bakes refused (" + town.error().text() + ")", 1);
    Pose pose;
    pose.position = {20.13, 6.07, 95.21};
    pose.orientation = glm::angleAxis(-0.2, glm::normalize(dvec3(0.5, 1, 0)));
    const auto drawn = [&](model::Viewport viewport, const Pose& from) {
        gl::PixelImage image;
        const auto device = open_picture(viewport, effort, out);
        if (!device || !load(*device, *town, out)) return image;
        CutFixture fixture(*town);
        fixture.prepare({from, 0, 0}, viewport);
        std::vector<gl::DrawItem> items;
        for (const select::CutItem& item : fixture.select(select::usual_selector, no_end).items)
            items.push_back({item.node, item.rep});
        return draw(*device, items, from);
    };
    const gl::PixelImage whole = drawn({screens * width, screens * height}, pose);
    if (whole.rgba.empty()) return;
    Pose part = pose;
    part.fov_y_rad = 2 * std::atan(std::tan(0.5 * pose.fov_y_rad) / screens);
    double worst = 1;
    std::size_t of_one_colour = 0;
    for (std::uint32_t row = 0; row < screens; ++row) {
        for (std::uint32_t column = 0; column < screens && !effort.stopped(); ++column) {
            const double last = screens - 1;
            const gl::PixelImage screen = drawn({width, height, 2 * column - last, last - 2 * row}, part);
            if (screen.rgba.empty()) return;
            std::vector<std::uint8_t> there;
            for (std::uint32_t y = 0; y < height; ++y) {
                const std::size_t from = ((std::size_t{row} * height + y) * whole.width + std::size_t{column} * width) * 4;
                there.insert(there.end(), whole.rgba.begin() + static_cast<std::ptrdiff_t>(from),
                             whole.rgba.begin() + static_cast<std::ptrdiff_t>(from + std::size_t{width} * 4));
            }
            worst = std::min(worst, measure::share_within(screen.rgba, there, 1));
            of_one_colour += std::equal(there.begin() + 4, there.end(), there.begin()) ? 1 : 0;
        }
    }
    out.at_least("pixels within 1/255 of the one picture, worst screen", worst, 0.999);
    out.at_most("screens of one colour, of 16", static_cast<double>(of_one_colour), 8);
}

}  // namespace

std::span<const Row> off_axis_rows() {
    static constexpr std::array<Row, 5> table = {{
        {"A1", "off_axis", "random boxes against pictures shifted by up to eight of their halves, 1 to 179 degrees",
         "no box that the exact separating-axis test sees is dropped, and few of those outside are kept", shifted_boxes},
        {"A2", "off_axis", "regions of poses, moved by up to 3 m and turned by up to 0.3, pictures shifted and not",
         "no box that one of their poses sees is dropped", shifted_regions},
        {"A3", "off_axis", "shifts at the ends: none, 1e-300, 1e300, infinite, not a number",
         "every number of the view is finite and positive, and the picture's middle is seen", odd_shifts},
        {"A4", "off_axis", "eye on faces, corners, centres and inside of every box of a baked town, shifted views, all selectors",
         "finite costs and benefits in order, legal cuts, every leaf in view under an item of the cut", shifted_cuts},
        {"A5", "off_axis", "a wall of 4x4 screens, each drawn off axis with a cut of its own",
         "together they show the picture that one screen of their size shows", wall_of_screens},
    }};
    return table;
}

}  // namespace surefoot::selftest
