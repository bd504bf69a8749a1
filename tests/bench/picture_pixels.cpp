// What pictures of the image cache cost on this device: CPU time of a drawn pixel beside pixels of triangles, and of a capture.
//
//   bench_picture_pixels [rounds]
//
// CPU time of the whole process, rasterisers included: the least of some rounds, each against an empty frame. Pixels are those of
// a picture of 1280 x 720 that each layer covers whole; layers come from far to near, so that each is drawn.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <string_view>
#include <vector>

#include "render/cache/depth_mesh.hpp"
#include "render/effects/effects.hpp"
#include "tests/gl/small_models.hpp"

namespace surefoot {
namespace {

constexpr model::Viewport size{1280, 720};
constexpr int layers = 8;
constexpr std::uint32_t mesh_triangles = 10000;
constexpr double frame_pixels = 1280.0 * 720.0;

double cpu_ns() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

/// Layers of each kind, far to near, and one square that fills a picture.
struct Layers {
    model::Model model;
    std::array<std::vector<gl::DrawItem>, 3> kinds;
    gl::DrawItem mesh;  ///< of mesh_triangles small ones, 15 m away
};

Layers make_layers() {
    test::SmallModel small;
    auto board = test::plain(1, 1, 1, 1, model::effect_texture);
    board.texture = small.texture({250, 240, 20, 255}, {90, 20, 200, 255}, 256);
    auto leaf = board;
    leaf.effects |= model::effect_alpha_mask;
    const std::array materials{small.material(test::plain(1, 0, 0)), small.material(board), small.material(leaf)};
    Layers made;
    for (std::size_t kind = 0; kind < materials.size(); ++kind) {
        for (int i = 0; i < layers; ++i) {
            const auto node = small.square(materials[kind], test::at(0, 0, -20.0 + i), 30);
            made.kinds[kind].push_back({node, node - 1});
        }
    }
    std::vector<model::Vertex> vertices;
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < mesh_triangles; ++i) {
        const std::uint32_t column = i % 100, row = i / 100;
        const float x = -10.0F + 0.2F * static_cast<float>(column), y = -10.0F + 0.2F * static_cast<float>(row);
        for (const auto& [dx, dy] : {std::pair{0.0F, 0.0F}, {0.15F, 0.0F}, {0.0F, 0.15F}}) {
            indices.push_back(static_cast<std::uint32_t>(vertices.size()));
            model::Vertex& vertex = vertices.emplace_back();
            vertex.position[0] = x + dx;
            vertex.position[1] = y + dy;
        }
    }
    const auto node = small.object(vertices, indices, materials[0], test::at(0, 0, -15));
    made.mesh = {node, node - 1};
    made.model = small.finish();
    return made;
}

/// A picture that more than fills the view of Pose{}; its box has one face to the eye.
gl::CachePicture full_picture(std::uint16_t texels) {
    gl::CachePicture picture;
    picture.place.texels = texels;
    picture.plane_m = 15;
    picture.low_m = dvec2(-20);
    picture.side_m = 40;
    picture.box = {dvec3(-25, -25, -25), dvec3(25, 25, -10)};
    return picture;
}

class Bench {
public:
    Bench(gl::Device& device, int rounds) : device_(device), rounds_(rounds) {}

