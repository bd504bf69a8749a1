// The Preparer: breadth-first by levels, then evaluation, then the passes up and down the tree. Work for
// workers is cut into chunks of fixed size that write to separate places. So the arrays do not depend on the number of workers.
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "render/model/form_range.hpp"
#include "render/prepare/alike.hpp"
#include "render/prepare/evaluate.hpp"
#include "render/prepare/occlusion.hpp"
#include "render/prepare/prepared.hpp"
#include "render/prepare/shown_pixels.hpp"
#include "render/prepare/tree_passes.hpp"
#include "render/prepare/value.hpp"
#include "render/prepare/workers.hpp"
#include "rt/base/check.hpp"
#include "rt/base/fork_join.hpp"
#include "rt/clock/clock.hpp"

namespace surefoot::prepare {

namespace {

/// A node that the frustum did not cull and nothing hides. Children are contiguous visits.
struct NodeVisit {
    Index node = 0;
    Index parent = none;
    Index first_child = 0;
    std::uint32_t child_count = 0;
    std::uint32_t rep_count = 0;
    float nearest_m = 0;
    PlaneMask mask = all_planes;
    bool open = false;  ///< worth refining and has children
    bool live = true;   ///< false: none of its children is visible (Maciel 1994, figure 3.16)
};

constexpr std::uint32_t parents_a_chunk = 64, visits_a_chunk = 512;
constexpr std::uint32_t max_hidden = 4096;      // of which outlines are kept
constexpr std::uint32_t min_slots = 1U << 15U;  // children looked at before they are closed up: bounds the room for them

}  // namespace

struct Preparer::Impl {
    const model::Model& model;
    const model::CostModel& costs;
    PrepareOptions options;
    Evaluator evaluator;
    model::MovingNodes moving;
    Occluders occluders;
    Occlusion occlusion;
    Workers workers;

    std::vector<NodeVisit> visits;
    std::vector<NodeVisit> slots;          ///< children of a block of parents, before they are closed up
    std::vector<Index> block;              ///< the block's parents that are opened
    std::vector<HiddenNode> hidden_nodes;  ///< parents are visits, then candidates
    std::vector<std::uint32_t> slot_first, slot_count, slot_hidden, slot_left_out;
    std::vector<Index> candidate_of;  ///< a visit
    std::vector<std::uint32_t> chunk_choice, chunk_candidate, chunk_count;
    std::vector<std::uint32_t> chunk_parts;        ///< of a block: tests of Occlusion that it may do, then those that it did
    std::uint32_t parts_left = 0;                  ///< of this set
    std::vector<Weight> weights;                   ///< a candidate
    PreparedFrame tried;                           ///< of value_at()
    double last_speed_mps = 0, last_turn_rps = 0;  ///< of the last run()
    ShownPixels shown;
    std::span<const float> shown_px;  ///< of the last run()'s candidates
    ValuePass values;
    std::unique_ptr<model::LossGroups> groups;  ///< null: no losses of groups are known
    std::vector<float> forgiven;                ///< Looks::forgiven
    std::uint32_t choice_bound = 0;             ///< choices that the visits may need
    float used_factor = 1;                      ///< of the last run(), for value_at() too
    float target_factor = 1;                    ///< of the error target, raised while frames look at too many nodes
    std::array<EffectLoss, max_effect_groups> effect_losses;
    const model::CoverTest* cover = nullptr;    ///< null: nothing is left out
    const model::CoverBits* covered = nullptr;  ///< of this set; null: nothing is
    std::atomic<std::int64_t> worker_cpu_ns{0};

