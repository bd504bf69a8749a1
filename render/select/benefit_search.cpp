// Best-first and two-stage best-first search. Source: Maciel 1994, 3.5; here a step costs what it changes in the frame.
//
// A step replaces a choice by the next finer one, or by the children. Steps are taken in the order of their benefit, highest
// first, until the budget ends. Benefits fall down the tree, so this order needs no queue. Three walks over the candidates:
//   1. Sum the costs of all steps by bucket of their benefit. A bucket is 1/128 octave wide; benefits in it count as equal.
//      Adding the buckets up from the highest benefit tells in which one the budget ends: the edge.
//   2. Take all steps before the edge. Try those in its bucket in turn, by candidate and then by form, until one does not fit.
//   3. With hysteresis, steps of the last frame may use all of the budget, new steps only a share of it. So try steps of the last
//      frame behind the edge, in the same way, with what is left.
// The first walk notes what it computed for each candidate, so that the second reads little more than the notes.
// By rate, three things follow: cheaper steps that still fit, lossy steps undone, and the search once more from dear steps that
// were passed over.
#include <algorithm>
#include <array>

#include "render/select/bucket_queue.hpp"
#include "render/select/common_error.hpp"
#include "render/select/cut_builder.hpp"
#include "render/select/entries.hpp"
#include "render/select/scratch.hpp"
#include "render/select/step_sums.hpp"

namespace surefoot::select {

namespace {

constexpr std::uint32_t buckets = key_buckets;

/// Where the budget ends. All steps of buckets before `bucket` are taken. In it, steps are tried in turn. Behind it, none is
/// taken.
struct Edge {
    std::uint32_t bucket = buckets;
    Sum before;  ///< predicted sums of all that is taken before the bucket
};

/// One selection: three walks over the candidates, which stand parents before children.
class ThresholdSearch {
public:
    ThresholdSearch(const SelectInput& input, SelectState& state, CutBuilder& builder, const Budget& budget, Key key)
        : builder_(builder),
          budget_(budget),
          steps_(input, state, key),
          sums_(state.scratch().step_sums),
          scan_state_(builder.scratch()),
          share_(fresh_share(state)),
          deferred_(state.scratch().links) {}

    /// Returns the number of steps taken.
    std::uint32_t run(bool fill) {
        sum_ = builder_.start_sum();
        search();
        if (fill) {
            fill_up();
            if (builder_.size() <= max_dear_candidates) try_dear_forms();
        }
        return taken_;
    }
    /// From the builder's start on, what still fits, without a search. Returns the number of steps.
    std::uint32_t run_rest() {
        sum_ = builder_.start_sum();
        fill_up();
        return taken_;
    }

private:
    [[nodiscard]] StepPlace step_of(const prepare::Choice& now, Index shown) const { return place_of(steps_, now, shown); }
    template <class Use>
    bool for_steps(Index c, const Use& use) const {
        return select::for_steps(builder_, steps_, c, use);
    }

    /// A form of a candidate; `opening`: its children.
    struct Target {
        Index candidate = none;
        std::uint32_t choice = 0;
        bool operator==(const Target& other) const { return candidate == other.candidate && choice == other.choice; }
    };
    static constexpr std::uint32_t opening = none - 1;

    /// Takes what still fits. A dear step may follow others that lose value by themselves: if it did not fit, they are undone.
    /// `sum_` and `taken_` still count them. Nothing is bought after that: the room that is left stays.
    void fill_up() {
        for (int round = 0; round < fill_rounds && take_more(); ++round) {
        }
        if (!steps_.has_target()) builder_.undo_losses(1.0F + static_cast<float>(min_gain));
    }

    /// All steps behind what is chosen, by their sums: up to the edge.
    void search() {
        sum_steps(builder_, steps_, sums_, scan_state_);
        const Edge both = common_edge(sum_);
        take_common(both);
        if (deferred_count_ > 0 && !closed_) take_deferred(refined_edge(both));
    }

