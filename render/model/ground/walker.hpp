// The walker's body: slides along walls, climbs steps and slopes, falls to floors, and stops at edges and under ceilings.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/model/ground.hpp"
#include "render/model/ground/capsule.hpp"
#include "render/model/ground/near_blocks.hpp"
#include "render/model/ground/near_moving.hpp"
#include "rt/base/named.hpp"

namespace surefoot::model {

/// Size and abilities of the walker. A step or a radius that does not fit the height is made smaller.
struct Body {
    double eye_m = 1.7;                 ///< eye above the floor; the head ends crown_m higher
    double radius_m = 0.3;              ///< of the capsule
    double step_m = 0.25;               ///< highest step that is climbed
    double slope_rad = 0.785398163397;  ///< steepest floor that is climbed
    double edge_m = 1.0;                ///< a drop of this much or more stops the walker; infinite: none does
};
constexpr double crown_m = 0.1;

/// What keeps the walker from going on.
enum class Barrier : std::uint8_t { clear, wall, slope, ceiling, edge, inside, stuck };
inline constexpr std::array barriers = {
    Named{"clear", "nothing is in the way"},
    Named{"wall", "a wall is in the way"},
    Named{"slope", "the floor is too steep"},
    Named{"ceiling", "the ceiling is too low"},
    Named{"edge", "the floor ends at a drop"},
    Named{"inside", "the place is inside something solid; the nearest free place is being looked for"},
    Named{"stuck", "no direction is free; the walker goes back to where it was free"},
};

/// One walker on a ground. The constructor allocates; nothing else does, nor locks, nor reads a clock. One thread uses it.
///
/// The body is a capsule from step_m above the feet to crown_m above the eye: what is lower is stepped on. The feet stand on the
/// highest floor under a disc of half the radius. The same calls give the same bits.
class Walker {  // NOLINT(clang-analyzer-optin.performance.Padding): members stand by what they are for
public:
    /// The ground must outlive this, and be valid and indexed.
    Walker(const Ground& ground, const Body& body) : Walker(ground, nullptr, body) {}
    /// Besides its ground, what moves in the model carries, pushes and stops the walker. The same holds for the model.
    Walker(const Model& model, const Body& body);

    /// The time until which things move in the next step, seconds since the walk began. Up to max_pause_s back it stands still.
    /// Where it goes back or on by more, the eye counts as placed: what moved meanwhile neither carried nor pushed it.
    void set_time(double time_s) { time_s_ = holds_still_ ? 0 : time_s; }
    static constexpr double max_pause_s = 0.25;
    /// From now on all stands as at time 0, and nothing is said to carry. Before the first step.
    void hold_still() { holds_still_ = true; }

    /// What things that move did with the eye in the last step, and may do in the next ones.
    struct Ride {
        dvec3 way{0.0};                          ///< in the last step
        double turn_rad = 0;                     ///< to the left, with the floor under the feet
        double max_m_s = 0, max_turn_rad_s = 0;  ///< of anything that may come within 2 m; 0: nothing does
    };
    [[nodiscard]] const Ride& ride() const { return ride_; }

    /// One step of the eye, from where it is towards `wanted`; only the level part of the way counts. Call it at every tick, also
    /// when the hand rests: falls go on. An eye that somebody placed elsewhere stays as it is until the hand moves.
    dvec3 walk(const dvec3& from, const dvec3& wanted, double dt_s) noexcept;

    /// Where the eye comes to by going on level, and how far walls are from there.
    struct Foreseen {
        dvec3 eye{0.0};
        double clear_m = 0;  ///< walls further off than wide_m from eye + way need not count
    };
    /// For any body that stands there: `way` is what its velocity makes of some time. Walls stop it as they stop steps. The walk
    /// stays as it is. This takes longer than a step: use a walker of its own, on a thread that has the time.
    [[nodiscard]] Foreseen foresee(const dvec3& feet, const dvec3& eye, const dvec3& way, double wide_m) noexcept;

