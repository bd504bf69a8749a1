// The update and draw recursions of the image cache, as a plan.
#include "render/cache/update.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#include "rt/base/check.hpp"

namespace surefoot::cache {

namespace {

constexpr double unusable = std::numeric_limits<double>::infinity();

double max_error_of(const CacheView& view, ValidityRules rules) {
    return rules == ValidityRules::corrected ? view.pixels.smallest_rad : view.pixels.mean_rad;
}

/// The picture that a box can get now, with the fewest texels that are no larger than a pixel.
std::optional<Picture> fresh_picture(const Box& box, const CacheView& view, const CacheOptions& options) {
    std::optional<Picture> picture = picture_of(box, view.eye);
    if (!picture) return std::nullopt;
    const double needed = needed_texels(*picture, max_error_of(view, options.rules));
    if (!(needed <= options.max_texels)) return std::nullopt;
    picture->texels = std::max(1U, std::min(options.min_texels, options.max_texels));
    while (picture->texels < needed) picture->texels = std::min(2 * picture->texels, options.max_texels);
    picture->frame = view.frame;
    return picture;
}

double error_of(const Picture& picture, const CacheView& view, ValidityRules rules) {
    const double max = max_error_of(view, rules);
    if (!(texel_rad(picture, view.eye) <= max)) return unusable;
    if (rules == ValidityRules::published) return published_valid(picture, view.eye, max) ? 0 : unusable;
    return picture_errors(picture, view.eye).total();
}

/// One frame's plan in the making. error_[i] is that of the picture that box i has by now.
class FramePlanner {
public:
    FramePlanner(const BoxTree& tree, const CacheView& view, const CacheOptions& options, const CacheState& state,
                 std::span<const BoxFacts> facts)
        : tree_(tree), view_(view), options_(options), facts_(facts), max_error_(max_error_of(view, options.rules)) {
        plan_.after = state;
        plan_.uses.resize(tree.boxes.size(), BoxUse::unused);
        error_.reserve(facts.size());
        for (const BoxFacts& of : facts) error_.push_back(of.error_rad);
    }

    CachePlan run() {
        if (!tree_.boxes.empty()) {
            update(0);
            if (options_.rules == ValidityRules::corrected) refresh_ahead();
            draw(0);
        }
        return std::move(plan_);
    }

private:
    struct AgingChild {
        double frames_left = 0;  ///< until its parent's picture is expected to fail
        double max_error = 0;    ///< that it may have then
        Index box = 0;
    };

    /// Figure 4.
    void update(Index i) {
        const CacheBox& box = tree_.boxes[i];
        if (box.primitive_count == 0 || (!options_.surround && !facts_[i].in_view)) return;
        if (refresh_older(i, max_error_)) {
            shown_.push_back(i);
            return;
        }
        for (Index child = 0; child < box.child_count; ++child) update(box.first_child + child);
    }

    /// Figure 5.
    void draw(Index i) {
        const CacheBox& box = tree_.boxes[i];
        if (box.primitive_count == 0 || !facts_[i].in_view) return;
        if (error_[i] <= max_error_) {
            plan_.draws.push_back({i, true});
            plan_.after.last_used[i] = view_.frame;
            plan_.max_error_rad = std::max(plan_.max_error_rad, error_[i]);
            if (plan_.uses[i] != BoxUse::unused) return;
            plan_.uses[i] = BoxUse::reused;
            ++plan_.counts.reused;
        } else if (box.child_count == 0) {
            plan_.draws.push_back({i, false});
            plan_.uses[i] = BoxUse::not_replaceable;
            ++plan_.counts.not_replaceable;
        } else {
            back_to_front(tree_, box.first_child, box.child_count, view_.eye, [&](Index child) { draw(child); });
        }
    }

    /// Refreshes a picture whose error is over max_error. Whether the box then has one with at most that.
    bool refresh_older(Index i, double max_error) {
        if (!(error_[i] <= max_error) && (!facts_[i].fresh || !refresh(i, max_error))) return false;
        plan_.after.last_used[i] = view_.frame;
        return true;
    }

