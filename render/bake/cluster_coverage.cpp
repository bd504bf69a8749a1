// Counts what clusters' meshes cover in the pictures by which losses are measured, and scales connected parts
// (cluster_coverage.hpp).
#include "render/bake/cluster_coverage.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "render/bake/cards.hpp"
#include "render/bake/level_coverage.hpp"
#include "render/bake/picture_loss.hpp"

namespace surefoot::bake {

namespace {

constexpr std::uint64_t min_cluster_samples = 40;  // samples of all directions: fewer say little
constexpr double outline_margin = 1.05;            // for the directions that are not counted
constexpr double max_more_beside = 0.3;            // of full detail, once a level is scaled: else branches become a sail
constexpr double wanted_of_small = 0.8, wanted_of_large = 1.4;  // of full detail, once a level is scaled
constexpr double max_part_scale = 2.5, min_part_scale = 0.4;    // of a part's length

std::uint64_t outline_samples(const FormPicture& picture) {
    return static_cast<std::uint64_t>(std::ranges::count_if(picture.samples, &FormSample::covered));
}

/// Samples of a level in all directions: what it covers, and where full detail does not.
struct LevelOutlines {
    std::uint64_t covered = 0, beside = 0;
};

LevelOutlines outlines_of(const Geometry& g, const Level& level, const ClusterCover& cover) {
    LevelOutlines sum;
    FormPicture picture;
    std::size_t at = 0;
    for (const FormView& view : cover.views) {
        picture.clear(view, false);
        draw_geometry(*cover.looks, g.vertices, level.parts, picture);
        for (const FormSample& sample : picture.samples) {
            sum.covered += sample.covered() ? 1 : 0;
            sum.beside += sample.covered() && !cover.outlines[at] ? 1 : 0;
            ++at;
        }
    }
    return sum;
}

/// One connected part, with vertices of its own. Returns how far a vertex moved, m.
double scale_connected(Geometry& g, std::vector<std::uint32_t>& indices, double scale, const Box& box) {
    dvec3 middle(0.0);
    for (const std::uint32_t index : indices)
        middle += dvec3(position_of(g.vertices[index])) / static_cast<double>(indices.size());
    std::map<std::uint32_t, std::uint32_t> made;
    double moved_m = 0;
    for (std::uint32_t& index : indices) {
        const auto [where, fresh] = made.try_emplace(index, static_cast<std::uint32_t>(g.vertices.size()));
        if (fresh) {
            model::Vertex v = g.vertices[index];
            const dvec3 from(position_of(v));
            const dvec3 to = glm::clamp(middle + scale * (from - middle), box.min, box.max);
            for (int k = 0; k < 3; ++k) v.position[k] = static_cast<float>(to[k]);
            moved_m = std::max(moved_m, glm::length(dvec3(position_of(v)) - from));
            g.vertices.push_back(v);
            const std::array<std::uint8_t, 4> colour = g.baked[index];
            g.baked.push_back(colour);
        }
        index = where->second;
    }
    return moved_m;
}

/// Its error grows by the largest way of a vertex: no point of a triangle moves farther than its corners do.
Level scaled_level(Geometry& g, const Level& level, double scale, const Box& box) {
    Level out;
    out.triangles = level.triangles;
    double moved_m = 0;
    for (const GeometryPart& part : level.parts) {
        GeometryPart scaled{part.material, {}};
        for (std::vector<std::uint32_t>& connected : cards_of(g, part)) {
            moved_m = std::max(moved_m, scale_connected(g, connected, scale, box));
            scaled.indices.insert(scaled.indices.end(), connected.begin(), connected.end());
        }
        out.parts.push_back(std::move(scaled));
    }
    out.error_m = std::nextafter(level.error_m + static_cast<float>(moved_m), std::numeric_limits<float>::infinity());
    return out;
}

double outline_share(std::uint64_t samples, const ClusterCover& cover) {
    return static_cast<double>(samples) / static_cast<double>(cover.full);
}
bool covers_badly(double share) { return share < outline_margin * min_covered || outline_margin * share > max_covered; }

/// Nothing: no scale within reason brings the coverage back.
std::optional<Level> scale_to_cover(Geometry& g, const Level& level, const ClusterCover& cover, double share) {
    const std::size_t before = g.vertices.size();
    const bool grows = share < 1;
    const double max_beside =
        static_cast<double>(outlines_of(g, level, cover).beside) + max_more_beside * static_cast<double>(cover.full);
    double scale = 1;
    for (int attempt = 0; attempt < 3 && share > 0; ++attempt) {
        const double wanted = std::sqrt((grows ? wanted_of_small : wanted_of_large) / share);
        scale = std::clamp(scale * wanted, min_part_scale, max_part_scale);
        Level scaled = scaled_level(g, level, scale, cover.box);
        const LevelOutlines outlines = outlines_of(g, scaled, cover);
        share = outline_share(outlines.covered, cover);
        const double own_m = static_cast<double>(level.error_m) - cover.displacement_m;
        const bool small_change = static_cast<double>(scaled.error_m) - cover.displacement_m <= 2 * own_m;
        if (!covers_badly(share) && static_cast<double>(outlines.beside) <= max_beside && small_change) return scaled;
        g.vertices.resize(before);
        g.baked.resize(before);
        if (scale >= max_part_scale || scale <= min_part_scale) break;
    }
    return {};
}

/// Only the vertices that levels use, in their order.
void drop_unused_vertices(LodChain& chain) {
    Geometry& g = chain.full;
    std::vector<std::uint32_t> now(g.vertices.size(), model::none);
    for (const Level& level : chain.levels)
        for (const GeometryPart& part : level.parts)
            for (const std::uint32_t index : part.indices) now[index] = 0;
    std::uint32_t used = 0;
    for (std::size_t v = 0; v < now.size(); ++v) {
        if (now[v] == model::none) continue;
        now[v] = used;
        g.vertices[used] = g.vertices[v];
        g.baked[used] = g.baked[v];
        ++used;
    }
    g.vertices.resize(used);
    g.baked.resize(used);
    for (Level& level : chain.levels)
        for (GeometryPart& part : level.parts)
            for (std::uint32_t& index : part.indices) index = now[index];
}

/// By node: how many samples a cluster's full detail covers, and each of its forms.
struct ClusterSamples {
    std::uint64_t full = 0;
    std::vector<std::uint64_t> forms;
    std::vector<bool> outlines;  ///< of full detail, by sample of all directions
    std::vector<FormView> views;
};

/// Empty: step() said to stop.
std::vector<ClusterSamples> count_outlines(const model::Model& model, PictureTree& tree, const ForAll& for_all,
                                           const std::function<bool()>& step) {
    std::vector<ClusterSamples> samples(model.nodes.size());
    for (const auto& [azimuth_rad, elevation_rad] : std::span(loss_directions).first<outline_directions>()) {
        const auto count = [&](model::Index n, const FormPicture& full) {
            const model::Node& node = model.nodes[n];
            ClusterSamples& of_node = samples[n];
            of_node.full += outline_samples(full);
            of_node.views.push_back(full.view);
            for (const FormSample& sample : full.samples) of_node.outlines.push_back(sample.covered());
            of_node.forms.resize(node.rep_count);
            FormPicture form;
            for (std::uint32_t k = 0; k < node.rep_count; ++k) {
                form.clear(full.view, false);
                draw_form(model, model.reps[node.first_rep + k], form);
                of_node.forms[k] += outline_samples(form);
            }
            return step();
        };
        if (!tree.look({direction_of(azimuth_rad, elevation_rad), outline_px, false}, for_all, count)) return {};
    }
    return samples;
}

/// A level whose error equals a coarser one's is in no model: it counts as it should.
ClusterCover cluster_cover(const model::Model& model, const model::Node& node, const ClusterChain& cluster,
                           const ClusterSamples& samples) {
    const LodChain& chain = *cluster.chain;
    ClusterCover cover;
    cover.displacement_m = cluster.displacement_m;
    cover.views = samples.views;
    for (FormView& view : cover.views) view.middle -= chain.full.centre;
    cover.full = samples.full;
    cover.outlines = samples.outlines;
    cover.levels.assign(chain.levels.size(), samples.full);
    std::size_t level = 0;
    for (std::uint32_t k = 0; k < node.rep_count; ++k, ++level) {
        while (chain.levels[level].triangles != model.reps[node.first_rep + k].triangles) ++level;
        cover.levels[level] = samples.forms[k];
    }
    cover.box = Box{node.box.min - chain.full.centre, node.box.max - chain.full.centre};
    cover.looks = &model;
    return cover;
}

}  // namespace

std::size_t mend_steps(const model::Model& model) { return (outline_directions + 1) * PictureTree(model).clusters(); }

std::optional<bool> mend_clusters(const model::Model& model, const std::vector<ClusterChain>& chains, const ForAll& for_all,
                                  const std::function<bool()>& step) {
    PictureTree tree(model);
    const std::vector<ClusterSamples> samples = count_outlines(model, tree, for_all, step);
    if (samples.empty()) return {};
    std::atomic<bool> changed{false}, go{true};
    for_all(chains.size(), [&](std::size_t n) {
        if (chains[n].chain == nullptr || !go) return;
        if (mend_cluster(*chains[n].chain, cluster_cover(model, model.nodes[n], chains[n], samples[n]))) changed = true;
        if (!step()) go = false;
    });
    return go ? std::optional(changed.load()) : std::nullopt;
}

bool mend_cluster(LodChain& chain, const ClusterCover& cover) {
    if (cover.full < min_cluster_samples) return false;
    const auto off = [&](std::size_t i) { return std::abs(std::log(std::max(outline_share(cover.levels[i], cover), 1e-6))); };
    std::vector<Level> kept;
    std::size_t nearest = 0;
    bool changed = false;
    for (std::size_t i = 0; i < chain.levels.size(); ++i) {
        if (off(i) <= off(nearest)) nearest = i;
        const double share = outline_share(cover.levels[i], cover);
        if (!covers_badly(share)) {
            kept.push_back(chain.levels[i]);
            continue;
        }
        changed = true;
        if (auto scaled = scale_to_cover(chain.full, chain.levels[i], cover, share)) kept.push_back(std::move(*scaled));
    }
    if (!changed || (kept.empty() && chain.levels.size() == 1)) return false;
    if (kept.empty()) kept.push_back(chain.levels[nearest]);
    chain.levels = std::move(kept);
    raise_errors(chain.levels);
    drop_unused_vertices(chain);
    return true;
}

}  // namespace surefoot::bake
