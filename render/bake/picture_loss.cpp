// First the leaves, then the clusters, whose full detail is put together from their children's pictures.
#include "render/bake/picture_loss.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

#include "render/model/loss_groups.hpp"

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

/// What is measured, and which leaves take the figures of another.
struct Plan {
    std::vector<Index> leaves;                  ///< one for all of one mesh
    std::vector<std::pair<Index, Index>> same;  ///< each leaf, and the number of the measured leaf with the same forms
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

Plan plan_of(const Model& model) {
    Plan plan;
    plan_leaves(model, plan);
    return plan;
}

struct Measuring {
    const Model& model;
    Plan plan;
    PictureTree tree;
    model::LossGroups groups;
    std::size_t levels = picture_levels;
    std::vector<PictureDifference> differences;  ///< by form
    std::vector<PictureDifference> of_groups;    ///< as Model::group_losses, where full detail covers
    std::vector<PictureDifference> beside;       ///< by form, where only it covers
    std::vector<PictureDifference> shown;        ///< by measured leaf: full detail against nothing

    explicit Measuring(const Model& m) : model(m), plan(plan_of(m)), tree(m), groups(m) {
        if (m.textures.empty()) levels = 1;
        differences.resize(m.reps.size());
        beside.resize(m.reps.size());
        of_groups.resize(groups.size());
        shown.resize(plan.leaves.size());
    }
    void compare(Index node, std::uint32_t forms, const FormPicture& full, FormPicture& form);
    void compare_groups(Index node, Index form_number, const std::vector<Index>& slots, const FormPicture& full,
                        const FormPicture& form);
    [[nodiscard]] std::vector<Index> slots_of(Index node, const FormPicture& full) const;
    void measure_leaf(std::size_t i);
    [[nodiscard]] std::vector<model::LossOfGroup> group_losses(const ColourSpread& colours) const;
    [[nodiscard]] ColourSpread colours() const;
    [[nodiscard]] MeasuredLosses losses() const;
};

void Measuring::compare(Index index, std::uint32_t forms, const FormPicture& full, FormPicture& form) {
    const Node& node = model.nodes[index];
    const std::vector<Index> slots = slots_of(index, full);
    for (Index r = node.first_rep; r < node.first_rep + forms; ++r) {
        form.clear(full.view);
        draw_form(model, model.reps[r], form);
        differences[r].add(full, form, levels);
        if (!slots.empty()) compare_groups(index, r - node.first_rep, slots, full, form);
    }
}

/// By sample of a cluster's full detail, the group that shows there; empty for a leaf.
std::vector<Index> Measuring::slots_of(Index node, const FormPicture& full) const {
    std::vector<Index> slots;
    if (groups.count(node) == 0) return slots;
    slots.reserve(full.samples.size());
    Index owner = none, slot = none;
    for (const FormSample& sample : full.samples) {
        if (sample.owner != owner) slot = groups.slot_of(owner = sample.owner, node);
        slots.push_back(slot);
    }
    return slots;
}

void Measuring::compare_groups(Index node, Index form_number, const std::vector<Index>& slots, const FormPicture& full,
                               const FormPicture& form) {
    PictureDifference* const of_form = &of_groups[groups.first(node) + std::size_t{form_number} * groups.count(node)];
    PictureDifference& alone = beside[model.nodes[node].first_rep + form_number];
    for (std::size_t i = 0; i < full.samples.size(); ++i) {
        if (full.samples[i].covered())
            of_form[slots[i]].add(full.samples[i], form.samples[i], levels);
        else
            alone.add(full.samples[i], form.samples[i], levels);
    }
}

void Measuring::measure_leaf(std::size_t i) {
    const Index index = plan.leaves[i];
    const Node& node = model.nodes[index];
    FormPicture full, form;
    for (const auto& [azimuth_rad, elevation_rad] : loss_directions) {
        full.clear(view_of(node.box, direction_of(azimuth_rad, elevation_rad), tree.middle(), pixels_across));
        form.clear(full.view);
        draw_form(model, model.reps[node.first_rep + node.rep_count - 1], full);
        shown[i].add(full, form, levels);
        compare(index, node.rep_count - 1, full, form);
    }
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

/// What a form shows beside full detail counts on all groups alike.
std::vector<model::LossOfGroup> Measuring::group_losses(const ColourSpread& of_model) const {
    std::vector<model::LossOfGroup> out(of_groups.size());
    for (Index n = 0; n < model.nodes.size(); ++n) {
        const Index count = groups.count(n);
        for (std::uint32_t k = 0; count > 0 && k < model.nodes[n].rep_count; ++k) {
            const Index r = model.nodes[n].first_rep + k;
            PictureDifference alone = beside[r];
            alone.end(levels);
            alone.full_detail = differences[r].full_detail;
            const PictureLoss more = alone.loss(of_model);
            for (std::size_t i = groups.first(n) + std::size_t{k} * count; i < groups.first(n) + (std::size_t{k} + 1) * count;
                 ++i) {
                PictureDifference of = of_groups[i];
                of.end(levels);
                // Not seen from anywhere: as the whole.
                const PictureLoss loss = of.full_detail > 0 ? of.loss(of_model) : differences[r].loss(of_model);
                for (std::size_t s = 0; s < out[i].colour.size(); ++s)
                    out[i].colour[s] = of.full_detail > 0 ? std::min(1.0F, loss.colour[s] + more.colour[s]) : loss.colour[s];
            }
        }
    }
    return out;
}

MeasuredLosses Measuring::losses() const {
    MeasuredLosses out{std::vector<PictureLoss>(model.reps.size()), std::vector<float>(model.reps.size(), 1.0F), {}, colours()};
    out.groups = group_losses(out.colours);
    for (const auto& [leaf, as] : plan.same) {
        const Node &node = model.nodes[leaf], &measured = model.nodes[plan.leaves[as]];
        for (std::uint32_t k = 0; k + 1 < node.rep_count; ++k) {
            const PictureDifference& of = differences[measured.first_rep + k];
            out.forms[node.first_rep + k] = of.loss(out.colours);
            out.covered[node.first_rep + k] = static_cast<float>(of.covered());
        }
    }
    for (const Node& node : model.nodes) {
        if (node.child_count == 0) continue;
        for (Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
            out.forms[r] = differences[r].loss(out.colours);
            out.covered[r] = static_cast<float>(differences[r].covered());
        }
    }
    return out;
}

}  // namespace

void MeasuredLosses::move_to(model::Model& model) {
    model.losses = std::move(forms);
    model.group_losses = std::move(groups);
    model.colours = colours;
}

void PictureDifference::add(const FormPicture& full, const FormPicture& form, std::size_t levels) {
    for (std::size_t i = 0; i < full.samples.size(); ++i) add(full.samples[i], form.samples[i], levels);
    end(levels);
}

void PictureDifference::add(const FormSample& a, const FormSample& b, std::size_t levels) {
    const bool in_a = a.covered(), in_b = b.covered();
    if (!in_a && !in_b) return;
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

void PictureDifference::end(std::size_t levels) {
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
    return plan_of(model).leaves.size() + loss_directions.size() * PictureTree(model).clusters();
}

MeasuredLosses measure_losses(const Model& model, const ForAll& for_all, const std::function<bool()>& step) {
    Measuring measuring(model);
    std::atomic<bool> go{true};
    for_all(measuring.plan.leaves.size(), [&](std::size_t i) {
        if (!go) return;
        measuring.measure_leaf(i);
        if (!step()) go = false;
    });
    for (const auto& [azimuth_rad, elevation_rad] : loss_directions) {
        if (!go) break;
        const auto compare = [&](Index node, const FormPicture& full) {
            FormPicture form;
            measuring.compare(node, model.nodes[node].rep_count, full, form);
            return step();
        };
        if (!measuring.tree.look({direction_of(azimuth_rad, elevation_rad), pixels_across}, for_all, compare)) go = false;
    }
    return go ? measuring.losses() : MeasuredLosses{};
}

}  // namespace surefoot::bake
