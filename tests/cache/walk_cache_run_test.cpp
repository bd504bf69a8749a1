// Long walks of a cache without a device: its memory is exact at all times, what a set relies on is shown, and nothing is left
// behind. Eyes walk, turn and jump, pictures are dropped before they are captured, and the light changes.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "render/cache/walk_cache.hpp"
#include "rt/base/random.hpp"
#include "tests/cache/slot_board.hpp"

namespace surefoot::cache {
namespace {

constexpr double side_m = 120;
constexpr model::Viewport viewport{320, 240};
constexpr double off_course_m = 0.03;

/// 512 leaves in a cube; every 64th is flat, and every 64th has no size at all.
model::Model cube_of_leaves() {
    model::Model model;
    constexpr model::Index leaves = 512;
    model.nodes.resize(leaves + 1);
    model.nodes[0].child_count = leaves;
    model.nodes[0].first_child = 1;
    Random random(11);
    for (model::Index n = 1; n <= leaves; ++n) {
        const model::Index i = n - 1;
        const dvec3 at = dvec3(i % 8, i / 8 % 8, i / 64) * (side_m / 8);
        const dvec3 low = at + any_in(random, dvec3(0), dvec3(4));
        model.nodes[n].parent = 0;
        model.nodes[n].box = {low, low + (i % 64 == 1 ? dvec3(6, 6, 0) : i % 64 == 2 ? dvec3(0) : dvec3(6))};
        model.nodes[0].box.grow(model.nodes[n].box);
    }
    return model;
}

/// A walk of a cache, and what is known of it from outside.
class CacheRun {
public:
    CacheRun(std::uint64_t seed, bool surround, std::uint32_t layers, std::vector<Box> blended = {})
        : random_(seed),
          layers_(layers),
          board_(layers),
          cache_(boxes(), {.layers = layers, .surround = surround}, std::move(blended)) {
        slots_.resize(cache_.boxes().size());
    }
    [[nodiscard]] std::uint64_t refreshes() const { return refreshes_; }
    [[nodiscard]] std::uint64_t hash() const { return hash_; }
    [[nodiscard]] std::uint64_t pictures_drawn() const { return pictures_drawn_; }

    /// The eye stays, and all that is bought is captured.
    bool stand() {
        step_m_ = dvec3(0);
        turn_rad_ = 0;
        return frame(true);
    }

    /// False: something is not as it should be.
    bool frame(bool stands = false) {
        if (!stands) move();
        const Pose pose = this->pose();
        const model::Frustum seen = model::make_frustum(pose, viewport, 1e4, 0.3, 0.2);
        sets_[frames_ % sets_.size()] = cache_.cover(view_pixels(pose, viewport, 0.2), stands ? off_course_m : 0.2);
        if (!in_step()) return false;
        if (!stands && random_.below(300) == 0) cache_.forget();
        PlanView view;
        view.course = {eye_, step_m_, off_course_m, 90};
        view.pixels = view_pixels(pose, viewport, 0.3);
        view.frustum = &seen;
        view.pixel_rad = model::pixel_angle(pose, viewport);
        view.view_px = 1.0 * viewport.width * viewport.height;
        view.max_price_us = 1e9;
        for (const CacheOffer& offer : cache_.plan(view)) {
            if ((!stands && random_.below(16) == 0) || !cache_.take(offer)) continue;
            if (!in_step()) return false;
            if (!stands && random_.below(16) == 0) continue;  // it waits, and is dropped
            cache_.captured(offer.box);
            ++refreshes_;
            hash_ = hash_ * 1099511628211U + offer.box * 8U + offer.prospect.picture.texels / 64;
        }
        if (!shows_all_of(sets_[random_.below(3)], pose)) return false;
        cache_.drop_pending();
        add_costs(seen);
        ++frames_;
        return in_step();
    }