    Impl(const model::Model& m, const model::CostModel& c, const PrepareOptions& o);
    template <class Body>
    void for_chunks(std::uint32_t count, const Body& body);
    [[nodiscard]] const Box& box_of(Index node, Box& now) const;
    NodeVisit visit_of(const RegionView& view, Index node, Index parent, PlaneMask mask) const;
    void visit_children(const RegionView& view, const model::Frustum& frustum, std::uint32_t j, std::uint32_t& parts);
    void expand_level(const RegionView& view, const model::Frustum& frustum, Index begin, Index end, PreparedFrame& out);
    void close_up_block(const RegionView& view, PreparedFrame& out);
    void drop_false_positives(PreparedFrame& out);
    void make_room(PreparedFrame& out);
    void find_hidden_parents();
    void evaluate_all(const RegionView& view, PreparedFrame& out);
    void set_values(const RegionView& view, PreparedFrame& out);
    void value_effects(PreparedFrame& out) const;
    void adapt(const PreparedFrame& out);
};

Preparer::Impl::Impl(const model::Model& m, const model::CostModel& c, const PrepareOptions& o)
    : model(m),
      costs(c),
      options(o),
      evaluator(m, c),
      moving(m),
      occluders(o.occlusion ? find_occluders(m) : Occluders{}),
      occlusion(occluders),
      workers(o.workers, o.worker_hooks),
      groups(m.group_losses.empty() ? nullptr : std::make_unique<model::LossGroups>(m)) {
    options.max_candidates = std::max(1U, options.max_candidates);
    options.acuity_rad = std::clamp(finite_or(options.acuity_rad, 0.0), 0.0, 1.0);
    options.acuity_fov_y_rad = std::clamp(finite_or(options.acuity_fov_y_rad, 0.0), 0.0, 3.1);
    std::uint32_t max_children = 0, max_reps = 1;
    std::size_t max_forms = 0;  // nodes may share some
    for (const model::Node& node : m.nodes) {
        max_children = std::max(max_children, node.child_count);
        max_reps = std::max(max_reps, node.rep_count);
        max_forms += node.rep_count;
    }
    options.max_choices = std::max(options.max_choices, max_reps);
    const std::size_t max_nodes = std::min<std::size_t>(options.max_candidates, std::max<std::size_t>(m.nodes.size(), 1));
    if (options.gestalt > 0) {
        forgiven = alike_members(m);
        for (float& share : forgiven) share *= static_cast<float>(std::min(options.gestalt, 1.0));
    }
    visits.reserve(max_nodes);
    slots.resize(std::max<std::size_t>(std::min<std::size_t>(min_slots, m.nodes.size()), max_children));
    block.reserve(slots.size());
    hidden_nodes.reserve(max_hidden);
    slot_first.resize(slots.size() + 1);
    slot_count.resize(slots.size());
    slot_hidden.resize(slots.size());
    slot_left_out.resize(slots.size());
    chunk_parts.resize(slots.size() / parents_a_chunk + 1);
    candidate_of.resize(max_nodes);
    const std::size_t chunks = max_nodes / visits_a_chunk + 2;
    chunk_choice.resize(chunks);
    chunk_candidate.resize(chunks);
    chunk_count.resize(chunks);
    weights.resize(max_nodes);
    shown.reserve(static_cast<std::uint32_t>(max_nodes), max_hidden);
    values.reserve(static_cast<std::uint32_t>(max_nodes),
                   groups == nullptr ? 0 : std::min<std::size_t>(options.max_choices, max_forms));
}

template <class Body>
void Preparer::Impl::for_chunks(std::uint32_t count, const Body& body) {
    tbb::task_arena* const arena = workers.arena();
    if (arena == nullptr || count < 2) {
        for (std::uint32_t i = 0; i < count; ++i) body(i);
        return;
    }
    const auto caller = pthread_self();
    ForkJoin loop;
    arena->execute([&] {
        tbb::parallel_for(
            tbb::blocked_range<std::uint32_t>(0, count, 1),
            [&](const tbb::blocked_range<std::uint32_t>& range) {
                const ForkJoin::Task task(loop);
                const bool own = pthread_equal(pthread_self(), caller) != 0;
                const std::int64_t start = own ? 0 : rt::own_cpu_ns();
                for (std::uint32_t i = range.begin(); i < range.end(); ++i) body(i);
                if (!own) worker_cpu_ns.fetch_add(rt::own_cpu_ns() - start, std::memory_order_relaxed);
            },
            tbb::simple_partitioner());
    });
    loop.joined();
}

/// A node's box while the set is used. now: room for it, if it moves.
const Box& Preparer::Impl::box_of(Index node, Box& now) const {
    if (!moving.any()) return model.nodes[node].box;
    return now = moving.box(node);
}

NodeVisit Preparer::Impl::visit_of(const RegionView& view, Index index, Index parent, PlaneMask mask) const {
    const model::Node& node = model.nodes[index];
    NodeVisit visit;
    visit.node = index;
    visit.parent = parent;
    visit.rep_count = node.rep_count;
    const auto moves = moving.find(index);
    visit.nearest_m = moves && !moves->everywhere ? nearest_distance(seen_at_rest(view, *moves), moves->rest)
                                                  : nearest_distance(view, node.box);
    visit.mask = mask;
    visit.open = node.child_count > 0 && (view.full_depth || finest_error(model, node, visit.nearest_m) >
                                                                 view.target_error_rad * model::error_distance(visit.nearest_m));
    return visit;
}

void Preparer::Impl::visit_children(const RegionView& view, const model::Frustum& frustum, std::uint32_t j,
                                    std::uint32_t& parts) {
    const NodeVisit& parent = visits[block[j]];
    const model::Node& node = model.nodes[parent.node];
    std::uint32_t at = slot_first[j], hidden = 0, left_out = 0;
    for (Index child = node.first_child; child < node.first_child + node.child_count; ++child) {
        Box now;
        const Box& box = box_of(child, now);
        const PlaneMask mask = cull_planes(frustum, box, parent.mask);
        if (mask == culled) continue;
        if (covered != nullptr && cover->covered(child, *covered)) {
            ++left_out;
            continue;
        }
        if (occlusion.hides(box, parts))
            slots[slot_first[j] + node.child_count - ++hidden].node = child;
        else
            slots[at++] = visit_of(view, child, block[j], mask);
    }
    slot_count[j] = at - slot_first[j];
    slot_hidden[j] = hidden;
    slot_left_out[j] = left_out;
}

// Children of the block are appended in order; a parent whose children no longer fit keeps its own choices.
void Preparer::Impl::close_up_block(const RegionView& view, PreparedFrame& out) {
    for (std::uint32_t j = 0; j < block.size(); ++j) {
        NodeVisit& parent = visits[block[j]];
        out.hidden += slot_hidden[j];
        out.left_out += slot_left_out[j];
        std::uint32_t reps = 0;
        for (std::uint32_t k = 0; k < slot_count[j]; ++k) reps += slots[slot_first[j] + k].rep_count;
        if (visits.size() + slot_count[j] > candidate_of.size() || choice_bound + reps > options.max_choices) {
            out.truncated = true;
            parent.open = false;
            continue;
        }
        choice_bound += reps;
        const std::uint32_t end = slot_first[j] + model.nodes[parent.node].child_count;  // what is hidden stands there
        Box now;
        for (std::uint32_t k = 1; k <= slot_hidden[j] && hidden_nodes.size() < max_hidden; ++k)
            hidden_nodes.push_back({outline_of(view, box_of(slots[end - k].node, now)), block[j]});
        parent.first_child = static_cast<Index>(visits.size());
        parent.child_count = slot_count[j];
        const auto first = slots.begin() + slot_first[j];
        visits.insert(visits.end(), first, first + slot_count[j]);
    }
}

void Preparer::Impl::expand_level(const RegionView& view, const model::Frustum& frustum, Index begin, Index end,
                                  PreparedFrame& out) {
    for (Index at = begin; at < end;) {
        block.clear();
        std::uint32_t used = 0;
        for (; at < end; ++at) {
            if (!visits[at].open) continue;
            const std::uint32_t children = model.nodes[visits[at].node].child_count;
            if (used + children > slots.size()) break;
            slot_first[block.size()] = used;
            used += children;
            block.push_back(at);
        }
        CHECK(!block.empty() || at == end, "A block holds at least the children of one node");
        out.visits += used;
        const auto parents = static_cast<std::uint32_t>(block.size());
        slot_first[block.size()] = used;
        for_chunks((parents + parents_a_chunk - 1) / parents_a_chunk, [&](std::uint32_t chunk) {
            const std::uint32_t last = std::min(parents, (chunk + 1) * parents_a_chunk);
            // Of the work that is left, by the number of children: so it is the same at any number of workers.
            const std::uint64_t children = slot_first[last] - slot_first[chunk * parents_a_chunk];
            const auto own = static_cast<std::uint32_t>(children * parts_left / used);
            std::uint32_t parts = own;
            for (std::uint32_t j = chunk * parents_a_chunk; j < last; ++j) visit_children(view, frustum, j, parts);
            chunk_parts[chunk] = own - parts;
        });
        for (std::uint32_t chunk = 0; chunk * parents_a_chunk < parents; ++chunk) parts_left -= chunk_parts[chunk];
        close_up_block(view, out);
    }
}

// Upwards: an opened node is visible if one of its children is (Maciel 1994, section 3.5.3). Then places for the live ones.
void Preparer::Impl::drop_false_positives(PreparedFrame& out) {
    for (std::size_t i = visits.size(); i-- > 0;) {
        NodeVisit& visit = visits[i];
        if (!visit.open) continue;
        visit.live = false;
        for (std::uint32_t k = 0; k < visit.child_count && !visit.live; ++k) visit.live = visits[visit.first_child + k].live;
    }
    make_room(out);
}

/// Places for the candidates and choices of the live visits.
void Preparer::Impl::make_room(PreparedFrame& out) {
    CHECK(visits.size() <= candidate_of.size(), "No more nodes are visited than were reserved");
    Index candidate = 0;
    std::uint32_t choice = 0;
    for (std::size_t i = 0; i < visits.size(); ++i) {
        if (i % visits_a_chunk == 0) {
            chunk_candidate[i / visits_a_chunk] = candidate;
            chunk_choice[i / visits_a_chunk] = choice;
        }
        candidate_of[i] = candidate;
        if (visits[i].live) {
            ++candidate;
            choice += visits[i].rep_count;
        }
    }
    out.candidates.resize(candidate);
    out.choices.resize(choice);
}

/// Of what is hidden, the nearest ancestor that is a candidate.
void Preparer::Impl::find_hidden_parents() {
    if (visits.empty() || !visits[0].live) hidden_nodes.clear();
    for (HiddenNode& hidden : hidden_nodes) {
        Index visit = hidden.parent;
        while (!visits[visit].live) visit = visits[visit].parent;
        hidden.parent = candidate_of[visit];
    }
}

void Preparer::Impl::evaluate_all(const RegionView& view, PreparedFrame& out) {
    const auto count = static_cast<std::uint32_t>(visits.size());
    const std::uint32_t chunks = (count + visits_a_chunk - 1) / visits_a_chunk;
    for_chunks(chunks, [&](std::uint32_t chunk) {
        std::uint32_t choice = chunk_choice[chunk];
        const std::uint32_t last = std::min(count, (chunk + 1) * visits_a_chunk);
        for (std::uint32_t i = chunk * visits_a_chunk; i < last; ++i) {
            const NodeVisit& visit = visits[i];
            if (!visit.live) continue;
            Candidate candidate;
            candidate.node = visit.node;
            candidate.parent = visit.parent == none ? none : candidate_of[visit.parent];
            if (visit.open) {
                const Index end = visit.first_child + visit.child_count;
                candidate.first_child = candidate_of[visit.first_child];
                for (Index k = visit.first_child; k < end; ++k) candidate.child_count += visits[k].live ? 1U : 0U;
            }
            candidate.first_choice = choice;
            const auto moves = moving.find(visit.node);
            Weight& weight = weights[candidate_of[i]];
            Choice* const choices = &out.choices[choice];
            if (moves)
                choice +=
                    evaluator.evaluate(seen_at_rest(view, *moves), moves->rest, visit.nearest_m, candidate, choices, weight);
            else
                choice += evaluator.evaluate(view, visit.nearest_m, candidate, choices, weight);
            out.candidates[candidate_of[i]] = candidate;
        }
        chunk_count[chunk] = choice - chunk_choice[chunk];
    });
    std::uint32_t to = 0;
    for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) {  // close the gaps that illegal and dominated forms left
        const std::uint32_t from = chunk_choice[chunk], gap = from - to;
        if (gap > 0) {
            std::copy_n(out.choices.begin() + from, chunk_count[chunk], out.choices.begin() + to);
            const std::size_t end = chunk + 1 < chunks ? chunk_candidate[chunk + 1] : out.candidates.size();
            for (std::size_t c = chunk_candidate[chunk]; c < end; ++c) out.candidates[c].first_choice -= gap;
        }
        to += chunk_count[chunk];
    }
    out.choices.resize(to);
}

