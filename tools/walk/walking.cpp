// The adapter of the walker.
#include "tools/walk/walking.hpp"

namespace surefoot::walk {

Walking::Walking(const model::Ground& ground, const model::Body& body, rt::WalkingMode mode) : mode_(mode) {
    if (mode != rt::WalkingMode::fly && !ground.empty()) walker_.emplace(ground, body);
}

input::Ground Walking::ground(bool flies) {
    walks_ = walker_ && !(flies && mode_ == rt::WalkingMode::automatic);
    if (!walks_) return {};
    const auto query = [](void* walker, const dvec3& from, const dvec3& wanted, double dt_s) noexcept {
        return static_cast<model::Walker*>(walker)->walk(from, wanted, dt_s);
    };
    const auto halt = [](void* context) noexcept { static_cast<model::Walker*>(context)->halt(); };
    return {query, &*walker_, walker_rise_m_s2, halt};
}

std::uint32_t Walking::jumps() const { return walker_ ? static_cast<std::uint32_t>(walker_->returns() + walker_->freed()) : 0; }

}  // namespace surefoot::walk
