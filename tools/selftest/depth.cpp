// Rows: what is nearer shows: planes a hair apart far away, things in one place, walls through each other. On real GL.
#include <algorithm>
#include <array>
#include <cmath>

#include "tools/selftest/families.hpp"
#include "tools/selftest/picture.hpp"

namespace surefoot::selftest {

namespace {

constexpr std::array<float, 3> red{1, 0, 0}, green{0, 1, 0};
constexpr std::array<std::uint8_t, 3> red_byte{255, 0, 0}, green_byte{0, 255, 0};
constexpr model::Viewport depth_view{200, 150};

/// An oblique view, so that depths vary over the picture.
Pose oblique() {
    Pose pose;
    pose.orientation = glm::angleAxis(0.05, glm::normalize(dvec3(1, 0.7, 0)));
    return pose;
}

/// A square of `side` that fills the view at `distance`, tilted with normal `n` towards the eye.
struct Sheet {
    dvec3 origin;
    vec3 along, up;
};
Sheet sheet(double distance, double side, double tilt_rad) {
    const dquat turn = glm::angleAxis(tilt_rad, glm::normalize(dvec3(0.4, 1, 0)));
    const dvec3 along = turn * dvec3(side, 0, 0), up = turn * dvec3(0, side, 0);
    return {dvec3(0, 0, -distance) - 0.5 * (along + up), vec3(along), vec3(up)};
}

std::vector<gl::DrawItem> items_of(const model::Model& model, std::span<const model::Index> nodes) {
    std::vector<gl::DrawItem> items;
    for (const model::Index n : nodes) items.push_back({n, model.nodes[n].first_rep});
    return items;
}

std::uint64_t pixels_other_than(const gl::PixelImage& image, std::array<std::uint8_t, 3> colour) {
    std::uint64_t wrong = image.rgba.empty() ? 1 : 0;
    for (std::uint32_t y = 0; y < image.height; ++y) {
        for (std::uint32_t x = 0; x < image.width; ++x) wrong += is_colour(image, x, y, colour) ? 0 : 1;
    }
    return wrong;
}

/// A green sheet `gap` before a red one, both over the whole picture: every pixel is green, whichever is drawn first and whatever
/// numbers the two have.
void planes_apart(const Effort& effort, Outcome& out) {
    const auto device = open_picture(depth_view, effort, out);
    if (!device) return;
    // The near plane is 50 mm. A view with one of 1 mm is the same view of a world fifty times as large: 50 and 500 km.
    for (const auto& [distance, gap] :
         {std::pair{1.0, 1e-5}, {1000.0, 1e-3}, {10'000.0, 1e-2}, {100'000.0, 1.0}, {50'000.0, 0.05}, {500'000.0, 0.5}}) {
        std::uint64_t wrong = 0;
        for (const double tilt : {0.0, 0.3, 0.7}) {
            for (std::uint32_t others = 0; others < 32; ++others) {  // how many objects lie between the two in the model
                const double side = 6 * distance / std::cos(tilt);
                const Sheet near = sheet(distance, side, tilt), far = sheet(distance + gap / std::cos(tilt), side, tilt);
                Squares squares;
                const model::Index back = squares.add(far.origin, far.along, far.up, red);
                for (std::uint32_t i = 0; i < others; ++i)
                    (void)squares.add(dvec3(0, 0, 100 + i), vec3(1, 0, 0), vec3(0, 1, 0), red);
                const model::Index front = squares.add(near.origin, near.along, near.up, green);
                const model::Model model = squares.finish();
                if (!load(*device, model, out)) return;
                for (const auto& order : {std::array{back, front}, std::array{front, back}})
                    wrong += pixels_other_than(draw(*device, items_of(model, order), oblique()), green_byte);
            }
        }
        out.none_of("wrong pixels, " + std::to_string(gap) + " m apart at " + std::to_string(static_cast<int>(distance)) + " m",
                    wrong);
    }
}

/// Two sheets in exactly one place, cut into triangles alike or otherwise; the eye moves by millimetres.
void in_one_place(const Effort& effort, Outcome& out) {
    const auto device = open_picture(depth_view, effort, out);
    if (!device) return;
    std::uint64_t flicker = 0, sky = 0, mixed = 0, frames = 0;
    for (const double distance : {1.0, 10.0, 100.0, 1000.0, 10'000.0}) {
        const Sheet s = sheet(distance, 6 * distance, 0.4);
        Squares squares;
        const model::Index a = squares.add(s.origin, s.along, s.up, red), b = squares.add(s.origin, s.along, s.up, green);
        const model::Model model = squares.finish();
        if (!load(*device, model, out)) return;
        std::vector<std::uint8_t> first;
        const std::uint64_t max_frames = effort.count(200, 10);
        for (std::uint64_t i = 0; i < max_frames && !effort.stopped(); ++i, ++frames) {
            Pose pose = oblique();
            pose.position = {1e-3 * static_cast<double>(i), 3e-4 * static_cast<double>(i), 0};
            const auto order = i % 2 == 0 ? std::array{a, b} : std::array{b, a};
            const gl::PixelImage image = draw(*device, items_of(model, order), pose);
            const std::uint64_t reds = image.rgba.size() / 4 - pixels_other_than(image, red_byte);
            const std::uint64_t greens = image.rgba.size() / 4 - pixels_other_than(image, green_byte);
            sky += image.rgba.size() / 4 - reds - greens;
            mixed += std::min(reds, greens);
            if (first.empty()) first = image.rgba;
            flicker += image.rgba == first ? 0 : 1;
        }
    }
    out.none_of("frames that show the other one somewhere", flicker);
    out.none_of("pixels of the one among the other's", mixed);
    out.none_of("pixels of neither", sky);
    out.at_least("frames", static_cast<double>(frames), 50);
}

/// Which object shows where several are in one place is decided by their numbers, at every distance alike.
void order_by_number(const Effort& effort, Outcome& out) {
    const auto device = open_picture(depth_view, effort, out);
    if (!device) return;
    std::uint64_t wrong = 0;
    std::array<std::uint8_t, 3> winner{};
    for (const double distance : {1.0, 33.0, 1000.0, 10'000.0}) {
        const Sheet s = sheet(distance, 6 * distance, 0.4);
        Squares squares;
        std::vector<model::Index> nodes;
        nodes.reserve(5);
        for (int i = 0; i < 5; ++i)
            nodes.push_back(squares.add(s.origin, s.along, s.up, {static_cast<float>(51 * i) / 255.0F, 0, 0}));
        const model::Model model = squares.finish();
        if (!load(*device, model, out)) return;
        for (int turn = 0; turn < 5; ++turn) {
            std::rotate(nodes.begin(), nodes.begin() + 1, nodes.end());
            const gl::PixelImage image = draw(*device, items_of(model, nodes), oblique());
            if (image.rgba.size() < 4) return out.none_of("pictures that cannot be read", 1);
            if (distance == 1.0 && turn == 0) winner = {image.rgba[0], image.rgba[1], image.rgba[2]};
            wrong += pixels_other_than(image, winner);
        }
    }
    out.none_of("pixels of another than the one that shows at first", wrong);
}

/// Two walls that cross: the picture changes sides where they do, within a pixel.
void through_each_other(const Effort& effort, Outcome& out) {
    const auto device = open_picture(depth_view, effort, out);
    if (!device) return;
    std::uint64_t wrong = 0, crossings = 0;
    for (const double distance : {2.0, 100.0, 5000.0}) {
        const double side = 8 * distance;
        const Sheet left = sheet(distance, side, 0.3), right = sheet(distance, side, -0.3);
        Squares squares;
        const std::array nodes{squares.add(left.origin, left.along, left.up, red),
                               squares.add(right.origin, right.along, right.up, green)};
        const model::Model model = squares.finish();
        if (!load(*device, model, out)) return;
        const gl::PixelImage image = draw(*device, items_of(model, nodes), Pose{});
        // Along the ray of a pixel each wall is at n.p0 / n.d.
        const auto depth = [](const Sheet& s, const dvec3& ray) {
            const dvec3 n = glm::cross(dvec3(s.along), dvec3(s.up));
            return glm::dot(n, s.origin) / glm::dot(n, ray);
        };
        const double tan_y = std::tan(0.5 * Pose{}.fov_y_rad), tan_x = tan_y * depth_view.width / depth_view.height;
        for (std::uint32_t y = 0; y < depth_view.height; ++y) {
            for (std::uint32_t x = 0; x < depth_view.width; ++x) {
                const auto ray_at = [&](double px) {
                    return dvec3((2 * px / depth_view.width - 1) * tan_x, (1 - 2 * (y + 0.5) / depth_view.height) * tan_y, -1);
                };
                const auto nearer = [&](double px) { return depth(left, ray_at(px)) < depth(right, ray_at(px)); };
                const bool side_here = nearer(x + 0.5);
                const bool at_crossing = nearer(x - 0.5) != side_here || nearer(x + 1.5) != side_here;
                crossings += at_crossing ? 1 : 0;
                wrong += at_crossing || is_colour(image, x, y, side_here ? red_byte : green_byte) ? 0 : 1;
            }
        }
    }
    out.none_of("wrong pixels more than one from the crossing", wrong);
    out.at_least("pixels at a crossing", static_cast<double>(crossings), 300);
}

}  // namespace

std::span<const Row> depth_rows() {
    static constexpr std::array<Row, 4> table = {{
        {"N17a", "depth",
         "parallel planes 0.01 mm apart at 1 m, 1 mm at 1 km, 1 cm at 10 km, 1 m at 100 km. The second and third stand as with "
         "a near plane of 1 mm, fifty times as large; any numbers, either order",
         "the nearer one at every pixel", planes_apart},
        {"N17b", "depth", "two sheets in one place at 1 m to 10 km, drawn in turns, the eye moving by millimetres",
         "the same one at every pixel of every frame", in_one_place},
        {"N17c", "depth", "five sheets in one place, in every order of drawing, at 1 m to 10 km",
         "the same one shows at every distance", order_by_number},
        {"N17d", "depth", "two walls through each other at 2 m, 100 m and 5 km", "each on its side of the crossing",
         through_each_other},
    }};
    return table;
}

}  // namespace surefoot::selftest