    /// Pictures that no set is told of, though they were captured here.
    [[nodiscard]] std::uint64_t idle() {
        const model::CoverBits& covered = cache_.cover(view_pixels(pose(), viewport, 0.2), off_course_m);
        std::uint64_t count = 0;
        for (Index i = 0; i < slots_.size(); ++i) count += cache_.held(i).any() && !covered[i] ? 1 : 0;
        return count;
    }
    void light_changes() { cache_.forget(); }
    void drop_all() {
        for (Index i = 0; i < slots_.size(); ++i) cache_.drop(i);
    }
    /// All goes, and every layer is whole again.
    bool ends_empty() {
        drop_all();
        if (!in_step() || cache_.bytes() != 0) return false;
        CacheOffer offer;
        offer.prospect.picture.texels = max_slot_texels;
        cache_.plan({});
        for (offer.box = 0; offer.box < layers_; ++offer.box)
            if (!cache_.take(offer)) return false;
        offer.prospect.picture.texels = min_slot_texels;
        return !cache_.take(offer) && in_step();
    }

private:
    static SceneBoxes boxes() {
        auto made = SceneBoxes::make(cube_of_leaves(), {});
        EXPECT_TRUE(made.ok());
        return made.ok() ? std::move(*made) : SceneBoxes{};
    }
    [[nodiscard]] Pose pose() const {
        Pose pose;
        pose.position = eye_;
        pose.orientation = glm::angleAxis(heading_rad_, dvec3(0, 1, 0));
        return pose;
    }
    void move() {
        const std::uint32_t kind = random_.below(24);
        if (kind == 0) eye_ = any_in(random_, dvec3(-side_m), dvec3(2 * side_m));
        if (kind == 1) eye_ = cache_.boxes().tree().boxes[random_.below(cache_.boxes().size())].box.centre();
        if (kind == 2) eye_ = cache_.boxes().tree().boxes[random_.below(cache_.boxes().size())].box.min;
        if (kind < 4) step_m_ = any_in(random_, dvec3(-0.2), dvec3(0.2));
        if (kind == 4) turn_rad_ = random_.range(-0.1, 0.1);
        heading_rad_ += turn_rad_;
        eye_ += step_m_;
    }
    /// What is in view costs something, but for what the set left out.
    void add_costs(const model::Frustum& seen) {
        const model::CoverBits& set = sets_[frames_ % sets_.size()];
        cache_.begin_costs(set);
        static const model::Model model = cube_of_leaves();
        for (model::Index n = 1; n < model.nodes.size(); ++n)
            if (!cache_.boxes().covered(n, set) && model::visible(seen, model.nodes[n].box)) cache_.add_cost(n, 60, 1, 1);
        cache_.end_costs();
    }
    /// Slots overlap nowhere, and bytes are those of what is held.
    bool in_step() {
        changed_.clear();
        for (Index i = 0; i < slots_.size(); ++i)
            if (!(slots_[i] == cache_.held(i).slot)) changed_.push_back(i);
        for (const Index i : changed_)
            if (slots_[i].texels > 0 && !board_.set(slots_[i], false)) return false;
        for (const Index i : changed_)
            if ((slots_[i] = cache_.held(i).slot).texels > 0 && !board_.set(slots_[i], true)) return false;
        std::uint64_t bytes = 0;
        for (const Slot& slot : slots_) bytes += 4U * slot.texels * slot.texels;
        return bytes == cache_.bytes() && (frames_ % 64 != 0 || bytes == board_.bytes());
    }
    /// A set's leaves in view are each below one picture, or are to be drawn. Pictures are valid.
    bool shows_all_of(const model::CoverBits& set, const Pose& pose) {
        const model::Frustum seen = model::make_frustum(pose, viewport, 1e4);
        const ViewPixels pixels = view_pixels(pose, viewport);
        const CacheDraws& draws = cache_.draws(set, pixels, seen);
        shown_.assign(slots_.size(), 0);
        in_view_.assign(slots_.size(), false);
        for (const Index box : draws.boxes) {
            const HeldPicture& held = cache_.held(box);
            if (!held.any() || !valid_around(held.picture, eye_, 0, pixels.smallest_rad(held.box))) return false;
            ++shown_[box];
        }
        pictures_drawn_ += draws.boxes.size();
        for (const Index box : draws.unserved) ++shown_[box];
        const std::vector<CacheBox>& boxes = cache_.boxes().tree().boxes;
        for (Index i = 1; i < boxes.size(); ++i) shown_[i] += shown_[boxes[i].parent];
        // A large box is tested across edges too. So a small one in it may count as visible that is not.
        for (Index i = 0; i < boxes.size(); ++i)
            in_view_[i] = (i == 0 || in_view_[boxes[i].parent]) && model::visible(seen, cache_.boxes().filled(i));
        for (Index i = 0; i < boxes.size(); ++i) {
            if (boxes[i].child_count > 0 || !set[i] || !cache_.boxes().has_contents(i)) continue;
            const int expected = in_view_[i] ? 1 : 0;
            if (shown_[i] < expected || shown_[i] > 1) return false;
        }
        return true;
    }

