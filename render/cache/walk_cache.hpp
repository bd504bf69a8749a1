// The pictures of a walk: which boxes have one, what they cover, which new ones pay, and where they lie.
// Belongs to the frame thread. After it is made nothing allocates. It reads poses and costs, and no clock and no graphics API.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/cache/prospect.hpp"
#include "render/cache/scene_boxes.hpp"
#include "render/cache/slots.hpp"
#include "render/model/covered_boxes.hpp"
#include "render/model/view.hpp"

namespace surefoot::cache {

/// How a walk's cache works.
struct WalkCacheOptions {
    std::uint32_t layers = 0;           ///< of 256 x 256 texels; 0: no pictures
    bool surround = false;              ///< boxes all round the eye are kept and planned, not only those in view
    double pays = 1.2;                  ///< a picture must save so many times its price while it lives
    std::uint32_t max_offers = 8;       ///< in a frame
    std::uint32_t prospects = 48;       ///< worked out in a frame, beside those of offers
    std::uint32_t kept_frames = 16;     ///< a picture that a set may rely on is not dropped
    double renewed_frames = 5;          ///< before a picture fails, a new one is offered
    std::uint32_t quiet_plans = 30;     ///< one after another in which nothing pays: then the cache is idle
    std::uint32_t idle_every = 8;       ///< frames from one plan of an idle cache to the next
    float picture_us = 1;               ///< to draw a picture, beside its pixels
    float picture_ns_per_pixel = 5.6F;  ///< of the box's faces
    float capture_us = 20;              ///< to make a picture, beside what it shows
    float capture_ns_per_texel = 1.0F;  ///< the same, by its texels: to clear it
    float loss = 0.003F;                ///< of the value of what a picture shows: it is sampled twice
};

/// A box's picture.
struct HeldPicture {
    Picture picture;  ///< Picture::texels 0: it has none
    Box box;          ///< grown, as it was captured
    double grown_m = 0;
    Slot slot;
    std::uint64_t until = 0;  ///< the last frame that shows it, since it is forgotten or goes for another; 0: neither
    [[nodiscard]] bool any() const { return slot.texels > 0; }
};

/// A picture that may be made.
struct CacheOffer {
    Index box = 0;
    Prospect prospect;
    float price_us = 0;  ///< to make it
    float gain_us = 0;   ///< what it saves while it lives, and what it shows more at the frame's rate, without its price
};

/// What a plan depends on, besides the cache.
struct PlanView {
    EyeCourse course;
    ViewPixels pixels;
    const model::Frustum* frustum = nullptr;  ///< of all eyes that the plan is for; with a surround: what comes first
    double pixel_rad = 1e-3;                  ///< in the middle of the view
    double view_px = 0;                       ///< of the whole view
    double max_price_us = 0;                  ///< of a picture
    double picture_factor = 1;                ///< on what draw_us() predicts
    double us_per_value = 0;                  ///< what the frame would pay for a weighted pixel; 0: time is all that counts
    bool ample = false;                       ///< the frame shows all it can without pictures: none is worth anything
    bool refills = false;                     ///< there was a jump a short time ago: an idle cache plans too
    model::FrameCombine combine;
};

/// What a frame shows of a covered scene.
struct CacheDraws {
    std::vector<Index> boxes;     ///< their pictures, back to front
    std::vector<Index> unserved;  ///< covered leaves of the tree whose pictures are not valid: their nodes must be drawn
    double value = 0;             ///< what they show, by full detail of their contents as it was when they were drawn last
    double saves_us = 0;          ///< what their contents took then, as forms
};

/// The state between frames.
class WalkCache {
public:
    WalkCache() = default;
    /// blended: boxes of what is drawn after the pictures, at all times. A picture has no depth that hides them, so that none may
    /// stand before one of them.
    WalkCache(SceneBoxes boxes, const WalkCacheOptions& options, std::vector<Box> blended = {});
    [[nodiscard]] bool any() const { return !held_.empty(); }
    [[nodiscard]] const SceneBoxes& boxes() const { return boxes_; }
    [[nodiscard]] const HeldPicture& held(Index box) const { return held_[box]; }
    [[nodiscard]] std::uint64_t bytes() const { return slots_.bytes(); }

    /// Forgets all pictures: the light is another, or what is drawn. No further set is told of them. Sets that rely on them still
    /// show them, for at most three frames.
    void forget();

    /// No picture's error times the importance of what it shows may exceed this. 0: a pixel is all that limits it.
    void set_promise(double error_rad) { promise_rad_ = error_rad; }

    /// Begins a frame: what the pictures cover for all eyes within a distance of one. Complete, boxes without contents included;
    /// no bit where no picture is valid.
    const model::CoverBits& cover(const ViewPixels& pixels, double radius_m);