    /// The walk was stopped: it goes on from rest.
    void halt() noexcept {
        fall_m_s = eye_m_s = 0;
        barrier_ = Barrier::clear;
    }

    /// Gets ready what meets the box: what is asked about it next is answered the same, and sooner. For many questions about a
    /// place without a step there.
    void gather(const Box& box) noexcept {
        near_.gather(box);
        close_known_ = false;
    }
    /// Whether nothing overlaps a body with its feet there by over a centimetre.
    [[nodiscard]] bool is_free(const dvec3& feet) const;
    /// The highest floor under the foot's disc at (x, z) between these heights; minus infinity: none.
    [[nodiscard]] double floor_at(const dvec3& at, double top, double bottom) const { return footing(at, top, bottom).floor; }
    /// Whether a free body gets straight from one place to another: at the height of the higher one it touches nothing on the
    /// way.
    [[nodiscard]] bool passes(const dvec3& from, const dvec3& to) const;

    /// Why the last step ended short of what was wanted.
    [[nodiscard]] Barrier barrier() const { return barrier_; }
    /// How often a stuck walker went back, and how often one that began inside something was put beside it.
    [[nodiscard]] std::uint64_t returns() const { return returns_; }
    [[nodiscard]] std::uint64_t freed() const { return freed_; }
    /// How often something that moves left no room: the walker was put beside it, or it passed through the walker.
    [[nodiscard]] std::uint64_t put_aside() const { return put_aside_; }
    [[nodiscard]] std::uint64_t passed_through() const { return passed_through_; }
    /// How many things pass through the walker now.
    [[nodiscard]] std::size_t passing() const { return moving_.passing().size(); }
    /// Whether the hand has moved since the eye was placed; before, the feet are nowhere.
    [[nodiscard]] bool stands() const { return awake_ && !searching_; }
    [[nodiscard]] const dvec3& eye() const { return eye_; }
    [[nodiscard]] const dvec3& feet() const { return feet_; }
    /// Whether something carries the feet; else the walker falls, or glides where there is no floor at all.
    [[nodiscard]] bool supported() const { return supported_; }
    /// The part of a body with its feet there that walls stop.
    [[nodiscard]] Capsule capsule_at(const dvec3& feet) const;

private:
    /// One of near_, and what is known of its distance.
    struct Close {
        const GroundTriangle* triangle;
        NearBlocks::Known* known;
    };
    /// Heights of the highest floor and of the highest surface of any slope under the feet; minus infinity: none. And what moves
    /// of them.
    struct Footing {
        double floor, any;
        std::uint32_t floor_thing = no_thing, any_thing = no_thing;
        /// What carries the feet that stand on it.
        [[nodiscard]] std::uint32_t thing() const { return any > floor ? any_thing : floor_thing; }
    };
    /// Where a move would end.
    struct Attempt {
        dvec3 feet{0.0};
        bool supported = false, steep = false;
        Barrier barrier = Barrier::clear;
        std::uint32_t thing = no_thing;
    };

