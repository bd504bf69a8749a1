// Bench: what do baked colours and normals of coarse forms bring, on the same triangles? Forms whose parts show colours of
// vertices, and no picture, are judged again with one mean colour a form, and with the normal of each triangle. The judge is the
// bake's own measure of losses: six directions, the picture of 64 pixels. Each form counts alike.
//
// bench_plain_forms MODEL.walk -> one JSON object. It takes a minute or less.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "render/bake/picture_loss.hpp"
#include "render/model/walk_file.hpp"

namespace {

using namespace surefoot;
using model::Index;

constexpr std::size_t at_64_px = 1;  // of loss_sizes_px

/// What is taken away from coarse forms.
struct Plain {
    bool colours = false, normals = false;
};

/// Does the part show a colour a vertex?
bool has_colours(const model::Model& m, const model::Part& part) {
    const model::Material& material = m.materials[part.material];
    return material.texture == model::none && (material.effects & model::effect_vertex_colour) != 0;
}

bool is_judged(const model::Model& m, const model::Node& node, Index rep) {
    const model::Representation& r = m.reps[rep];
    if (r.kind != model::RepKind::mesh || model::is_full_detail(node, rep, r.error_m) || r.part_count == 0) return false;
    return std::all_of(m.parts.begin() + r.first_part, m.parts.begin() + r.first_part + r.part_count,
                       [&](const model::Part& part) { return has_colours(m, part); });
}

const float* corner_of(const model::Model& m, const model::Part& part, std::uint32_t i) {
    return m.vertices[part.first_vertex + m.indices[part.first_index + i]].position;
}

/// Twice the area as a vector along the normal.
vec3 area_of(const model::Model& m, const model::Part& part, std::uint32_t first) {
    std::array<vec3, 3> at{};
    for (std::uint32_t k = 0; k < 3; ++k) {
        const float* p = corner_of(m, part, first + k);
        at[k] = vec3(p[0], p[1], p[2]);
    }
    return glm::cross(at[1] - at[0], at[2] - at[0]);
}

/// By area; bytes, as losses are of bytes.
std::array<std::uint8_t, 4> mean_colour(const model::Model& m, const model::Representation& rep) {
    std::array<double, 4> sum{};
    double area = 0;
    for (Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
        const model::Part& part = m.parts[p];
        for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3) {
            const auto weight = static_cast<double>(glm::length(area_of(m, part, i)));
            area += 3 * weight;
            for (std::uint32_t k = 0; k < 3; ++k)
                for (std::size_t c = 0; c < 4; ++c)
                    sum[c] += weight * m.vertices[part.first_vertex + m.indices[part.first_index + i + k]].colour[c];
        }
    }
    std::array<std::uint8_t, 4> mean{255, 255, 255, 255};
    for (std::size_t c = 0; c < 4 && area > 0; ++c) mean[c] = static_cast<std::uint8_t>(std::lround(sum[c] / area));
    return mean;
}

/// Gives the part vertices of its own, three a triangle.
void make_plain(model::Model& m, Index of_part, const Plain& plain, const std::array<std::uint8_t, 4>& colour) {
    const model::Part part = m.parts[of_part];
    model::Part own{part.material, static_cast<std::uint32_t>(m.indices.size()), part.index_count,
                    static_cast<std::uint32_t>(m.vertices.size()), part.index_count};
    for (std::uint32_t i = 0; i < part.index_count; ++i) {
        const std::size_t from = part.first_vertex + m.indices[part.first_index + i];
        model::Vertex vertex = m.vertices[from];
        const vec3 area = area_of(m, part, i / 3 * 3);
        const float length = glm::length(area);
        for (int c = 0; c < 4 && plain.colours; ++c) vertex.colour[c] = colour[c];
        for (int c = 0; c < 3 && plain.normals && length > 0; ++c)
            vertex.normal[c] = static_cast<std::int8_t>(std::lround(127 * area[c] / length));
        m.vertices.push_back(vertex);
        m.indices.push_back(i);
        if (!m.sun_seen.empty()) m.sun_seen.push_back(model::SunSeen(m.sun_seen[from]));
        if (!m.lamp_light.empty()) m.lamp_light.push_back(model::LampLight(m.lamp_light[from]));
    }
    m.parts[of_part] = own;
}

/// Placements of a mesh share their parts: each is done once.
model::Model plain_model(model::Model m, const Plain& plain) {
    std::vector<bool> done(m.parts.size(), false);
    for (const model::Node& node : m.nodes)
        for (Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
            const model::Representation rep = m.reps[r];
            if (!is_judged(m, node, r) || done[rep.first_part]) continue;
            const auto colour = mean_colour(m, rep);
            for (Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
                make_plain(m, p, plain, colour);
                done[p] = true;
            }
        }
    return m;
}

void on_all_cores(std::size_t n, const std::function<void(std::size_t)>& body) {
    std::atomic<std::size_t> next{0};
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < std::max(1U, std::thread::hardware_concurrency()); ++t)
        threads.emplace_back([&] {
            for (std::size_t i = next++; i < n; i = next++) body(i);
        });
    for (std::thread& thread : threads) thread.join();
}

std::vector<model::PictureLoss> losses_of(const model::Model& m) {
    return bake::measure_losses(m, on_all_cores, [] { return true; }).forms;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return fmt::print(stderr, "bench_plain_forms MODEL.walk\n"), 2;
    auto m = model::read_walk(argv[1]);
    if (!m) return fmt::print(stderr, "{}\n", m.error().text()), 1;
    const std::map<std::string, Plain> variants = {
        {"colours", {true, false}}, {"normals", {false, true}}, {"both", {true, true}}};
    const auto baked = losses_of(*m);
    nlohmann::ordered_json out;
    out["model"] = argv[1];
    for (const auto& [name, plain] : variants) {
        const auto losses = losses_of(plain_model(*m, plain));
        double with = 0, without = 0;
        std::vector<double> db;
        for (const model::Node& node : m->nodes)
            for (Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
                if (!is_judged(*m, node, r)) continue;
                const auto a = static_cast<double>(baked[r].colour[at_64_px]),
                           b = static_cast<double>(losses[r].colour[at_64_px]);
                with += a;
                without += b;
                db.push_back(10 * std::log10(std::max(b, 1e-6) / std::max(a, 1e-6)));
            }
        std::sort(db.begin(), db.end());
        out["forms"] = db.size();
        if (!(with > 0)) return fmt::print(stderr, "bench_plain_forms: no coarse form has colours of vertices\n"), 77;
        const auto rounded = [](double x) { return std::round(1000 * x) / 1000; };
        out[name] = {{"more_db", rounded(10 * std::log10(without / with))},
                     {"p50_db", rounded(db[db.size() / 2])},
                     {"p90_db", rounded(db[db.size() * 9 / 10])}};
    }
    fmt::print("{}\n", out.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    return 0;
}