    /// What the last cut's items cost and show, node by node, and what full detail would show: so much could be saved, and shown
    /// more. `covered`: of the set of that cut; what lies there is not drawn, so its last cost stays. With a surround, so does
    /// that of what is not wholly in the view of the last plan(). Where no cost is known, the cost table's price stands for it.
    void begin_costs(const model::CoverBits& covered);
    void add_cost(model::Index node, float us, float value, float full_value);
    void end_costs();

    /// Pictures that pay before they fail or are forgotten, the best first. Valid until the next call. Where nothing has paid for
    /// quiet_plans, it looks in one of idle_every calls, and offers nothing in the others.
    std::span<const CacheOffer> plan(const PlanView& view);
    /// The last plan() did not look. Nor does it need the costs of this cut.
    [[nodiscard]] bool is_idle() const { return is_idle_; }
    [[nodiscard]] std::span<const CacheOffer> offers() const { return offers_; }  ///< of the last plan()
    /// The box gets the picture: drop what no set relies on, where there is no room. False: there is none. Until captured(), its
    /// slot holds the picture of before, or nothing. drop_pending() brings that one back.
    bool take(const CacheOffer& offer);
    /// Boxes whose new pictures are to be captured; they are of the light that comes, whenever that is set.
    [[nodiscard]] bool is_pending(Index box) const;
    void captured(Index box);
    void drop_pending();
    void drop(Index box);
    /// Drops all pictures: their slots hold something else.
    void clear();

    /// What a frame draws for a covered set: the largest valid pictures in view, back to front. No eye but one: radius 0. Valid
    /// until the next call.
    const CacheDraws& draws(const model::CoverBits& set, const ViewPixels& pixels, const model::Frustum& frustum);
    [[nodiscard]] std::span<const Index> drawn() const { return draws_.boxes; }        ///< of the last draws()
    [[nodiscard]] std::span<const Index> unserved() const { return draws_.unserved; }  ///< the same
    /// Predicted, to draw a box's picture.
    [[nodiscard]] float draw_us(Index box, const dvec3& eye, double pixel_rad, double view_px) const;

private:
    static constexpr std::uint64_t relied_frames = 3;  ///< after which no set relies on what was covered
    static constexpr float share_out_of_view = 0.25F;  ///< of a saving: so large a part of all directions is seen at once
    static constexpr std::size_t max_refused = 8;
    static constexpr std::uint32_t cells_a_side = layer_texels / min_slot_texels;

    /// What a new picture of a box would bring, as it was worked out a few frames ago.
    struct Fact {
        float net_us = 0;    ///< a frame; 0: no picture, or none that pays
        float worth_us = 0;  ///< of the picture in a frame, from which this was worked out
    };
    /// A sphere as an eye sees it.
    struct Cone {
        dvec3 direction{0.0};
        double cos = -1, sin = 0;  ///< of half its angle; from inside: all directions
        double far_m = 0;
    };
    [[nodiscard]] static Cone cone_of(const Box& box, const dvec3& eye);
    /// A box that may get a picture.
    struct Candidate {
        Index box = 0;
        float net_us = 0;
        bool in_view = true;
    };
    /// A picture for which there was no room.
    struct Refused {
        Index box = 0;
        std::uint32_t texels = 0;  ///< of a side
        float worth_us = 0;
        std::uint64_t until = 0;  ///< frame after which its place is free; 0: it has none yet
    };
    /// A new picture that is not captured yet.
    struct Pending {
        Index box = 0;
        HeldPicture before;  ///< which its slot still holds; none where it has another slot
    };
    [[nodiscard]] float draw_us(Index box, const PlanView& view) const;
    [[nodiscard]] float full_worth_us(Index box, const PlanView& view) const;
    /// What is within a promise counts as right.
    [[nodiscard]] float loss() const { return promise_rad_ > 0 ? 0.0F : options_.loss; }
    [[nodiscard]] bool work_out(Index box, const PlanView& view, CacheOffer& offer) const;
    [[nodiscard]] bool pays_beside_held(CacheOffer& offer, const PlanView& view) const;
    void find_in_view();
    void refresh_facts(const PlanView& view);
    bool work_out_fact(Index box, const PlanView& view);
    void work_out_facts(const PlanView& view, Index& next, std::uint32_t& left, bool in_view);
    [[nodiscard]] float own_net_us(Index box, const PlanView& view);
    [[nodiscard]] Index common_box(Index a, Index b) const;
    void choose(Index box);
    void offer_candidates(const PlanView& view);
    void draw_below(Index box, const ViewPixels& pixels, const model::Frustum& frustum);
    [[nodiscard]] bool serves_on(Index box, const PlanView& view) const;
    [[nodiscard]] bool find_room(Index box, std::uint32_t texels);
    [[nodiscard]] double frames_to_forget() const;
    [[nodiscard]] double allowed_rad(Index box, const Box& seen, const ViewPixels& pixels) const;
    void look_from(const dvec3& eye);
    [[nodiscard]] bool before_blended(const Box& box) const;
    [[nodiscard]] static float us_of(const model::FrameCombine& combine, const model::ItemCost& cost);
    [[nodiscard]] bool measured(Index box);
    void estimate(Index box, const PlanView& view);
    [[nodiscard]] double allowed_for_new_rad(Index box, const PlanView& view) const;
    void forget_refused();
    void refuse(Index box, std::uint32_t texels);
    void make_room_by_worth();
    [[nodiscard]] bool takes_place_of_waiting(const Candidate& candidate, std::uint32_t texels) const;
    void sum_up_worth(std::uint32_t side);
    [[nodiscard]] Slot place_for(const Refused& refused) const;
    [[nodiscard]] bool shown_by_larger(Index box) const;
    [[nodiscard]] static std::size_t size_of(std::uint32_t texels) { return texels <= 64 ? 0 : texels <= 128 ? 1 : 2; }
    [[nodiscard]] static std::size_t cell_of(std::uint32_t layer, std::uint32_t row, std::uint32_t column) {
        return (std::size_t{layer} * cells_a_side + row) * cells_a_side + column;
    }