void Preparer::Impl::set_values(const RegionView& view, PreparedFrame& out) {
    Looks looks = looks_of(model, options.sky, groups.get());
    looks.forgiven = forgiven;
    values.run(costs.combine, view.resolved_rad, weights, shown_px, out, looks, shown.before_sky());
}

/// The same weighted pixels as in the value of forms, times the share of a missing thing's loss.
void Preparer::Impl::value_effects(PreparedFrame& out) const {
    constexpr float of_missing_unmeasured = 1.0F / 6;  // as BlurLoss has it
    out.effect_value = {};
    const float of_missing = model.losses.empty() ? of_missing_unmeasured : looks_of(model, options.sky).of_missing;
    for (std::size_t g = 0; g < max_effect_groups; ++g) {
        const EffectLoss& loss = effect_losses[g];
        if (loss.before.empty()) continue;
        double sum = 0;
        for (std::size_t i = 0; i < out.candidates.size(); ++i) {
            if (out.candidates[i].child_count > 0) continue;
            const Index node = out.candidates[i].node;
            const float of_node = loss.before[node] + loss.between * (loss.after[node] - loss.before[node]);
            const float seen = std::exp2(-loss.fog_density * weights[i].distance_m), in_fog = loss.is_fog ? 1.0F - seen : seen;
            const float share = std::min(1.0F, of_node * in_fog * in_fog / of_missing);
            sum += static_cast<double>(weights[i].pixel_weight * shown_px[i] * share);
        }
        out.effect_value[g] = static_cast<float>(sum);
    }
}