    /// Cheap steps may have filled the budget before a dear one that is worth more than they are. So the search starts again from
    /// the forms that add most, one after the other. It keeps those with which the cut has more value. A form that the last frame
    /// showed may lose a little, another has to win as much: else frames would alternate.
    void try_dear_forms() {
        std::array<Target, 2 * max_dear> tried{};
        std::array<Target, max_dear> kept{};
        std::uint32_t tried_count = 0, searches = 0, kept_count = 0, kept_taken = taken_;
        double best = builder_.value();
        builder_.save();
        while (tried_count < tried.size() && searches < max_dear) {
            const Target next = dearest(std::span(tried).first(tried_count), static_cast<float>(min_gain * best));
            if (next.candidate == none) break;
            tried[tried_count++] = kept[kept_count] = next;
            bool better = false;
            if (start_from(std::span(kept).first(kept_count + 1))) {
                ++searches;
                search();
                fill_up();
                const double value = builder_.value();
                better = value > best * (was_shown(next) ? 1.0 - min_gain : 1.0 + min_gain);
                if (better) best = std::max(best, value);
            }
            if (better) {
                ++kept_count;
                kept_taken = taken_;
                builder_.save();
            } else {
                builder_.restore();
            }
        }
        taken_ = kept_taken;
    }

    /// What adds most to the value: the next step of an item, or full detail of a leaf. None: nothing adds more than `above`.
    /// A leaf below an item counts by the share of its value that the item lacks.
    [[nodiscard]] Target dearest(std::span<const Target> tried, float above) const {
        Target found;
        const auto consider = [&](float gain, const Target& target) {
            if (!(gain > above) || std::find(tried.begin(), tried.end(), target) != tried.end()) return;
            above = gain;
            found = target;
        };
        const std::span<float> lacks = builder_.what_items_lack();
        for (Index c = 0; c < builder_.size(); ++c) {
            const std::uint32_t now = builder_.chosen(c);
            if (now == SelectState::opened) continue;
            const auto choices = builder_.choices(c);
            const auto last = static_cast<std::uint32_t>(choices.size()) - 1;
            if (builder_.candidate(c).child_count == 0 && now != last && !steps_.has_target())
                consider(lacks[c] * choices[last].value, {c, last});
            if (now == none || !builder_.has_step(c) || !steps_.wanted(choices[now])) continue;
            if (now < last)
                consider(choices[now + 1].value - choices[now].value, {c, now + 1});
            else
                consider(builder_.children_value(c) - choices[now].value, {c, opening});
        }
        return found;
    }
    [[nodiscard]] bool was_shown(const Target& target) const {
        const Index shown = steps_.shown(builder_.candidate(target.candidate).node);
        if (shown == none || target.choice == opening) return shown == SelectState::opened;
        return shown >= builder_.choices(target.candidate)[target.choice].rep;
    }

    /// From the start to the targets, and what stands above them. False: they do not fit.
    bool start_from(std::span<const Target> targets) {
        builder_.take_start();
        sums_.clear();
        sum_ = builder_.start_sum();
        taken_ = deferred_count_ = 0;
        closed_ = false;
        double share = 1.0;
        for (const Target& target : targets) {
            Index closed = builder_.candidate(target.candidate).parent;
            while (closed != none && builder_.chosen(closed) != SelectState::opened) {
                Index top = closed;  // the highest that is not opened yet is an item
                while (builder_.chosen(top) == none) top = builder_.candidate(top).parent;
                if (!builder_.may_open(top)) return false;
                step_to(top, opening);
            }
            step_to(target.candidate, target.choice);
            if (!was_shown(target)) share = share_;
        }
        return budget_.fits(sum_, share);
    }
    void step_to(Index c, std::uint32_t choice) {
        const auto choices = builder_.choices(c);
        for (std::uint32_t k = builder_.chosen(c); k < choice && k < choices.size(); ++k) {
            const bool opens = k + 1 == choices.size();
            sum_ = sum_.changed(choices[k].cost, opens ? builder_.children_cost(c) : choices[k + 1].cost);
            do_step(c, k, opens);
        }
    }

