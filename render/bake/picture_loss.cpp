// First the leaves, then the clusters bottom-up. A cluster's full detail is put together from its children's pictures.
#include "render/bake/picture_loss.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

namespace surefoot::bake {

namespace {

using model::ColourSpread;
using model::Index;
using model::Model;
using model::Node;
using model::none;
using model::PictureLoss;
using model::RepKind;

constexpr std::uint32_t pixels_across = 64;
constexpr std::uint32_t clusters_a_task = 128;  // their pictures are made one after the other, and few are held

/// Round about, mostly as a walker sees things, and some from above and below.
constexpr std::array<std::array<double, 2>, 6> directions = {
    {{0.3, 0.15}, {1.35, 0.6}, {2.4, -0.15}, {3.44, 0.15}, {4.49, 0.6}, {5.53, -0.15}}};

/// What is measured, and which leaves take the figures of another.
struct Plan {
    std::vector<Index> leaves;                  ///< one for all of one mesh
    std::vector<std::pair<Index, Index>> same;  ///< each leaf, and the number of the measured leaf with the same forms
    std::vector<Index> task_roots;              ///< clusters below which nothing else is a task's
    std::vector<std::vector<Index>> upper;      ///< the other clusters, by height; low ones first
    std::size_t clusters = 0;
};

void plan_leaves(const Model& model, Plan& plan) {
    std::map<std::vector<Index>, Index> seen;
    for (Index n = 0; n < model.nodes.size(); ++n) {
        const Node& node = model.nodes[n];
        if (node.child_count > 0) continue;
        std::vector<Index> key;
        const Index finest = node.first_rep + node.rep_count - 1;
        for (Index r = node.first_rep; r <= finest; ++r)
            key.push_back(r == finest || model.reps[r].kind == RepKind::mesh ? model.reps[r].first_part : none);
        const auto [at, first] = seen.emplace(std::move(key), static_cast<Index>(plan.leaves.size()));
        if (first) plan.leaves.push_back(n);
        plan.same.emplace_back(n, at->second);
    }
}

void plan_clusters(const Model& model, Plan& plan) {
    std::vector<std::uint32_t> below(model.nodes.size(), 0), height(model.nodes.size(), 0);
    for (std::size_t n = model.nodes.size(); n-- > 0;) {  // children come after their parents
        const Node& node = model.nodes[n];
        if (node.child_count == 0) continue;
        ++plan.clusters;
        ++below[n];
        if (below[n] > clusters_a_task) {
            if (plan.upper.size() <= height[n]) plan.upper.resize(height[n] + 1);
            plan.upper[height[n]].push_back(static_cast<Index>(n));
        }
        if (node.parent == none) continue;
        below[node.parent] += below[n];
        if (below[n] > clusters_a_task) height[node.parent] = std::max(height[node.parent], height[n] + 1);
    }
    for (std::size_t n = 0; n < model.nodes.size(); ++n) {
        const Node& node = model.nodes[n];
        const bool root = node.parent == none || below[node.parent] > clusters_a_task;
        if (node.child_count > 0 && root && below[n] <= clusters_a_task) plan.task_roots.push_back(static_cast<Index>(n));
    }
}

Plan plan_of(const Model& model) {
    Plan plan;
    plan_leaves(model, plan);
    plan_clusters(model, plan);
    return plan;
}

struct Measuring {
    const Model& model;
    Plan plan;
    dvec3 middle;
    std::size_t levels = picture_levels;
    std::vector<PictureDifference> differences;  ///< by form
    std::vector<PictureDifference> shown;        ///< by measured leaf: full detail against nothing
    std::vector<FormPicture> pictures;           ///< by node: of clusters whose parent is still to come
    Direction from;

