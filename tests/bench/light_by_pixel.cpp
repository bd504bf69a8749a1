// Bench: one light a triangle, light at the vertices and light by the pixel, on spheres and cylinders of few and many sides.
// Each picture is compared with the same shape of 512 sides, where both show it. Frames of 16 such shapes, from far to near, are
// drawn in turns: medians of the process's CPU time, and of the differences of a turn. bench_light_by_pixel [ROUNDS 15] [FOLDER]
// -> a JSON object a shape. With a folder it writes the pictures.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/gl/backends.hpp"
#include "render/image/image.hpp"
#include "rt/base/file.hpp"
#include "rt/base/statistics.hpp"
#include "tests/gl/small_models.hpp"
#include "tools/report/report.hpp"

namespace {

using namespace surefoot;

constexpr model::Viewport shapes_picture{960, 540};
constexpr std::array<const char*, 3> kinds{"flat", "vertex", "pixel"};
constexpr int copies_in_a_frame = 16;
constexpr int reference_sides = 512;

struct Shape {
    std::vector<model::Vertex> vertices;
    std::vector<std::uint32_t> indices;
};

model::Vertex vertex_at(const dvec3& place, const dvec3& normal) {
    model::Vertex v{};
    for (int i = 0; i < 3; ++i) {
        v.position[i] = static_cast<float>(place[i]);
        v.normal[i] = static_cast<std::int8_t>(std::lround(127 * normal[i]));
    }
    for (auto& byte : v.colour) byte = 255;
    return v;
}

/// A sphere, or a cylinder without ends, of radius 1; its rows of vertices run from the top to the bottom.
Shape round_shape(bool sphere, int sides) {
    Shape shape;
    const int rows = sphere ? sides / 2 : 1;
    for (int row = 0; row <= rows; ++row) {
        const double down = std::numbers::pi * row / rows;
        for (int side = 0; side <= sides; ++side) {
            const double about = 2 * std::numbers::pi * side / sides;
            const dvec3 out(std::cos(about), 0, std::sin(about));
            const dvec3 n = sphere ? dvec3(std::sin(down) * out.x, std::cos(down), std::sin(down) * out.z) : out;
            shape.vertices.push_back(vertex_at(sphere ? n : out + dvec3(0, std::cos(down), 0), n));
        }
    }
    const auto next_row = static_cast<std::uint32_t>(sides + 1);
    for (std::uint32_t row = 0; row < static_cast<std::uint32_t>(rows); ++row) {
        for (std::uint32_t side = 0; side < static_cast<std::uint32_t>(sides); ++side) {
            const std::uint32_t a = row * next_row + side;
            if (!sphere || row > 0) shape.indices.insert(shape.indices.end(), {a, a + 1, a + next_row + 1});
            if (!sphere || row + 1 < static_cast<std::uint32_t>(rows))
                shape.indices.insert(shape.indices.end(), {a, a + next_row + 1, a + next_row});
        }
    }
    return shape;
}

/// Each triangle with its own normal.
Shape flat_shape(const Shape& smooth) {
    Shape flat;
    for (std::size_t i = 0; i + 3 <= smooth.indices.size(); i += 3) {
        std::array<dvec3, 3> p;
        for (std::size_t k = 0; k < 3; ++k) {
            const float* const at = smooth.vertices[smooth.indices[i + k]].position;
            p[k] = dvec3(at[0], at[1], at[2]);
        }
        const dvec3 normal = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
        for (const dvec3& corner : p) {
            flat.indices.push_back(static_cast<std::uint32_t>(flat.vertices.size()));
            flat.vertices.push_back(vertex_at(corner, normal));
        }
    }
    return flat;
}

/// Objects of one kind of light, from far to near. All look the same from the eye.
void add_copies(test::SmallModel& scene, const Shape& shape, model::EffectMask effects, int copies,
                std::vector<gl::DrawItem>& items) {
    const model::Index material = scene.material(test::plain(0.9F, 0.6F, 0.4F, 1, effects));
    const mat3 turn(glm::mat3_cast(glm::angleAxis(0.35F, glm::normalize(vec3(1, 0.4F, 0.6F)))));
    for (int i = 0; i < copies; ++i) {
        const double depth = 10 + 0.2 * (copies - i);
        const auto radius = static_cast<float>(0.4 * depth);
        const model::Index node =
            scene.object(shape.vertices, shape.indices, material, test::at(0, 0, -depth, mat3(radius) * turn));
        items.push_back({node, node - 1});
    }
}

void draw_frame(gl::Device& device, const std::vector<gl::DrawItem>& items) {
    device.draws.plays();
    device.begin_frame(Pose{});
    for (const gl::DrawItem& item : items) {  // a slice each: none hides another
        device.draw({&item, 1});
        device.end_slice();
    }
    device.end_items();
    device.finish_frame();
}

double cpu_ms() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

/// Where both pictures show something other than what is behind everything.
double psnr_where_shown(const gl::PixelImage& a, const gl::PixelImage& b) {
    double sum = 0;
    std::size_t count = 0;
    const auto shows = [](const gl::PixelImage& image, std::size_t at) {
        return image.rgba[at] != image.rgba[0] || image.rgba[at + 1] != image.rgba[1] || image.rgba[at + 2] != image.rgba[2];
    };
    for (std::size_t at = 0; at + 3 < a.rgba.size(); at += 4) {
        if (!shows(a, at) || !shows(b, at)) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const double off = double(a.rgba[at + c]) - double(b.rgba[at + c]);
            sum += off * off;
            ++count;
        }
    }
    return report::psnr_db(count > 0 ? sum / static_cast<double>(count) : 255.0 * 255.0);
}