    bool refresh(Index i, double max_error) {
        const CacheBox& box = tree_.boxes[i];
        const bool by_the_letter = options_.rules == ValidityRules::published;
        const bool may_combine = by_the_letter || box.height % (options_.max_generation + 1) != 0;
        if (box.child_count == 0 || !may_combine) return store(i, false, 0, 0);
        const double child_error = by_the_letter ? max_error : max_child_error(i, max_error);
        double error = 0;
        std::uint32_t generation = 0;
        for (Index child = box.first_child; child < box.first_child + box.child_count; ++child) {
            if (tree_.boxes[child].primitive_count == 0) continue;
            if (!refresh_older(child, child_error)) return store(i, false, 0, 0);
            error = std::max(error, error_[child]);
            generation = std::max(generation, plan_.after.pictures[child].generation + 1);
        }
        if (by_the_letter) return store(i, true, 0, generation);
        const double inherited = inherited_error(error, facts_[i].fresh->tangent);
        if (generation > options_.max_generation || !(inherited <= max_error)) return store(i, false, 0, 0);
        return store(i, true, inherited, generation);
    }

    /// Gives the box its new picture, if there is room for it.
    bool store(Index i, bool from_children, double inherited, std::uint32_t generation) {
        Picture& held = plan_.after.pictures[i];
        if (!make_room(i, bytes_of(facts_[i].fresh->texels))) return false;
        plan_.after.bytes = plan_.after.bytes - bytes_of(held.texels) + bytes_of(facts_[i].fresh->texels);
        held = *facts_[i].fresh;
        held.inherited = inherited;
        held.generation = generation;
        error_[i] = inherited;
        plan_.refreshes.push_back({i, from_children, ahead_});
        plan_.uses[i] = from_children ? BoxUse::combined : BoxUse::fresh;
        ++(from_children ? plan_.counts.combined : plan_.counts.fresh);
        if (ahead_) ++plan_.counts.ahead;
        return true;
    }

    /// Drops pictures that neither this frame nor the last one used, the longest unused first.
    bool make_room(Index i, std::uint64_t bytes) {
        CacheState& after = plan_.after;
        const std::uint64_t kept = bytes_of(after.pictures[i].texels);
        while (after.bytes - kept + bytes > options_.max_bytes) {
            Index oldest = none;
            for (Index other = 0; other < after.pictures.size(); ++other) {
                const bool in_use = other == i || after.last_used[other] + 1 >= view_.frame;
                if (after.pictures[other].texels == 0 || in_use) continue;
                if (oldest == none || after.last_used[other] < after.last_used[oldest]) oldest = other;
            }
            if (oldest == none) return false;
            after.bytes -= bytes_of(after.pictures[oldest].texels);
            after.pictures[oldest] = {};
            error_[oldest] = unusable;
            plan_.dropped.push_back(oldest);
        }
        return true;
    }

    /// Children grow old unseen below a valid picture, and all are needed at once when it fails. So some are refreshed before.
    void refresh_ahead() {
        ahead_ = true;
        std::vector<AgingChild> aging;
        for (const Index i : shown_) add_aging_children(i, aging);
        std::sort(aging.begin(), aging.end(), [](const AgingChild& a, const AgingChild& b) {
            return std::tie(a.frames_left, a.box) < std::tie(b.frames_left, b.box);
        });
        for (const AgingChild& child : aging) {
            if (plan_.counts.ahead >= options_.upkeep_refreshes) break;
            if (facts_[child.box].fresh && refresh(child.box, child.max_error)) plan_.after.last_used[child.box] = view_.frame;
        }
        ahead_ = false;
    }

    void add_aging_children(Index i, std::vector<AgingChild>& aging) const {
        const CacheBox& box = tree_.boxes[i];
        if (box.height % (options_.max_generation + 1) == 0 || !facts_[i].fresh) return;
        const double a_frame = error_a_frame(i), frames_left = (max_error_ - error_[i]) / a_frame;
        if (!(a_frame > 0 && frames_left <= options_.upkeep_frames)) return;
        const double max_error = max_child_error(i, max_error_);
        for (Index child = box.first_child; child < box.first_child + box.child_count; ++child) {
            if (tree_.boxes[child].primitive_count == 0) continue;
            const double then = error_[child] + frames_left * error_a_frame(child);
            if (!(then <= max_error)) aging.push_back({frames_left, max_error, child});
        }
    }