    explicit Measuring(const Model& m)
        : model(m), plan(plan_of(m)), middle(m.nodes.empty() ? dvec3(0.0) : m.nodes[0].box.centre()) {
        if (m.textures.empty()) levels = 1;
        differences.resize(m.reps.size());
        shown.resize(plan.leaves.size());
        pictures.resize(m.nodes.size());
    }
    void compare(Index node, std::uint32_t forms, const FormPicture& full, FormPicture& form);
    void measure_leaf(std::size_t i);
    void measure_cluster(Index node);
    [[nodiscard]] std::vector<Index> clusters_below(Index root) const;
    [[nodiscard]] ColourSpread colours() const;
    [[nodiscard]] MeasuredLosses losses() const;
};

void Measuring::compare(Index index, std::uint32_t forms, const FormPicture& full, FormPicture& form) {
    const Node& node = model.nodes[index];
    for (Index r = node.first_rep; r < node.first_rep + forms; ++r) {
        form.clear(full.view);
        draw_form(model, model.reps[r], form);
        differences[r].add(full, form, levels);
    }
}

void Measuring::measure_leaf(std::size_t i) {
    const Index index = plan.leaves[i];
    const Node& node = model.nodes[index];
    FormPicture full, form;
    for (const auto& [azimuth_rad, elevation_rad] : directions) {
        full.clear(view_of(node.box, direction_of(azimuth_rad, elevation_rad), middle, pixels_across));
        form.clear(full.view);
        draw_form(model, model.reps[node.first_rep + node.rep_count - 1], full);
        shown[i].add(full, form, levels);
        compare(index, node.rep_count - 1, full, form);
    }
}

void Measuring::measure_cluster(Index index) {
    const Node& node = model.nodes[index];
    FormPicture& full = pictures[index];
    full.clear(view_of(node.box, from, middle, pixels_across));
    for (Index c = node.first_child; c < node.first_child + node.child_count; ++c) {
        const Node& child = model.nodes[c];
        if (child.child_count == 0) draw_form(model, model.reps[child.first_rep + child.rep_count - 1], full);
        if (child.child_count > 0) draw_picture(pictures[c], full);
        pictures[c] = {};
    }
    FormPicture form;
    compare(index, node.rep_count, full, form);
}

/// Children first.
std::vector<Index> Measuring::clusters_below(Index root) const {
    std::vector<Index> open{root}, found;
    while (!open.empty()) {
        const Index at = open.back();
        const Node& node = model.nodes[at];
        open.pop_back();
        if (node.child_count == 0) continue;
        found.push_back(at);
        for (Index c = node.first_child; c < node.first_child + node.child_count; ++c) open.push_back(c);
    }
    std::reverse(found.begin(), found.end());
    return found;
}

/// Each leaf counts by its size.
ColourSpread Measuring::colours() const {
    std::array<double, 3> sum{};
    double squares = 0, weights = 0;
    for (const auto& [leaf, as] : plan.same) {
        const PictureDifference& of = shown[as];
        if (of.one == 0) continue;
        const dvec3 size = 2.0 * model.nodes[leaf].box.half();
        const double weight = size.x * size.y + size.y * size.z + size.z * size.x;
        const double a_sample = weight / static_cast<double>(of.one);
        weights += weight;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += a_sample * static_cast<double>(of.sums[c][0]) / 255;
        squares += a_sample * static_cast<double>(of.squares[0]) / (255.0 * 255.0);
    }
    ColourSpread spread;
    if (!(weights > 0)) return spread;
    double variance = squares / weights / 3;
    for (std::size_t c = 0; c < 3; ++c) {
        const double mean = sum[c] / weights;
        spread.mean[c] = static_cast<float>(mean);
        variance -= mean * mean / 3;
    }
    spread.variance = static_cast<float>(std::max(variance, 0.0));
    return spread;
}

MeasuredLosses Measuring::losses() const {
    MeasuredLosses out{std::vector<PictureLoss>(model.reps.size()), colours()};
    for (const auto& [leaf, as] : plan.same) {
        const Node &node = model.nodes[leaf], &measured = model.nodes[plan.leaves[as]];
        for (std::uint32_t k = 0; k + 1 < node.rep_count; ++k)
            out.forms[node.first_rep + k] = differences[measured.first_rep + k].loss(out.colours);
    }
    for (const Node& node : model.nodes) {
        if (node.child_count == 0) continue;
        for (Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) out.forms[r] = differences[r].loss(out.colours);
    }
    return out;
}

}  // namespace

void PictureDifference::add(const FormPicture& full, const FormPicture& form, std::size_t levels) {
    for (std::size_t i = 0; i < full.samples.size(); ++i) {
        const FormSample &a = full.samples[i], &b = form.samples[i];
        const bool in_a = a.covered(), in_b = b.covered();
        if (!in_a && !in_b) continue;
        ++either;
        full_detail += in_a ? 1 : 0;
        one += in_a != in_b ? 1 : 0;
        for (std::size_t k = 0; k < levels; ++k) {
            for (std::size_t c = 0; c < 3; ++c) {
                if (in_a && in_b) {
                    const int off = a.rgb[k][c] - b.rgb[k][c];
                    both[k] += static_cast<std::uint64_t>(off * off);
                } else {
                    const std::uint64_t seen = in_a ? a.rgb[k][c] : b.rgb[k][c];
                    squares[k] += seen * seen;
                    sums[c][k] += seen;
                }
            }
        }
    }
    for (std::size_t k = levels; k < picture_levels; ++k) {
        both[k] = both[0];
        squares[k] = squares[0];
        for (ByLevel& sum : sums) sum[k] = sum[0];
    }
}

/// Where one picture shows c and the other any colour of the model: (c - mean)^2 + variance.
PictureLoss PictureDifference::loss(const model::ColourSpread& of_model) const {
    PictureLoss loss;
    if (either == 0) return loss;
    const auto alone = static_cast<double>(one), all = static_cast<double>(full_detail > 0 ? full_detail : either);
    double behind = 3.0 * static_cast<double>(of_model.variance);
    for (const float mean : of_model.mean) behind += static_cast<double>(mean) * static_cast<double>(mean);
    loss.coverage = static_cast<float>(std::min(alone / all, 1.0));
    for (std::size_t k = 0; k < picture_levels; ++k) {
        double sum = static_cast<double>(both[k] + squares[k]) / (255.0 * 255.0) + alone * behind;
        for (std::size_t c = 0; c < 3; ++c)
            sum -= 2 * static_cast<double>(of_model.mean[c]) * static_cast<double>(sums[c][k]) / 255;
        loss.colour[k] = static_cast<float>(std::clamp(sum / (3 * all), 0.0, 1.0));
    }
    return loss;
}

std::size_t loss_steps(const Model& model) {
    const Plan plan = plan_of(model);
    return plan.leaves.size() + directions.size() * plan.clusters;
}

MeasuredLosses measure_losses(const Model& model, const ForAll& for_all, const std::function<bool()>& step) {
    Measuring measuring(model);
    std::atomic<bool> go{true};
    for_all(measuring.plan.leaves.size(), [&](std::size_t i) {
        if (!go) return;
        measuring.measure_leaf(i);
        if (!step()) go = false;
    });
    const auto measure_clusters = [&](const std::vector<Index>& nodes) {
        for (const Index node : nodes) {
            if (!go) return;
            measuring.measure_cluster(node);
            if (!step()) go = false;
        }
    };
    for (const auto& [azimuth_rad, elevation_rad] : directions) {
        measuring.from = direction_of(azimuth_rad, elevation_rad);
        for_all(measuring.plan.task_roots.size(),
                [&](std::size_t i) { measure_clusters(measuring.clusters_below(measuring.plan.task_roots[i])); });
        for (const std::vector<Index>& same : measuring.plan.upper)
            for_all(same.size(), [&](std::size_t i) { measure_clusters({same[i]}); });
    }
    return go ? measuring.losses() : MeasuredLosses{};
}

}  // namespace surefoot::bake