// A band between raising and lowering, so that the target does not swing while the eye stands still.
void Preparer::Impl::adapt(const PreparedFrame& out) {
    if (options.max_visits == 0 || options.full_depth) return;
    const float use = static_cast<float>(out.visits) / static_cast<float>(options.max_visits);
    if (use > 1.0F)
        target_factor = std::min(1e6F, target_factor * std::clamp(std::sqrt(use), 1.1F, 2.0F));
    else if (use < 0.75F)
        target_factor = std::max(1.0F, target_factor / 1.1F);
}

Preparer::Preparer(const model::Model& model, const model::CostModel& costs, const PrepareOptions& options)
    : impl_(std::make_unique<Impl>(model, costs, options)) {
    reserve(impl_->tried);
}
Preparer::~Preparer() = default;
void Preparer::end_workers() { impl_->workers.end(); }

void Preparer::set_effect_losses(const std::array<EffectLoss, max_effect_groups>& losses) { impl_->effect_losses = losses; }

void Preparer::set_cover(const model::CoverTest* test) { impl_->cover = test; }

const model::ItemCosts& Preparer::item_costs() const { return impl_->evaluator.item_costs(); }

void Preparer::reserve(PreparedFrame& frame) const {
    frame.candidates.reserve(impl_->visits.capacity());
    frame.choices.reserve(std::min<std::size_t>(impl_->options.max_choices, std::max<std::size_t>(impl_->model.reps.size(), 1)));
}