/// A kind of light on one shape.
struct Lit {
    std::vector<gl::DrawItem> items;
    gl::PixelImage image;
    std::vector<double> ms, more_ms;  ///< of a frame, and what it took more than that of light at the vertices
};

/// The device, and how often each frame is timed.
struct LightBench {
    std::unique_ptr<gl::Device> device;
    int rounds;
    std::string folder;

    Result<void> load(test::SmallModel& scene) {
        device->draws.plays();
        return device->load(scene.finish(), effects::assemble_program);
    }
    Result<gl::PixelImage> picture(const gl::DrawItem& item) {
        draw_frame(*device, {item});
        device->draws.plays();
        return device->read_pixels();
    }
    Result<gl::PixelImage> reference(bool sphere) {
        test::SmallModel scene;
        std::vector<gl::DrawItem> items;
        add_copies(scene, round_shape(sphere, reference_sides), model::effect_sun | model::effect_light_by_pixel, 1, items);
        if (auto ok = load(scene); !ok) return ok.error();
        return picture(items.front());
    }
    Result<void> measure(bool sphere, int sides, const gl::PixelImage& expected) {
        test::SmallModel scene;
        std::array<Lit, kinds.size()> lit;
        const Shape smooth = round_shape(sphere, sides);
        const Shape flat = flat_shape(smooth);
        add_copies(scene, flat, model::effect_sun, copies_in_a_frame, lit[0].items);
        add_copies(scene, smooth, model::effect_sun, copies_in_a_frame, lit[1].items);
        add_copies(scene, smooth, model::effect_sun | model::effect_light_by_pixel, copies_in_a_frame, lit[2].items);
        if (auto ok = load(scene); !ok) return ok;
        for (std::size_t k = 0; k < lit.size(); ++k) {
            auto image = picture(lit[k].items.back());
            if (!image) return image.error();
            lit[k].image = std::move(*image);
            if (folder.empty()) continue;
            const std::string name = fmt::format("{}/{}-{}-{}.png", folder, sphere ? "sphere" : "cylinder", sides, kinds[k]);
            const std::vector<std::uint8_t> png = image::encode_png(lit[k].image.width, lit[k].image.height, lit[k].image.rgba);
            if (auto ok = write_file(name, std::as_bytes(std::span(png))); !ok) return ok;
        }
        for (int round = -1; round < rounds; ++round) {
            std::array<double, kinds.size()> ms{};
            for (std::size_t k = 0; k < lit.size(); ++k) {
                const double begun = cpu_ms();
                draw_frame(*device, lit[k].items);
                ms[k] = cpu_ms() - begun;
            }
            for (std::size_t k = 0; k < lit.size() && round >= 0; ++k) {
                lit[k].ms.push_back(ms[k]);
                lit[k].more_ms.push_back(ms[k] - ms[1]);
            }
        }
        std::string line = fmt::format(R"({{"shape": "{}", "sides": {}, "triangles": {})", sphere ? "sphere" : "cylinder", sides,
                                       smooth.indices.size() / 3);
        for (std::size_t k = 0; k < lit.size(); ++k)
            line += fmt::format(R"(, "{}": {{"psnr_db": {:.1f}, "frame_ms": {:.2f}, "more_ms": {:.2f}}})", kinds[k],
                                psnr_where_shown(lit[k].image, expected), quantile_of(lit[k].ms, 0.5),
                                quantile_of(lit[k].more_ms, 0.5));
        fmt::print("{}}}\n", line);
        return {};
    }
};

int fail(const Error& error) {
    fmt::print(stderr, "bench_light_by_pixel: {}\n", error.text());
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    gl::DeviceOptions options;
    options.kind = gl::BackendKind::egl;
    options.viewport = shapes_picture;
    options.max_items = 256;
    auto device = gl::open_device(options);
    if (!device) return fail(device.error());
    LightBench shapes{std::move(*device), argc > 1 ? std::max(1, std::atoi(argv[1])) : 15, argc > 2 ? argv[2] : ""};
    shapes.device->bind();
    for (const bool sphere : {true, false}) {
        auto expected = shapes.reference(sphere);
        if (!expected) return fail(expected.error());
        for (const int sides : {8, 12, 16, 24, 32, 48, 64, 128})
            if (auto ok = shapes.measure(sphere, sides, *expected); !ok) return fail(ok.error());
    }
    shapes.device->draws.plays();
    shapes.device->release();
    return 0;
}