    SceneBoxes boxes_;
    WalkCacheOptions options_;
    Slots slots_;
    std::vector<HeldPicture> held_;            ///< by box
    std::vector<std::uint64_t> last_covered_;  ///< by box: frame in which a set was told of it
    std::uint64_t frame_ = 0;                  ///< counts cover()
    std::uint64_t forgot_frame_ = 0;           ///< of the last forget()
    double forget_frames_ = 0;                 ///< usually between two of them; 0: none was
    model::CoverBits covered_;
    /// Full detail of a box, and what the cut's forms lacked of it.
    struct Value {
        float full = 0, missing = 0;
    };
    std::vector<Value> shown_value_, value_;  ///< by box: of the last cut; of the last cut that drew it
    model::CoverBits set_;                    ///< of the last cut
    std::vector<float> across_us_;            ///< by box: of what lies across its children, to go only with all of them
    std::vector<float> cost_us_, saving_us_;  ///< by box: of the last cut; what a picture would save in a frame
    std::vector<Fact> facts_;                 ///< by box
    std::vector<float> own_us_, best_us_;     ///< by box: net of a picture; of the best boxes at and below
    Index next_fact_ = 0;
    double promise_rad_ = 0;
    std::vector<Box> blended_;
    std::vector<Cone> cones_;  ///< of blended_, from an eye
    dvec3 cones_eye_{0.0};
    std::vector<Candidate> candidates_;
    std::vector<CacheOffer> offers_;
    std::vector<Pending> pending_;
    std::vector<Index> victims_;               ///< of take(): what would go for room
    Slots trial_;                              ///< of take()
    std::uint32_t no_room_for_ = 0;            ///< texels of a side, since plan(); 0: nothing failed
    std::vector<bool> serves_;                 ///< by box: of the last plan()
    std::vector<bool> in_view_;                ///< the same
    std::vector<std::uint8_t> planes_across_;  ///< the same: of in_view.hpp
    std::uint32_t quiet_plans_ = 0;            ///< one after another in which nothing paid
    std::uint32_t idle_calls_ = 0;             ///< of plan(), since it looked
    bool is_idle_ = false;
    std::vector<bool> pays_;    ///< by box: its picture saves more than it takes, by the last plan() that looked at it
    std::vector<bool> relies_;  ///< by box: a set needs something below it
    std::vector<Refused> refused_;
    std::uint64_t tight_until_ = 0;                  ///< the frame until which offers must find room
    std::array<std::uint64_t, 3> no_place_until_{};  ///< by size, the same: nothing was worth less than what was refused
    std::vector<std::uint64_t> out_until_;  ///< by box: it went for another; no picture of it is offered before this frame
    std::vector<float> cell_worth_us_;      ///< by square of 64 texels

    // With a surround alone.
    model::Frustum seen_;                    ///< of the last plan()
    dvec3 seen_from_{0.0};                   ///< its eye
    bool planned_ = false;                   ///< since the last end_costs()
    std::vector<dvec3> known_from_;          ///< by box: the eye for which its cost was measured; NaN: it was not
    std::vector<bool> seen_now_;             ///< by box: measured by the last cut
    std::uint64_t view_first_until_ = 0;     ///< the frame until which boxes out of view have a share alone
    Index next_beside_ = 0;                  ///< as next_fact_, of boxes out of view
    double known_us_ = 0, priced_us_ = 0;    ///< of boxes in view, since facts began anew: by the cut, by the cost table
    double known_value_ = 0, known_px_ = 0;  ///< the same boxes: what they show, and the pixels of their faces
    float spent_share_ = 1;                  ///< of the cost table's price, that cuts spend
    float value_a_px_ = 0.5F;                ///< of the pixels of a box's faces
    CacheDraws draws_;
};

}  // namespace surefoot::cache
