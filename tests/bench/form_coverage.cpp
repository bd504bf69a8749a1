// Bench: how many coarse forms cover less than half or more than twice of what their node's full detail does? Counted in the
// pictures by which a bake measures losses: six directions, over all nodes. Walks draw some forms more often than others:
// bench_coverage counts what they draw.
//
// bench_form_coverage MODEL.walk -> one JSON object.
#include <fmt/format.h>

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "render/bake/picture_loss.hpp"
#include "render/bake/picture_tree.hpp"
#include "render/model/walk_file.hpp"

using namespace surefoot;

namespace {

/// Samples of one form and of its node's full detail, of all directions.
struct Samples {
    std::uint64_t full = 0, form = 0;
};

constexpr std::uint32_t across_px = 64;
constexpr std::uint64_t min_samples = 100;  // of all directions: fewer say little

std::uint64_t count(const bake::FormPicture& picture) {
    std::uint64_t n = 0;
    for (const bake::FormSample& sample : picture.samples) n += sample.covered() ? 1 : 0;
    return n;
}

void add(const model::Model& m, model::Index n, const bake::FormPicture& full, std::vector<Samples>& samples) {
    const std::uint64_t whole = count(full);
    bake::FormPicture form;
    for (model::Index r = m.nodes[n].first_rep; r < m.nodes[n].first_rep + m.nodes[n].rep_count; ++r) {
        form.clear(full.view);
        bake::draw_form(m, m.reps[r], form);
        samples[r].full += whole;
        samples[r].form += count(form);
    }
}

void serially(std::size_t n, const std::function<void(std::size_t)>& body) {
    for (std::size_t i = 0; i < n; ++i) body(i);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return fmt::print(stderr, "bench_form_coverage MODEL.walk\n"), 2;
    auto read = model::read_walk(argv[1]);
    if (!read) return fmt::print(stderr, "{}\n", read.error().text()), 1;
    const model::Model& m = *read;
    std::vector<Samples> samples(m.reps.size());
    bake::PictureTree tree(m);
    for (const auto& [azimuth_rad, elevation_rad] : bake::loss_directions) {
        const bake::Direction from = bake::direction_of(azimuth_rad, elevation_rad);
        bake::FormPicture full;
        for (model::Index n = 0; n < m.nodes.size(); ++n) {
            const model::Node& node = m.nodes[n];
            if (node.child_count > 0) continue;
            full.clear(bake::view_of(node.box, from, tree.middle(), across_px));
            bake::draw_form(m, m.reps[node.first_rep + node.rep_count - 1], full);
            add(m, n, full, samples);
        }
        tree.look({from, across_px}, serially, [&](model::Index n, const bake::FormPicture& of_children) {
            add(m, n, of_children, samples);
            return true;
        });
    }
    struct Off {
        std::size_t forms = 0, small = 0, large = 0;
    };
    std::map<std::string, Off> kinds;
    for (model::Index n = 0; n < m.nodes.size(); ++n) {
        const model::Node& node = m.nodes[n];
        const bool leaf = node.child_count == 0;
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
            if (samples[r].full < min_samples || (leaf && m.reps[r].error_m <= 0)) continue;
            const std::string form(model::form_of(m.reps[r].kind).name);
            Off& off = kinds[(leaf ? "leaf " : "cluster ") + form];
            ++off.forms;
            off.small += 2 * samples[r].form < samples[r].full ? 1 : 0;
            off.large += samples[r].form > 2 * samples[r].full ? 1 : 0;
        }
    }
    nlohmann::ordered_json out;
    out["model"] = argv[1];
    std::size_t forms = 0, off_all = 0;
    for (const auto& [kind, off] : kinds) {
        forms += off.forms;
        off_all += off.small + off.large;
    }
    out["forms"] = forms;
    out["forms_off"] = off_all;
    for (const auto& [kind, off] : kinds)
        out[kind] = {{"forms", off.forms}, {"below_half", off.small}, {"above_twice", off.large}};
    fmt::print("{}\n", out.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    return 0;
}
