// A program for callgrind: draws frames of one small scene on software GL, rasterised in this thread, and prints nothing else.
// frame_instructions bare|plain|sun|pixel|shadow|moving FRAMES: `plain` has no effects and Surefoot's programs; `bare` the same
// scene with a program written here by hand, with nothing in it that an effect could have left behind; `sun` calls for an effect,
// to show that one costs; `pixel` has it by the pixel; `shadow` calls for baked shadows too; in `moving` its 48 balls stand on
// six motions, each carried by another one. Three frames warm up what is compiled late; then FRAMES run inside
// surefoot_counted_frame, which callgrind counts alone. It is told when they begin, where valgrind's header was there: counting
// what comes before takes ten times as long as running it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/effects/effects.hpp"
#include "tests/gl/small_models.hpp"

#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#else
#define CALLGRIND_START_INSTRUMENTATION
#endif

namespace {

using namespace surefoot;

gl::ProgramSource bare_program(model::EffectMask) {
    return {
        "#version 430 core\n"
        "in vec3 position;\n"
        "in vec4 world_rows[3];\n"
        "in vec4 material_colour;\n"
        "uniform mat4 view_projection;\n"
        "flat out vec3 colour;\n"
        "void main() {\n"
        "    vec4 p = vec4(position, 1.0);\n"
        "    colour = material_colour.rgb;\n"
        "    gl_Position = view_projection * vec4(dot(world_rows[0], p), dot(world_rows[1], p), dot(world_rows[2], p), 1.0);\n"
        "}\n",
        "#version 430 core\n"
        "flat in vec3 colour;\n"
        "out vec4 pixel;\n"
        "void main() { pixel = vec4(colour, 1.0); }\n"};
}

/// A ball of 2 x rings x sides triangles.
void ball(std::vector<model::Vertex>& vertices, std::vector<std::uint32_t>& indices, int rings, int sides) {
    for (int r = 0; r <= rings; ++r) {
        for (int s = 0; s <= sides; ++s) {
            const double down = M_PI * r / rings;
            const double round = 2 * M_PI * s / sides;
            const dvec3 n(std::sin(down) * std::cos(round), std::cos(down), std::sin(down) * std::sin(round));
            model::Vertex v{};
            for (int i = 0; i < 3; ++i) {
                v.position[i] = static_cast<float>(n[i]);
                v.normal[i] = static_cast<std::int8_t>(std::lround(127 * n[i]));
            }
            for (auto& byte : v.colour) byte = 255;
            vertices.push_back(v);
        }
    }
    const auto row = static_cast<std::uint32_t>(sides + 1);
    for (std::uint32_t r = 0; r < static_cast<std::uint32_t>(rings); ++r) {
        for (std::uint32_t s = 0; s < static_cast<std::uint32_t>(sides); ++s) {
            const std::uint32_t a = r * row + s;
            for (const std::uint32_t i : {a, a + 1, a + row, a + 1, a + row + 1, a + row}) indices.push_back(i);
        }
    }
}

/// Turned by a hundredth of a radian at most, so that the picture hardly differs: twelve motions, of which six carry the others.
void set_moving(model::Model& model) {
    constexpr std::array<float, 4> rest{0, 0, 0, 1}, turned{0, 0.005F, 0, 0.99998749F};
    for (model::Index m = 0; m < 12; ++m) {
        model.motions.push_back({dvec3(0, 0, -14), 3 * m, 3, 1.0 + 0.1 * m, m < 6 ? model::none : m - 6});
        model.motion_keys.insert(model.motion_keys.end(),
                                 {{0, dvec3(0), rest}, {0.5, dvec3(0.01), turned}, {1.0 + 0.1 * m, dvec3(0), rest}});
    }
    for (model::Index p = 1; p < model.placements.size(); ++p) model.placements[p].motion = 6 + p % 6;
}

model::Model scene(model::EffectMask effects, bool moves) {
    test::SmallModel small;
    std::vector<model::Vertex> vertices;
    std::vector<std::uint32_t> indices;
    ball(vertices, indices, 16, 24);
    for (int i = 0; i < 48; ++i) {
        const auto shade = static_cast<float>(i) / 48.0F;
        const auto material = small.material(test::plain(shade, 1 - shade, 0.5F, 1, effects));
        const int column = i % 8, row = i / 8 % 3, layer = i / 24;
        small.object(vertices, indices, material, test::at(-10.5 + 3 * column, -6 + 3 * row, -12.0 - 3 * layer));
    }
    model::Model model = small.finish();
    if (moves) set_moving(model);
    if ((effects & model::effect_shadow) == 0) return model;
    model.sun_seen.resize(model.vertices.size());
    for (std::size_t v = 0; v < model.sun_seen.size(); ++v)
        for (auto& share : model.sun_seen[v].share) share = static_cast<std::uint8_t>(v * 37 % 256);
    return model;
}

model::EffectMask effects_of(std::string_view what) {
    if (what == "sun") return model::effect_sun;
    if (what == "pixel") return model::effect_sun | model::effect_light_by_pixel;
    return what == "shadow" ? model::effect_sun | model::effect_shadow : model::EffectMask{0};
}

Pose looking_ahead() {
    Pose pose;
    pose.fov_y_rad = 1.0;
    return pose;
}

/// For callgrind's --toggle-collect: a name of its own, never inlined.
extern "C" [[gnu::noinline]] void surefoot_counted_frame(gl::Device& device, std::span<const gl::DrawItem> items) {
    device.draws.plays();
    device.set_time(0.3);
    device.begin_frame(looking_ahead());
    device.draw(items);
    device.end_slice();
    device.end_items();
    device.finish_frame();
}

/// Not counted.
[[gnu::noinline]] void warm_up(gl::Device& device, std::span<const gl::DrawItem> items) {
    device.draws.plays();
    device.begin_frame(looking_ahead());
    device.draw(items);
    device.end_slice();
    device.end_items();
    device.finish_frame();
    if (device.stats().items == 0) std::abort();  // and so never taken for the same function
}

int fail(const Error& error) {
    std::fprintf(stderr, "%s\n", error.text().c_str());
    return 1;
}

int run(std::string_view what, int frames) {
    const model::Model model = scene(effects_of(what), what == "moving");
    gl::DeviceOptions options;
    options.kind = gl::BackendKind::egl;
    options.viewport = {320, 200};
    auto device = gl::open_device(options);
    if (!device) return fail(device.error());
    const gl::ProgramFactory programs = what == "bare" ? gl::ProgramFactory(bare_program) : effects::assemble_program;
    (*device)->draws.plays();
    if (auto loaded = (*device)->load(model, programs); !loaded) return fail(loaded.error());
    (*device)->bind();
    std::vector<gl::DrawItem> items;
    for (model::Index i = 1; i < model.nodes.size(); ++i) items.push_back({i, model.nodes[i].first_rep});
    for (int i = 0; i < 3; ++i) warm_up(**device, items);
    CALLGRIND_START_INSTRUMENTATION;
    for (int i = 0; i < frames; ++i) surefoot_counted_frame(**device, items);
    auto image = (*device)->read_pixels();
    if (!image) return fail(image.error());
    std::uint64_t hash = 14695981039346656037U;
    for (const std::uint8_t byte : image->rgba) hash = (hash ^ byte) * 1099511628211U;
    std::printf("%016llx %llu\n", static_cast<unsigned long long>(hash),
                static_cast<unsigned long long>((*device)->stats().triangles));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    const std::string_view what = argc == 3 ? argv[1] : "";
    const int frames = argc == 3 ? std::atoi(argv[2]) : 0;
    constexpr std::array<std::string_view, 6> known{"bare", "plain", "sun", "pixel", "shadow", "moving"};
    if (std::find(known.begin(), known.end(), what) == known.end() || frames < 1) {
        std::fprintf(stderr, "frame_instructions bare|plain|sun|pixel|shadow|moving FRAMES\n");
        return 2;
    }
    return run(what, frames);
}