    Walker(const Ground& ground, const Model* model, const Body& body);
    template <class Use>
    void for_still(const Box& box, const Use& use) const;
    template <class Use>
    void for_near(const Box& box, const Use& use) const;
    void find_close(const dvec3& feet);
    [[nodiscard]] Contact sweep(const dvec3& feet, const dvec3& move, double skin = 0);
    [[nodiscard]] Footing footing(const dvec3& at, double top, double bottom) const;
    [[nodiscard]] bool is_inside_solid(const dvec3& feet, double sight_m) const;
    [[nodiscard]] dvec3 slide(const dvec3& feet, dvec3 move, Barrier& barrier);
    [[nodiscard]] Attempt attempt(const dvec3& move);
    void travel(const dvec3& move);
    void fall(double dt_s);
    [[nodiscard]] bool roll_off(const Contact& contact, double dt_s);
    void raise_eye(double sank_m_s, double dt_s);
    void stand_up();
    [[nodiscard]] bool push_out();
    void gather_moving_there(const dvec3& feet);
    [[nodiscard]] bool is_left_free(const dvec3& feet);
    [[nodiscard]] bool sees(const dvec3& to) const;
    void look_for_a_free_place();
    void stand_at(const dvec3& feet);
    void free_at(const dvec3& feet);
    [[nodiscard]] bool trial_gets_on();
    void watch(const dvec3& move, double dt_s);
    [[nodiscard]] const dvec3& newest_free_place() const;
    void remember_free_place();
    void go_back();
    void go_back_on();
    void go_back_to_start(bool was_elsewhere);
    void prepare_near(const dvec3& feet, double reach_m);
    void gather_moving(const dvec3& feet, double from_s, double to_s);
    void move_along(double from_s, double to_s);
    void move_by(const dvec3& way);
    void carry(double seconds);
    [[nodiscard]] bool push_aside(double max_m, double seconds);
    [[nodiscard]] bool has_floor_at(const dvec3& feet) const;
    void keep_on_floor(bool was_pushed);
    [[nodiscard]] bool sweeps(const NearMoving::Thing& thing, double seconds) const;
    void evade(double seconds);
    [[nodiscard]] bool step_beside(double turn);
    [[nodiscard]] bool reaches(const dvec3& to) const;
    [[nodiscard]] bool is_in(const dvec3& feet, const NearMoving::Thing& thing) const;
    [[nodiscard]] bool is_in_any(const dvec3& feet) const;
    [[nodiscard]] bool is_clear_of(const NearMoving::Thing& thing) const;
    void end_passing();

    const Ground& ground_;
    Body body_;
    NearBlocks near_;
    std::vector<Close> close_;  ///< those up to close_m apart
    dvec3 close_to_{0.0};
    bool close_known_ = false, close_complete_ = false;  ///< incomplete: there are too many
    std::array<dvec3, 9> foot_{};                        ///< points of the foot's disc

    dvec3 eye_{0.0}, feet_{0.0};
    bool known_ = false;  ///< eye_ is where the walker left it
    bool awake_ = false;  ///< the hand has moved since the eye was placed
    bool supported_ = false;
    bool steep_ = false;  ///< what supports is too steep to climb
    double fall_m_s = 0, eye_m_s = 0;
    Barrier barrier_ = Barrier::clear;
    std::uint32_t search_at_ = 0;  ///< candidates for a free place that were looked at
    bool searching_ = false;
    dvec3 tried_from_{0.0};    ///< where the walker was when it last got on
    double pushed_s_ = 0;      ///< for how long it has not
    double stuck_s_ = 0;       ///< for how long it is still said that it was stuck
    std::uint32_t trial_ = 0;  ///< steps of trials that were done or left out
    dvec3 trial_from_{0.0};    ///< where the trial of a direction began
    Attempt trial_at_;         ///< where it has come to
    dvec3 stood_up_at_{0.0};
    static constexpr std::uint32_t max_free_places = 128;
    std::array<dvec3, max_free_places> free_places_{};  ///< a ring: each half a metre from where it began and from the last one
    std::uint32_t free_first_ = 0, free_count_ = 0;
    std::uint32_t gone_back_ = 0;   ///< by how many places the last return went back, at least 1; 0: none, or to the start
    std::uint32_t new_places_ = 0;  ///< remembered since then
    bool going_back_ = false;       ///< stuck, and its places are being looked at
    bool start_is_free_ = false;    ///< stood_up_at_ is a place to go back to
    std::uint64_t returns_ = 0, freed_ = 0;

    NearMoving moving_;
    bool holds_still_ = false;
    double time_s_ = 0, stood_s_ = 0;   ///< of the next step, and of the last one
    std::uint32_t support_ = no_thing;  ///< what moves under the feet; of supported feet
    Ride ride_;
    std::uint64_t put_aside_ = 0, passed_through_ = 0;
};

}  // namespace surefoot::model