    /// A step that does not fit has ended the search; others behind it may still fit. The same search among those that fit one by
    /// one. Returns whether any was taken.
    bool take_more() {
        sums_.clear();
        const auto each_left = [&](const auto& use) {
            for (Index c = 0; c < builder_.size(); ++c) {
                if (builder_.chosen(c) >= SelectState::opened) continue;
                const auto choices = builder_.choices(c);
                const Index shown = steps_.shown(builder_.candidate(c).node);
                for_steps(c, [&](std::uint32_t k, bool opens) {
                    if (k < builder_.chosen(c)) return true;
                    const model::ItemCost& in = opens ? builder_.children_cost(c) : choices[k + 1].cost;
                    return use(c, k, opens, step_of(choices[k], shown), choices[k].cost, in);
                });
            }
        };
        each_left([&](Index, std::uint32_t, bool, const StepPlace& step, const model::ItemCost& away, const model::ItemCost& in) {
            if (!budget_.fits(sum_.changed(away, in), step.refined ? 1.0 : share_)) return false;
            sums_.add(step.bucket, step.refined, away, in);
            return true;
        });
        const Edge edge = common_edge(sum_);
        const std::uint32_t before = taken_;
        each_left(
            [&](Index c, std::uint32_t k, bool opens, const StepPlace& step, const model::ItemCost&, const model::ItemCost&) {
                return step.bucket <= edge.bucket && try_step(c, k, opens, step.refined ? 1.0 : share_) && do_step(c, k, opens);
            });
        return taken_ > before;
    }

    /// The first bucket whose steps do not all fit.
    [[nodiscard]] Edge common_edge(const Sum& spent) const {
        Edge edge{0, spent};
        for (; edge.bucket < buckets; ++edge.bucket) {
            const Sum fresh = sums_.fresh(edge.bucket);
            const Sum next = edge.before + fresh + sums_.refined(edge.bucket);
            if (!budget_.fits(next, nothing(fresh) ? 1.0 : share_)) break;
            edge.before = next;
        }
        return edge;
    }
    /// The same behind the common edge, for steps of the last frame only.
    [[nodiscard]] Edge refined_edge(const Edge& common) const {
        Edge edge{common.bucket + 1, sum_};
        for (; edge.bucket < buckets; ++edge.bucket) {
            const Sum next = edge.before + sums_.refined(edge.bucket);
            if (!budget_.fits(next)) break;
            edge.before = next;
        }
        return edge;
    }

    void take_common(const Edge& edge) {
        sum_ = edge.before;
        bool fresh_closed = edge.bucket == buckets;
        for (Index c = 0; c < builder_.size(); ++c) {
            if (builder_.chosen(c) == SelectState::opened) continue;
            if (builder_.chosen(c) == none) {  // its parent is not opened; the third walk may still do that
                if ((scan_state_[c] & refined_before) != 0) deferred_[deferred_count_++] = c;
                continue;
            }
            if (take_all(c, edge)) continue;
            const auto choices = builder_.choices(c);
            const Index shown = steps_.shown(builder_.candidate(c).node);
            for_steps(c, [&](std::uint32_t k, bool opens) {
                if (k < builder_.chosen(c)) return true;  // a form that the search starts from
                const StepPlace step = step_of(choices[k], shown);
                bool take = step.bucket < edge.bucket;
                if (step.bucket == edge.bucket && !closed_ && (step.refined || !fresh_closed)) {
                    take = try_step(c, k, opens, step.refined ? 1.0 : share_);
                    if (!take) (step.refined ? closed_ : fresh_closed) = true;
                }
                if (take) return do_step(c, k, opens);
                if (step.refined && step.bucket > edge.bucket) deferred_[deferred_count_++] = c;
                return false;
            });
        }
    }

    /// If a candidate's last step lies before the edge, all its steps do: takes them at once. False: it does not.
    bool take_all(Index c, const Edge& edge) {
        if (steps_.has_target()) return false;
        const prepare::Candidate& candidate = builder_.candidate(c);
        const bool opens = builder_.may_open(c);
        const std::uint32_t steps = candidate.choice_count - (opens ? 0U : 1U);
        if (steps == 0) return true;
        if ((scan_state_[c] & last_bucket) >= edge.bucket) return false;
        if (builder_.chosen(c) == steps) return true;  // the finest form of a leaf, from which the search starts
        taken_ += steps - 1 - builder_.chosen(c);
        return do_step(c, steps - 1, opens);
    }

