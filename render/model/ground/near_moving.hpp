// The things that move near a body, and their triangles as they stand at a time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/model/ground/near.hpp"
#include "render/model/motion.hpp"

namespace surefoot::model {

constexpr std::uint32_t no_thing = 0xffffffffU;

/// The constructor allocates; nothing else does, nor locks, nor reads a clock. One thread uses it. What is found does not depend
/// on what was gathered before, nor does its order. Of more than max_things near a body the last ones are not there.
class NearMoving {
public:
    static constexpr std::size_t max_things = 64, max_triangles = 4096, max_passing = 16;

    /// One that moves: an instance of the model's MovingGround, from one time to another.
    struct Thing {
        std::uint32_t instance = 0;
        RigidPose before, now;
        Box at_rest;                           ///< of all of it; world
        double speed_m_s = 0, turn_rad_s = 0;  ///< never faster, jumps left out
        bool moved = false;                    ///< the poses differ
        bool leaps = false;                  ///< it got further than its speed allows, or is too fast to carry or push: it jumped
        bool absent = false;                 ///< it passes through the body, or is left out for a while
        std::uint32_t first = 0, count = 0;  ///< of the gathered triangles

        /// Where what it carries is now.
        [[nodiscard]] dvec3 carried(const dvec3& point) const { return now(before.back(point)); }
        /// By how much the heading of what it carries turned, rad.
        [[nodiscard]] double turned_rad() const;
    };

    /// Null, or a model without moving ground: nothing moves. The model must outlive this, and be valid and indexed.
    explicit NearMoving(const Model* model);

    /// Whether anything moves anywhere.
    [[nodiscard]] bool exist() const { return model_ != nullptr; }
    /// Makes ready what comes within `reach_m` of the box at any time, as it stands at `to_s`. Triangles are gathered that meet
    /// the box then.
    void gather(const Box& box, double reach_m, double from_s, double to_s) noexcept;
    [[nodiscard]] std::span<Thing> things() { return things_; }
    [[nodiscard]] std::span<const Thing> things() const { return things_; }
    /// Null: it is not near.
    [[nodiscard]] Thing* find(std::uint32_t instance);

    /// use(const GroundTriangle&, std::uint32_t instance) for the triangles that meet the box, as of the last gather(), of what
    /// is not absent.
    template <class Use>
    void for_triangles(const Box& box, const Use& use) const {
        if (!exist()) return;
        const bool ready = complete_ && box_.contains(box);
        for (const Thing& thing : things_)
            if (!thing.absent) ready ? for_ready(thing, box, use) : for_all(thing, box, use);
    }
    /// The same of one thing, absent or not.
    template <class Use>
    void for_triangles_of(const Thing& thing, const Box& box, const Use& use) const {
        complete_&& box_.contains(box) ? for_ready(thing, box, use) : for_all(thing, box, use);
    }

    /// Of a capsule's move, which stays within the box.
    [[nodiscard]] Contact first_contact(const Capsule& capsule, const dvec3& move, const Box& box) const;

    /// From now on it passes through the body, until it blocks again.
    void let_pass(Thing& thing);
    void end_passing(std::uint32_t instance);
    [[nodiscard]] std::span<const std::uint32_t> passing() const { return {passing_.data(), passing_count_}; }

private:
    /// A gathered triangle.
    struct Near {
        GroundTriangle triangle;
        Box box;
    };
    template <class Use>
    void for_ready(const Thing& thing, const Box& box, const Use& use) const {
        for (std::uint32_t i = thing.first; i < thing.first + thing.count; ++i)
            if (ground_tree::overlap(box, triangles_[i].box)) use(triangles_[i].triangle, thing.instance);
    }
    /// From the tree.
    template <class Use>
    void for_all(const Thing& thing, const Box& box, const Use& use) const {
        const Ground& rest = rest_ground();
        const GroundInstance& instance = rest.instances[thing.instance];
        const dmat3 linear(instance.linear);
        const bool mirrored = glm::determinant(linear) < 0;  // fronts stay fronts
        ground_tree::in_mesh(
            rest, rest.meshes[instance.mesh], ground_tree::in_frame_of(instance, box_at_rest(thing.now, box)),
            [&](const dvec3& p) { return thing.now(instance.origin + linear * p); },
            [&](const GroundTriangle& t) {
                if (!ground_tree::overlap(box, ground_tree::box_of(t))) return;
                use(mirrored ? GroundTriangle{t.a, t.c, t.b} : t, thing.instance);
            });
    }
    [[nodiscard]] const Ground& rest_ground() const;
    static Box box_at_rest(const RigidPose& pose, const Box& box);
    void add(std::uint32_t instance, double from_s, double to_s);

    const Model* model_;
    std::vector<Thing> things_;
    std::vector<Near> triangles_;
    Box box_;
    bool complete_ = false;  ///< the triangles are not too many
    std::array<std::uint32_t, max_passing> passing_{};
    std::size_t passing_count_ = 0;
};

}  // namespace surefoot::model
