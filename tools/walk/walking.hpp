// Joins the walker's body to the input's steps: which devices walk, and what to do where the walker was put elsewhere.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "input/motion/motion.hpp"
#include "render/model/ground/walker.hpp"
#include "rt/base/modes.hpp"
#include "rt/base/path.hpp"

namespace surefoot::walk {

/// Largest acceleration that a walker's eye gets up or down; it falls with that of gravity.
constexpr double walker_rise_m_s2 = 9.81;

/// The walker of a session. All members but the constructor and those for any thread belong to the thread of the
/// input's steps.
class Walking {
public:
    /// Without a ground, or with `fly`, everybody flies. The ground must outlive this. `moving`: the ground's model; what moves
    /// in it carries and stops the walker too. It must outlive this as well.
    Walking(const model::Ground& ground, const model::Body& body, rt::WalkingMode mode, const model::Model* moving = nullptr);

    /// From now on all stands as at time 0. Before the first step.
    void hold_still() {
        if (walker_) walker_->hold_still();
    }
    /// What the next step asks. `flies`: the device that steers moves freely in space. `time_s`: since the walk began, of the
    /// step's end.
    [[nodiscard]] input::Ground ground(bool flies, double time_s = 0);
    /// How often the walker was put elsewhere: out of something solid, beside what moved, or back to where it was free.
    [[nodiscard]] std::uint32_t jumps() const;
    [[nodiscard]] bool walks() const { return walks_; }
    [[nodiscard]] bool walked() const { return walked_; }  ///< at any time
    /// After a step: whether somebody walks, and a step led to the sample's eye. Else he flies, is carried, or a button put the
    /// eye elsewhere.
    [[nodiscard]] bool stands(const input::NavigationSample& sample) const {
        return walks_ && walker_->stands() && sample.pose.position == walker_->eye();
    }
    /// After each step: lets other threads read what stops the walker.
    void publish() {
        shown_.store(walks_ ? walker_->barrier() : model::Barrier::clear, std::memory_order_relaxed);
        shown_walks_.store(walks_, std::memory_order_relaxed);
        shown_freed_.store(walker_ && walker_->freed() > 0, std::memory_order_relaxed);
    }
    /// For any thread, as of the last publish().
    [[nodiscard]] model::Barrier shown_barrier() const { return shown_.load(std::memory_order_relaxed); }
    [[nodiscard]] bool shown_walks() const { return shown_walks_.load(std::memory_order_relaxed); }
    [[nodiscard]] bool shown_freed() const { return shown_freed_.load(std::memory_order_relaxed); }  ///< at any time
    /// Null where nobody walks.
    [[nodiscard]] const model::Walker* walker() const { return walker_ ? &*walker_ : nullptr; }

private:
    std::optional<model::Walker> walker_;
    rt::WalkingMode mode_;
    bool walks_ = false, walked_ = false;
    std::atomic<model::Barrier> shown_{model::Barrier::clear};
    std::atomic<bool> shown_walks_{false}, shown_freed_{false};
};

/// What a visitor should know of a path: where it leads through walls, and which viewpoints stand in one. Empty: nowhere.
std::string path_warning(const model::Ground& ground, const Path& path);

}  // namespace surefoot::walk