    void take_deferred(const Edge& edge) {
        sum_ = edge.before;
        for (std::uint32_t i = 0; i < deferred_count_; ++i) {
            const Index c = deferred_[i];
            if (builder_.chosen(c) == none) continue;  // its parent was not opened
            const auto choices = builder_.choices(c);
            const Index shown = steps_.shown(builder_.candidate(c).node);
            for_steps(c, [&](std::uint32_t k, bool opens) {
                if (k < builder_.chosen(c)) return true;  // taken already
                const StepPlace step = step_of(choices[k], shown);
                bool take = step.refined && step.bucket < edge.bucket;
                if (step.refined && step.bucket == edge.bucket && !closed_) {
                    take = try_step(c, k, opens, 1.0);
                    closed_ = !take;
                }
                return take && do_step(c, k, opens);
            });
        }
    }

    bool try_step(Index c, std::uint32_t k, bool opens, double share) {
        const auto choices = builder_.choices(c);
        const Sum next = sum_.changed(choices[k].cost, opens ? builder_.children_cost(c) : choices[k + 1].cost);
        if (!budget_.fits(next, share)) return false;
        sum_ = next;
        return true;
    }
    bool do_step(Index c, std::uint32_t k, bool opens) {
        ++taken_;
        if (!opens) {
            builder_.choose(c, k + 1);
            return true;
        }
        builder_.open_to_children(c);
        return true;
    }

    static constexpr int fill_rounds = 4;
    static constexpr std::uint32_t max_dear = 4;
    static constexpr std::uint32_t max_dear_candidates = 1U << 13U;  ///< a search of more would take too long to repeat
    static constexpr double min_gain = 0.01;

    CutBuilder& builder_;
    const Budget& budget_;
    Steps steps_;
    StepSums sums_;
    std::span<std::uint32_t> scan_state_;  ///< what sum_steps() noted
    double share_;
    std::span<std::uint32_t> deferred_;  ///< candidates that the last frame showed finer than the common edge allows, ascending
    std::uint32_t deferred_count_ = 0;
    Sum sum_;
    bool closed_ = false;
    std::uint32_t taken_ = 0;
};

class BenefitSearch final : public Selector {
public:
    explicit BenefitSearch(Key key, bool fill) : key_(key), fill_(fill) {}

    void run(const SelectInput& input, SelectState& state, Cut& cut) const override {
        clear(cut);
        if (!has_room(input, state, cut)) return;
        Budget budget(input);
        CutBuilder builder(input, state);
        builder.take_floor();
        guarantee_error(input, state, builder, budget);
        builder.buy_items(budget);
        const bool finest = full_detail_fits(input, state, budget) || builder.finest_is_cheapest(budget);
        if (finest && !builder.finest_breaks_guarantee()) return builder.finish(budget, builder.take_finest(), cut);
        builder.finish(budget, ThresholdSearch(input, state, builder, budget, key_).run(fill_), cut);
    }

private:
    Key key_;
    bool fill_;
};

const Selector& make_best_first() {
    static const BenefitSearch selector(Key::benefit, false);
    return selector;
}
const Selector& make_threshold() {
    static const BenefitSearch selector(Key::rate, true);
    return selector;
}
const Selector& make_two_stage() {
    static const BenefitSearch selector(Key::subtree_benefit, false);
    return selector;
}

}  // namespace

std::uint32_t fill_by_rate(const SelectInput& input, SelectState& state, CutBuilder& builder, const Budget& budget) {
    return ThresholdSearch(input, state, builder, budget, Key::rate).run_rest();
}

const SelectorEntry best_first_entry{
    "best-first", "the node of the greatest own benefit next, within the budget", GoesBy::budget, true, make_best_first, true};
const SelectorEntry threshold_entry{.name = usual_selector,
                                    .help = "the step of the greatest value per cost next, within the budget",
                                    .make = make_threshold,
                                    .guarantees = true,
                                    .by_value = true};
const SelectorEntry two_stage_entry{"two-stage",    "the node of the greatest benefit in its subtree next, within the budget",
                                    GoesBy::budget, true,
                                    make_two_stage, true};

}  // namespace surefoot::select