    Random random_;
    std::uint32_t layers_;
    SlotBoard board_;
    WalkCache cache_;
    std::vector<Slot> slots_;  ///< by box, as last seen
    std::vector<Index> changed_;
    std::vector<int> shown_;
    std::vector<bool> in_view_;
    std::array<model::CoverBits, 3> sets_;
    dvec3 eye_{-20, 60, 60}, step_m_{0.05, 0, 0};
    double heading_rad_ = -1.5, turn_rad_ = 0;
    std::uint64_t frames_ = 0, refreshes_ = 0, hash_ = 0, pictures_drawn_ = 0;
};

void expect_exact(std::uint64_t refreshes, bool surround, std::uint32_t layers) {
    CacheRun run(surround ? 3 : 4, surround, layers);
    for (std::uint64_t frame = 0; run.refreshes() < refreshes; ++frame) {
        ASSERT_TRUE(run.frame()) << frame;
        ASSERT_LT(frame, refreshes + 10'000) << "hardly any picture is made";
    }
    EXPECT_GT(run.pictures_drawn(), refreshes / 2);
    EXPECT_TRUE(run.ends_empty());
}

TEST(WalkCacheRun, ThousandsOfRefreshesLeaveNothingBehind) {
    for (const bool surround : {false, true})
        for (const std::uint32_t layers : {2U, 24U}) expect_exact(2'000, surround, layers);
}

TEST(WalkCacheRunAtNight, AMillionRefreshesLeaveNothingBehind) {
    for (const bool surround : {false, true}) expect_exact(500'000, surround, 24);
}

/// In a full cache too, and where pictures that are worth little hold the places.
TEST(WalkCacheRun, WhereTheEyeStaysNoPictureIsMadeTwice) {
    for (const bool surround : {false, true}) {
        for (const std::uint32_t layers : {2U, 6U, 24U}) {
            CacheRun run(7, surround, layers);
            for (int place = 0; place < 4; ++place) {
                for (int i = 0; i < 40; ++i) ASSERT_TRUE(run.frame()) << i;
                for (int i = 0; i < 150; ++i) ASSERT_TRUE(run.stand()) << i;
                const std::uint64_t made = run.refreshes();
                for (int i = 0; i < 50; ++i) ASSERT_TRUE(run.stand()) << i;
                EXPECT_EQ(run.refreshes(), made) << surround << " " << layers << " " << place;
            }
            EXPECT_GT(run.refreshes(), 25 * layers) << "more than find room";
        }
    }
}

/// None may stand before what is transparent. So none is made that would: its box is grown by a pixel.
TEST(WalkCacheRun, BesideWhatIsTransparentNoPictureIsMadeInVain) {
    Random random(3);
    std::vector<Box> blended;
    for (int i = 0; i < 60; ++i) {
        const dvec3 at = any_in(random, dvec3(2 * side_m, -side_m, -side_m), dvec3(3 * side_m, 2 * side_m, 2 * side_m));
        blended.push_back({at, at + dvec3(0.5)});
    }
    CacheRun run(7, false, 24, blended);
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(run.stand()) << i;
    EXPECT_GT(run.refreshes(), 10U);
    EXPECT_EQ(run.idle(), 0U);
}

/// What was forgotten once after a while is not expected to be forgotten again just then.
TEST(WalkCacheRun, OneChangeOfTheLightStopsNoPicturesLater) {
    CacheRun run(7, false, 24);
    for (int i = 0; i < 200; ++i) ASSERT_TRUE(run.stand()) << i;
    run.light_changes();
    for (int i = 0; i < 198; ++i) ASSERT_TRUE(run.stand()) << i;
    for (int after = 0; after < 8; ++after) {  // 198 to 398 frames after that
        const std::uint64_t made = run.refreshes();
        run.drop_all();
        for (int i = 0; i < 25; ++i) ASSERT_TRUE(run.stand()) << i;
        EXPECT_GT(run.refreshes(), made) << after;
    }
}

TEST(WalkCacheRun, TheSameWalkMakesTheSamePictures) {
    CacheRun one(5, true, 8), two(5, true, 8), other(6, true, 8);
    for (int i = 0; i < 300; ++i) ASSERT_TRUE(one.frame() && two.frame() && other.frame()) << i;
    EXPECT_GT(one.refreshes(), 100U);
    EXPECT_EQ(one.hash(), two.hash());
    EXPECT_NE(one.hash(), other.hash());
}

}  // namespace
}  // namespace surefoot::cache