    /// What the children may have, so that the picture of their pictures inherits at most child_share of its own limit.
    [[nodiscard]] double max_child_error(Index i, double max_error) const {
        const double tangent = facts_[i].fresh->tangent;
        return max_error * options_.child_share / (1 + tangent * tangent);
    }

    /// By how much the error of a picture has grown in a frame, in the mean since it was made.
    [[nodiscard]] double error_a_frame(Index i) const {
        const Picture& picture = plan_.after.pictures[i];
        const std::uint32_t age = view_.frame - picture.frame;
        return age == 0 || picture.texels == 0 ? 0 : (error_[i] - picture.inherited) / age;
    }

    const BoxTree& tree_;
    const CacheView& view_;
    const CacheOptions& options_;
    std::span<const BoxFacts> facts_;
    double max_error_;
    CachePlan plan_;
    std::vector<double> error_;
    std::vector<Index> shown_;  ///< boxes whose pictures stand for all below them
    bool ahead_ = false;
};

}  // namespace

Result<void> check_cache_options(const CacheOptions& options) {
    const auto is_side = [](std::uint32_t texels) { return std::has_single_bit(texels) && texels <= max_side_texels; };
    if (!is_side(options.min_texels) || !is_side(options.max_texels))
        return Error{"cache",
                     fmt::format("Pictures cannot have sides of {} to {} texels", options.min_texels, options.max_texels),
                     fmt::format("Choose powers of two from 1 to {}", max_side_texels), ErrorKind::misuse};
    if (options.max_generation > max_levels)
        return Error{"cache", fmt::format("{} generations of pictures are out of range", options.max_generation),
                     fmt::format("Choose 0 to {}", max_levels), ErrorKind::misuse};
    if (!(options.child_share > 0 && options.child_share <= 1))
        return Error{"cache", fmt::format("Children cannot have the share {} of an error", options.child_share),
                     "Choose a share above 0, up to 1", ErrorKind::misuse};
    return {};
}

CacheState empty_state(const BoxTree& tree) {
    CacheState state;
    state.pictures.resize(tree.boxes.size());
    state.last_used.resize(tree.boxes.size(), 0);
    return state;
}

void evaluate_boxes(const BoxTree& tree, const CacheView& view, const CacheOptions& options, const CacheState& state, Index first,
                    Index last, std::span<BoxFacts> facts) {
    for (Index i = first; i < last; ++i) {
        const CacheBox& box = tree.boxes[i];
        BoxFacts& of = facts[i];
        of = {};
        of.eye = view.eye;
        of.frame = view.frame;
        of.error_rad = unusable;
        if (box.primitive_count == 0) continue;
        of.in_view = view.frustum == nullptr || model::visible(*view.frustum, box.box);
        of.fresh = fresh_picture(box.box, view, options);
        if (state.pictures[i].texels > 0) of.error_rad = error_of(state.pictures[i], view, options.rules);
    }
}

CachePlan plan_frame(const BoxTree& tree, const CacheView& view, const CacheOptions& options, const CacheState& state,
                     std::span<const BoxFacts> facts) {
    CHECK(check_cache_options(options), "The options of the cache are in range");
    CHECK(facts.size() == tree.boxes.size(), "Every box has its facts");
    for (const BoxFacts& of : facts) {
        const bool no_number = std::isnan(view.eye.x + view.eye.y + view.eye.z);
        CHECK(of.frame == view.frame && (of.eye == view.eye || no_number), "Facts are of the frame and the eye of the plan");
    }
    return FramePlanner(tree, view, options, state, facts).run();
}

CachePlan plan_frame(const BoxTree& tree, const CacheView& view, const CacheOptions& options, const CacheState& state) {
    std::vector<BoxFacts> facts(tree.boxes.size());
    evaluate_boxes(tree, view, options, state, 0, static_cast<Index>(tree.boxes.size()), facts);
    return plan_frame(tree, view, options, state, facts);
}

}  // namespace surefoot::cache
