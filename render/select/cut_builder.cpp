// Makes the cut from the choice of each candidate: floor, list of items, sums, hash, switches, memory.
#include "render/select/cut_builder.hpp"

#include <algorithm>
#include <cmath>

#include "render/select/bucket_queue.hpp"
#include "render/select/scratch.hpp"
#include "rt/base/hash.hpp"

namespace surefoot::select {

namespace {

// One multiplication an item: FNV-1a over eight bytes each takes longer than the whole search.
std::uint64_t mixed(std::uint64_t hash, const CutItem& item) {
    hash = (hash ^ (static_cast<std::uint64_t>(item.node) << 32U | item.rep)) * 0x9e3779b97f4a7c15ULL;
    return hash ^ (hash >> 29U);
}

}  // namespace

float error_no_more_than(double error_rad) {
    if (!(error_rad > 0.0)) return 0.0F;
    const auto nearest = static_cast<float>(error_rad);
    return static_cast<double>(nearest) > error_rad ? std::nextafter(nearest, 0.0F) : nearest;
}

SelectState::SelectState() : scratch_(std::make_unique<Scratch>()) {}
SelectState::~SelectState() = default;
SelectState::SelectState(SelectState&&) noexcept = default;
SelectState& SelectState::operator=(SelectState&&) noexcept = default;

std::uint32_t SelectState::max_candidates() const { return static_cast<std::uint32_t>(scratch_->chosen.size()); }

void SelectState::reserve(const model::Model& model, std::uint32_t max_candidates) {
    shown.assign(model.nodes.size(), none);
    bought.clear();
    bought_before.clear();
    size_factor = 1;
    for (std::vector<Shown>* list : {&touched, &before}) {
        list->clear();
        list->reserve(max_candidates);
    }
    scratch_->links.resize(max_candidates);
    scratch_->queue_heads.resize(2 * BucketQueue::buckets);
    scratch_->step_sums.resize(4 * BucketQueue::buckets);
    scratch_->saved.resize(max_candidates);
    scratch_->lacks.resize(max_candidates);
    scratch_->below.resize(max_candidates);
    scratch_->chosen.resize(max_candidates);
    scratch_->starts.resize(max_candidates);
    scratch_->list.resize(max_candidates);
}

void reserve(Cut& cut, std::uint32_t max_candidates) { cut.items.reserve(max_candidates); }

void clear(Cut& cut) {
    cut.items.clear();
    cut.sum = {};
    cut.predicted_us = cut.floor_us = cut.worst_error_rad = cut.worst_weighted_rad = 0;
    cut.floor_binds = false;
    cut.guarantee = rt::Guarantee::none;
    cut.benefit = cut.value = 0;
    cut.bought = {};
    cut.dropped = {};
    cut.triangles = cut.hash = 0;
    cut.switches = cut.refinements = 0;
}

bool has_room(const SelectInput& input, const SelectState& state, const Cut& cut) {
    const std::size_t n = input.prepared->candidates.size();
    return n > 0 && n <= state.max_candidates() && n <= state.touched.capacity() && n <= state.before.capacity() &&
           n <= cut.items.capacity();
}

CutBuilder::CutBuilder(const SelectInput& input, SelectState& state)
    : prepared_(*input.prepared),
      state_(state),
      chosen_(std::span(state.scratch().chosen).first(input.prepared->candidates.size())),
      saved_(std::span(state.scratch().saved).first(input.prepared->candidates.size())),
      scratch_(std::span(state.scratch().list).first(input.prepared->candidates.size())),
      lacks_(std::span(state.scratch().lacks).first(input.prepared->candidates.size())),
      below_(std::span(state.scratch().below).first(input.prepared->candidates.size())),
      starts_(std::span(state.scratch().starts).first(input.prepared->candidates.size())),
      guaranteed_rad_(error_no_more_than(input.max_error_rad)),
      items_(input) {}

// Candidates are in breadth-first order, so a first-in first-out walk meets them ascending.
std::span<std::uint32_t> CutBuilder::take_floor() {
    std::fill(chosen_.begin(), chosen_.end(), none);
    floor_ = {};
    std::size_t head = 0, tail = 1, items = 0;
    scratch_[0] = 0;
    while (head < tail) {
        const Index c = scratch_[head++];
        const prepare::Candidate& candidate = prepared_.candidates[c];
        if (candidate.floor_open) {
            open(c);
            for (Index k = 0; k < candidate.child_count; ++k) scratch_[tail++] = candidate.first_child + k;
        } else {
            choose(c, 0);
            floor_.add(prepared_.choices[candidate.first_choice].cost);
            scratch_[items++] = c;
        }
    }
    return scratch_.first(items);
}

void CutBuilder::start_with(std::span<const std::uint32_t> decisions, float max_error_rad) {
    max_error_rad_ = max_error_rad;
    for (auto c = static_cast<Index>(starts_.size()); c-- > 0;) {  // children come after their parents
        Start& start = starts_[c] = {};
        start.choice = decisions[c];
        const prepare::Candidate& at = candidate(c);
        for (Index child = at.first_child; child < at.first_child + at.child_count; ++child) {
            const Start& below = starts_[child];
            start.children_cost += below.choice == SelectState::opened ? below.children_cost : choices(child)[below.choice].cost;
            start.children_value += below.value;
            start.worst_rad = std::max(start.worst_rad, below.worst_rad);
        }
        const bool opened = start.choice == SelectState::opened;
        start.may_open = opened || start.worst_rad <= max_error_rad;
        if (!opened) start.worst_rad = weighted_error(c, choices(c)[start.choice]);
        start.value = opened ? start.children_value : choices(c)[start.choice].value;
    }
    start_ = {};
    start_.add(first_choice(0) == SelectState::opened ? starts_[0].children_cost : choices(0)[first_choice(0)].cost);
}

std::span<std::uint32_t> CutBuilder::take_start() {
    if (!has_starts()) return take_floor();
    std::size_t items = 0;
    for (Index c = 0; c < chosen_.size(); ++c) {
        const Index parent = candidate(c).parent;
        chosen_[c] = parent != none && chosen_[parent] != SelectState::opened ? none : starts_[c].choice;
        if (chosen_[c] < SelectState::opened) scratch_[items++] = c;
    }
    return scratch_.first(items);
}

// Without recursion: trees may be chains of thousands.
void CutBuilder::open_to_children(Index c) {
    open(c);
    Index at = candidate(c).first_child;
    while (true) {
        if (first_choice(at) == SelectState::opened) {
            open(at);
            at = candidate(at).first_child;
            continue;
        }
        choose(at, first_choice(at));
        Index parent = candidate(at).parent;
        while (at != c && at + 1 == candidate(parent).first_child + candidate(parent).child_count) {
            at = parent;
            parent = candidate(at).parent;
        }
        if (at == c) return;
        ++at;
    }
}

double CutBuilder::value() const {
    double sum = 0;
    for (Index c = 0; c < chosen_.size(); ++c)
        if (chosen_[c] < SelectState::opened) sum += static_cast<double>(current(c).value);
    return sum;
}

float CutBuilder::children_value(Index c) const {
    if (has_starts()) return starts_[c].children_value;
    float sum = 0;
    for (Index k = 0; k < candidate(c).child_count; ++k) sum += choices(candidate(c).first_child + k)[0].value;
    return sum;
}

std::span<float> CutBuilder::what_items_lack() {
    for (std::size_t c = chosen_.size(); c-- > 0;) {  // first: the value of full detail
        const prepare::Candidate& at = candidate(static_cast<Index>(c));
        lacks_[c] = at.child_count == 0 ? choices(static_cast<Index>(c)).back().value : 0.0F;
        for (Index k = 0; k < at.child_count; ++k) lacks_[c] += lacks_[at.first_child + k];
    }
    for (Index c = 0; c < chosen_.size(); ++c) {
        if (chosen_[c] == SelectState::opened) continue;
        lacks_[c] = chosen_[c] == none ? lacks_[candidate(c).parent]
                    : lacks_[c] > 0.0F ? std::clamp(1.0F - current(c).value / lacks_[c], 0.0F, 1.0F)
                                       : 0.0F;
    }
    return lacks_;
}

// Values of different nodes come from pictures of different distances, so a small difference between them says little.
void CutBuilder::undo_losses(float shown_counts) {
    constexpr float clearly = 1.3F;
    bool any = false;
    for (auto c = static_cast<Index>(chosen_.size()); c-- > 0;) {
        float& value = lacks_[c] = 0;
        Sum& cost = below_[c] = {};
        if (chosen_[c] == none) continue;
        const auto own = choices(c);
        const auto take = [&](std::uint32_t k) {
            value = own[k].value;
            cost = {};
            cost.add(own[k].cost);
        };
        if (chosen_[c] != SelectState::opened) {
            take(chosen_[c]);
            continue;
        }
        const prepare::Candidate& at = candidate(c);
        for (Index child = at.first_child; child < at.first_child + at.child_count; ++child) {
            value += lacks_[child];
            cost = cost + below_[child];
        }
        const float keeps =
            value * clearly * (state_.hysteresis > 1.0F && state_.shown[at.node] == SelectState::opened ? shown_counts : 1.0F);
        for (std::uint32_t k = at.choice_count; k-- > 0;) {  // the finest first
            const auto [submit_us, raster_us] = own[k].cost;
            if (static_cast<double>(submit_us) > cost.submit_us || static_cast<double>(raster_us) > cost.raster_us) continue;
            if (!(own[k].value > keeps) || weighted_error(c, own[k]) > max_error_rad_) continue;
            choose(c, k);
            take(k);
            any = true;
            break;
        }
    }
    if (!any) return;
    for (Index c = 1; c < chosen_.size(); ++c)
        if (chosen_[candidate(c).parent] != SelectState::opened) chosen_[c] = none;
}

void CutBuilder::save() { std::copy(chosen_.begin(), chosen_.end(), saved_.begin()); }
void CutBuilder::restore() { std::copy(saved_.begin(), saved_.end(), chosen_.begin()); }

void CutBuilder::buy_items(Budget& budget) {
    if (items_.offered().empty()) return items_.count_refused();
    take_start();
    items_.buy_before_forms(*this, state_, budget);
}

std::uint32_t CutBuilder::take_finest() {
    std::uint32_t steps = 0;
    for (Index c = 0; c < chosen_.size(); ++c) {
        const prepare::Candidate& candidate = prepared_.candidates[c];
        const bool leaf = candidate.child_count == 0;
        if (chosen_[c] != SelectState::opened) steps += candidate.choice_count - (leaf ? 1U : 0U);  // else the floor did
        chosen_[c] = leaf ? candidate.choice_count - 1 : SelectState::opened;
    }
    return steps;
}

bool CutBuilder::finest_is_cheapest(const Budget& budget) const {
    Sum full;
    full.add(prepared_.full_cost);
    return budget.predicted_us(full) * (1.0 + 1e-6) < budget.predicted_us(floor_);
}

bool CutBuilder::finest_breaks_guarantee() const {
    if (guarantee_ != rt::Guarantee::kept) return false;
    for (Index c = 0; c < chosen_.size(); ++c)
        if (candidate(c).child_count == 0 && weighted_error(c, choices(c).back()) > guaranteed_rad_) return true;
    return false;
}

void CutBuilder::take_root(std::uint32_t offset) {
    take_floor();  // for its cost
    std::fill(chosen_.begin(), chosen_.end(), none);
    choose(0, offset);
}

// A node that came into view is no switch. A node that was shown by another form, an ancestor or descendants is one.
bool CutBuilder::switched(Index c, Index rep) const {
    const Index before = state_.shown[prepared_.candidates[c].node];
    if (before != none) return before != rep;
    for (Index p = prepared_.candidates[c].parent; p != none; p = prepared_.candidates[p].parent) {
        const Index above = state_.shown[prepared_.candidates[p].node];
        if (above != none) return above != SelectState::opened;
    }
    return false;
}

void CutBuilder::list_items(Budget& budget, Cut& cut) {
    Sum sum;
    cut.hash = fnv_start;
    for (Index c = 0; c < chosen_.size(); ++c) {
        if (chosen_[c] >= SelectState::opened) continue;
        const prepare::Candidate& candidate = prepared_.candidates[c];
        const Index k = candidate.first_choice + chosen_[c];
        const prepare::Choice& choice = prepared_.choices[k];
        const CutItem item{c, candidate.node, choice.rep, k};
        cut.items.push_back(item);
        sum.add(choice.cost);
        cut.worst_error_rad = std::max(cut.worst_error_rad, choice.error_rad);
        cut.worst_weighted_rad = std::max(cut.worst_weighted_rad, weighted_error(c, choice));
        cut.benefit += 1.0 - static_cast<double>(choice.benefit);
        cut.value += static_cast<double>(choice.value);
        cut.triangles += choice.triangles;
        cut.switches += switched(c, choice.rep) ? 1U : 0U;
        cut.hash = mixed(cut.hash, item);
    }
    cut.sum = {static_cast<float>(sum.submit_us), static_cast<float>(sum.raster_us)};
    items_.buy_what_fits(sum, state_, budget);
    cut.bought = items_.bought();
    cut.predicted_us = static_cast<float>(budget.predicted_us(sum));
}

void CutBuilder::remember(const Cut& cut) {
    state_.bought_before = state_.bought;
    state_.bought.remember(items_.offered(), cut.bought);
    for (const Shown& last : state_.touched) state_.shown[last.node] = none;
    std::swap(state_.before, state_.touched);
    state_.touched.clear();
    const CutItem* item = cut.items.data();  // one a candidate that is drawn, in order
    for (Index c = 0; c < chosen_.size(); ++c) {
        if (chosen_[c] == none) continue;
        const bool open = chosen_[c] == SelectState::opened;
        const Shown now = open ? Shown{prepared_.candidates[c].node, SelectState::opened} : Shown{item->node, item->rep};
        if (!open) ++item;
        state_.shown[now.node] = now.form;
        state_.touched.push_back(now);
    }
}

void CutBuilder::finish(Budget& budget, std::uint32_t refinements, Cut& cut) {
    list_items(budget, cut);
    // What is drawn is a legal cut: if it is cheaper than the floor, it is the floor.
    cut.floor_us = std::min(static_cast<float>(budget.forms_us(floor_)), cut.predicted_us);
    cut.floor_binds = !budget.fits_us(static_cast<double>(cut.floor_us));
    cut.refinements = refinements;
    if (guarantee_ != rt::Guarantee::none) {
        const rt::Guarantee broken = guarantee_ > rt::Guarantee::kept ? guarantee_ : rt::Guarantee::no_form;
        cut.guarantee = cut.worst_weighted_rad <= guaranteed_rad_ ? rt::Guarantee::kept : broken;
    }
    remember(cut);
}

std::string check_legal(const prepare::PreparedFrame& prepared, const Cut& cut) {
    const auto& candidates = prepared.candidates;
    std::vector<std::uint8_t> covered(candidates.size(), 0);
    for (const CutItem& item : cut.items) {
        if (item.candidate >= candidates.size()) return "The candidate of an item does not exist";
        const prepare::Candidate& c = candidates[item.candidate];
        if (item.node != c.node) return "The item of candidate " + std::to_string(item.candidate) + " names another node";
        if (item.choice < c.first_choice || item.choice - c.first_choice >= c.choice_count ||
            prepared.choices[item.choice].rep != item.rep) {
            return "Candidate " + std::to_string(item.candidate) + " is drawn by a form that is none of its choices";
        }
        if (covered[item.candidate] != 0) return "Candidate " + std::to_string(item.candidate) + " is drawn twice";
        covered[item.candidate] = 1;
    }
    for (std::size_t i = 0; i < candidates.size(); ++i) {  // parents before children: one pass hands the cover down
        const prepare::Candidate& c = candidates[i];
        const bool above = c.parent != none && covered[c.parent] != 0;
        if (above && covered[i] != 0) return "Candidate " + std::to_string(i) + " is drawn below a drawn ancestor";
        if (above) covered[i] = 1;
        if (c.child_count == 0 && covered[i] == 0) return "The visible leaf " + std::to_string(i) + " is not covered";
    }
    return {};
}

}  // namespace surefoot::select