    /// ns of a frame beyond an empty one.
    template <class Draw>
    double beyond_empty(Draw draw) {
        double empty = 1e300, full = 1e300;
        for (int i = 0; i < rounds_; ++i) {
            empty = std::min(empty, frame([] {}));
            full = std::min(full, frame(draw));
        }
        return full - empty;
    }
    template <class Draw>
    double frame(Draw draw) {
        const double start = cpu_ns();
        device_.draws.plays();
        device_.begin_frame(Pose{});
        draw();
        device_.end_slice();
        device_.end_items();
        device_.finish_frame();
        return cpu_ns() - start;
    }
    /// us of a capture beyond a frame without any. In turn in `layers_in_use` layers: a change of layer ends a scene of the
    /// driver.
    double capture_us(gl::CachePicture picture, std::span<const gl::DrawItem> items, unsigned layers_in_use,
                      std::span<float> depths = {}) {
        constexpr unsigned count = 16;
        double least = 1e300, none = 1e300;
        for (int i = 0; i < rounds_; ++i) {
            none = std::min(none, frame([] {}));
            device_.draws.plays();
            for (unsigned c = 0; c < count; ++c) {
                picture.place.layer = static_cast<std::uint16_t>(c % layers_in_use);
                depths.empty() ? device_.capture_picture(picture, items) : device_.capture_depths(picture, items, depths);
            }
            least = std::min(least, frame([] {}));
        }
        return 1e-3 * (least - none) / count;
    }

private:
    gl::Device& device_;
    int rounds_;
};

/// Two triangles that fill the view of Pose{} at each of some depths, or a grid of small ones.
struct BenchMesh {
    std::vector<gl::MeshCorner> corners;
    std::vector<std::uint16_t> indices;
    void add(const dvec2& low, double side_m, double depth_m, double texels) {
        const auto first = static_cast<std::uint16_t>(corners.size());
        for (const auto& [u, v] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}})
            corners.push_back({vec3(dvec3(low + dvec2(u, v) * side_m, -depth_m)), vec2(dvec2(u, v) * texels)});
        for (const int i : {0, 1, 2, 2, 1, 3}) indices.push_back(static_cast<std::uint16_t>(first + i));
    }
};

/// CPU us of decimating a depth picture: the least of some rounds.
double meshing_us(cache::DepthMesher& mesher, const std::vector<float>& depths, std::uint32_t texels, float tolerance,
                  int rounds) {
    double least = 1e300;
    for (int i = 0; i < rounds; ++i) {
        const double start = cpu_ns();
        (void)mesher.make(depths, texels, {tolerance, 8192});
        least = std::min(least, cpu_ns() - start);
    }
    return 1e-3 * least;
}

void print_meshes(Bench& bench, gl::Device& device, const Layers& made, int rounds) {
    BenchMesh pixels, grid;
    for (int i = 0; i < layers; ++i) pixels.add(dvec2(-30), 60, 20.0 - i, 256);
    for (int i = 0; i < 5000; ++i) {
        const int column = i % 100, row = i / 100;
        grid.add(dvec2(-10 + 0.2 * column, -5 + 0.2 * row), 0.15, 15, 1);
    }
    const gl::CachePicture picture = full_picture(256);
    const auto draw = [&](const BenchMesh& mesh, const char* what, double of) {
        const gl::PictureMesh shown{picture.place, dvec3(0), mesh.corners, mesh.indices};
        const double ns = bench.beyond_empty([&] {
            device.draws.plays();
            device.draw_picture_meshes({&shown, 1});
        });
        fmt::print("{:<28} {:6.2f} ns\n", what, ns / of);
    };
    draw(pixels, "a pixel of a mesh", layers * frame_pixels);
    draw(grid, "a small triangle of a mesh", 10000);
    std::vector<float> depths(std::size_t{256} * 256);
    for (const std::uint16_t texels : {std::uint16_t{64}, std::uint16_t{128}, std::uint16_t{256}}) {
        const gl::CachePicture captured = full_picture(texels);
        const std::span<const gl::DrawItem> items = std::span(made.kinds[1]).last(1);
        const double us = bench.capture_us(captured, items, 4), read_us = bench.capture_us(captured, items, 4, depths);
        cache::DepthMesher mesher(256, 8192);
        const std::size_t count = std::size_t{texels} * texels;
        std::vector<float> flat(count, 0.5F), noise(count);
        for (std::size_t i = 0; i < count; ++i)
            noise[i] = i * 2654435761U % 1024 < 500 ? 0 : 0.5F + 1e-4F * static_cast<float>(i % 97);
        fmt::print("capture of {} texels {:.1f} us, depths read {:.1f}; meshing: flat {:.1f} us, noise {:.1f}\n", texels, us,
                   read_us, meshing_us(mesher, flat, texels, 0.01F, rounds), meshing_us(mesher, noise, texels, 0.001F, rounds));
    }
}