void Preparer::run(const Region& region, model::Viewport viewport, std::uint64_t frame, double speed_mps, double turn_rps,
                   PreparedFrame& out) {
    Impl& s = *impl_;
    const std::int64_t cpu_start = rt::own_cpu_ns(), wall_start = rt::monotonic_ns();
    s.worker_cpu_ns.store(0, std::memory_order_relaxed);
    s.visits.clear();
    s.hidden_nodes.clear();
    out.frame = frame;
    out.viewport = viewport;
    out.acuity_rad = s.options.acuity_rad;
    if (s.options.acuity_fov_y_rad > 0)
        out.acuity_rad = std::clamp(
            out.acuity_rad * std::tan(region.centre.fov_y_rad / 2) / std::tan(s.options.acuity_fov_y_rad / 2), 0.0, 1.0);
    out.candidates.clear();
    out.choices.clear();
    out.truncated = false;
    out.full_cost = {};
    out.full_value = 0;
    out.effect_value = {};
    out.visits = out.hidden = out.left_out = 0;
    if (s.model.nodes.empty()) return;

    const model::Node& root = s.model.nodes[0];
    out.region = cleaned(region, root.box);
    const Pose& pose = out.region.centre;
    out.resolution = out.resolution > 0.0F && out.resolution < 1.0F ? out.resolution : 1.0F;
    s.last_speed_mps = speed_mps;
    s.last_turn_rps = turn_rps;
    s.used_factor = s.target_factor;
    s.moving.set_span(out.from_s, out.to_s);
    const RegionView view = region_view(out, s.options, s.used_factor, speed_mps, turn_rps);
    out.target_error_rad = view.full_depth ? 0.0F : view.target_error_rad;

    const model::Frustum frustum =
        model::make_frustum(pose, viewport, model::far_corners_m(root.box), view.radius_m, out.region.angle_rad);
    const PlaneMask mask = cull_planes(frustum, root.box, all_planes);
    s.occlusion.draw(out.region, viewport);
    s.parts_left = Occlusion::max_parts_a_set;
    out.visits = 1;
    s.choice_bound = root.rep_count;
    s.covered = s.cover != nullptr && out.covered.any() ? &out.covered : nullptr;
    const bool all_covered = s.covered != nullptr && s.cover->covered(0, out.covered);
    if (mask != culled && !all_covered) s.visits.push_back(s.visit_of(view, 0, none, mask));
    for (Index begin = 0, end = static_cast<Index>(s.visits.size()); begin < end;) {
        s.expand_level(view, frustum, begin, end, out);
        begin = end;
        end = static_cast<Index>(s.visits.size());
    }
    s.drop_false_positives(out);
    s.find_hidden_parents();
    s.evaluate_all(view, out);
    s.tried.region = out.region;
    s.tried.viewport = viewport;
    s.tried.acuity_rad = out.acuity_rad;
    s.tried.without = out.without;
    s.tried.full_factor = out.full_factor;
    s.tried.coarse_factor = out.coarse_factor;
    s.shown_px = s.shown.run(s.weights, out.candidates, out.choices, view.wide, view.scale,
                             {&s.model, &s.evaluator.item_costs().estimator(), view.eye, s.moving.any() ? &s.moving : nullptr},
                             s.hidden_nodes);
    s.set_values(view, out);
    s.value_effects(out);
    propagate_up(s.costs.combine, view.resolved_rad, s.weights, out);
    enforce_monotone_benefit(out);
    s.adapt(out);
    out.cpu_us = 1e-3 * static_cast<double>(rt::own_cpu_ns() - cpu_start + s.worker_cpu_ns.load());
    out.wall_us = 1e-3 * static_cast<double>(rt::monotonic_ns() - wall_start);
}

const ValueCurve& Preparer::value_at(float resolution) {
    Impl& s = *impl_;
    const std::int64_t cpu_start = rt::own_cpu_ns(), wall_start = rt::monotonic_ns();
    s.worker_cpu_ns.store(0, std::memory_order_relaxed);
    s.tried.resolution = resolution;
    s.make_room(s.tried);
    const RegionView view = region_view(s.tried, s.options, s.used_factor, s.last_speed_mps, s.last_turn_rps);
    s.evaluate_all(view, s.tried);
    s.set_values(view, s.tried);
    s.tried.cpu_us = 1e-3 * static_cast<double>(rt::own_cpu_ns() - cpu_start + s.worker_cpu_ns.load());
    s.tried.wall_us = 1e-3 * static_cast<double>(rt::monotonic_ns() - wall_start);
    return s.tried.curve;
}

void Preparer::add_value_time(PreparedFrame& out) const {
    out.cpu_us += impl_->tried.cpu_us;
    out.wall_us += impl_->tried.wall_us;
}

}  // namespace surefoot::prepare