int run(int rounds) {
    gl::prepare_process(0);
    const Layers made = make_layers();
    gl::DeviceOptions options;
    options.viewport = size;
    options.picture_layers = 4;
    options.mesh_triangles = 10000;
    auto device = gl::open_device(options);
    if (!device.ok()) {
        fmt::print(stderr, "{}\n", device.error().text());
        return 1;
    }
    gl::Device& gl_device = **device;
    gl_device.draws.plays();
    if (auto loaded = gl_device.load(made.model, effects::assemble_program); !loaded) {
        fmt::print(stderr, "{}\n", loaded.error().text());
        return 1;
    }
    fmt::print("{}, {} rounds\n", gl_device.renderer(), rounds);
    Bench bench(gl_device, rounds);
    constexpr std::array names{"flat", "textured", "textured, alpha test"};
    for (std::size_t kind = 0; kind < names.size(); ++kind) {
        const double ns = bench.beyond_empty([&] {
            gl_device.draws.plays();
            for (const gl::DrawItem& item : made.kinds[kind]) gl_device.draw({&item, 1});
        });
        fmt::print("{:<28} {:6.2f} ns a pixel\n", names[kind], ns / (layers * frame_pixels));
    }
    for (const bool filled : {true, false}) {
        const gl::CachePicture picture = full_picture(256);
        gl_device.draws.plays();
        gl_device.capture_picture(picture, std::span(made.kinds[0]).first(filled ? 1 : 0));
        bench.frame([] {});
        const std::vector<gl::CachePicture> all(layers, picture);
        const double ns = bench.beyond_empty([&] {
            gl_device.draws.plays();
            gl_device.draw_pictures(all);
        });
        fmt::print("{:<28} {:6.2f} ns a pixel\n", filled ? "picture, full" : "picture, empty", ns / (layers * frame_pixels));
    }
    for (const unsigned in_use : {1U, 4U}) {
        for (const std::uint16_t texels : {std::uint16_t{16}, std::uint16_t{64}, std::uint16_t{128}, std::uint16_t{256}}) {
            for (const std::size_t items : {std::size_t{0}, std::size_t{1}}) {
                const double us = bench.capture_us(full_picture(texels), std::span(made.kinds[1]).last(items), in_use);
                fmt::print("capture of {:>3} texels, {} layers, {} items {:8.1f} us\n", texels, in_use, items, us);
            }
        }
    }
    print_meshes(bench, gl_device, made, rounds);
    const double in_frame = bench.beyond_empty([&] {
        gl_device.draws.plays();
        gl_device.draw({&made.mesh, 1});
    });
    fmt::print("a small triangle of a frame {:8.1f} ns\n", in_frame / mesh_triangles);
    for (const double cut_at : {25.0, 0.0}) {
        gl::CachePicture picture = full_picture(256);
        picture.box.max.x = cut_at;
        const double us = bench.capture_us(picture, {&made.mesh, 1}, 4);
        fmt::print("of a capture{} {:8.1f} ns\n", cut_at > 0 ? "" : ", half cut off", 1e3 * us / mesh_triangles);
    }
    const gl::CachePicture small = [] {
        gl::CachePicture picture = full_picture(64);
        picture.box = {dvec3(-0.01, -0.01, -15), dvec3(0.01, 0.01, -14.99)};
        return picture;
    }();
    const std::vector<gl::CachePicture> many(1000, small);
    const double ns = bench.beyond_empty([&] {
        gl_device.draws.plays();
        gl_device.draw_pictures(std::span(many).first(64));
    });
    fmt::print("drawing a picture of a pixel {:8.2f} us\n", 1e-3 * ns / 64);
    return 0;
}

}  // namespace
}  // namespace surefoot

int main(int argc, char** argv) {
    int rounds = 30;
    if (argc > 1) {
        const std::string_view text = argv[1];
        std::from_chars(text.data(), text.data() + text.size(), rounds);
    }
    return surefoot::run(std::clamp(rounds, 1, 1000));
}
