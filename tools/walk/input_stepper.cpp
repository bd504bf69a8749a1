// The step.
#include "tools/walk/input_stepper.hpp"

#include <algorithm>

#include "rt/base/check.hpp"

namespace surefoot::walk {

InputStepper::InputStepper(input::ReportSource& source, input::Steering& steering, TourController& tour_controller,
                           Walking& walking, rt::TripleBuffer<SteeredSample>& samples, JumpBuffer& jump_poses,
                           input::StopKeeper* keeper)
    : source_(source),
      steering_(steering),
      tour_controller_(tour_controller),
      walking_(walking),
      samples_(samples),
      jump_poses_(jump_poses),
      keeper_(keeper) {
    steering_.place(tour_controller_.start());
}

void InputStepper::begin(std::int64_t start_ns) {
    steering_.steers.plays();  // before the input thread is there
    tick_at_ns_ = start_ns;
    set_zero(start_ns);
    source_.begin(steering_, start_ns);
    input::NavigationSample first;
    first.pose = tour_controller_.start();
    publish(first, start_ns);
}

std::int64_t InputStepper::next_ns() const { return std::min(source_.next_ns(), tick_at_ns_); }

void InputStepper::step(std::int64_t now_ns) {
    steering_.steers.plays();
    const input::Lines lines = source_.drain(steering_, now_ns);
    const bool led = tour_controller_.touring() || tour_controller_.paused();  // no walls for one who is carried or stands still
    const std::uint32_t jumps = walking_.jumps();
    const double walked_s = static_cast<double>(now_ns - zero_ns_.load(std::memory_order_relaxed)) * 1e-9;
    input::NavigationSample sample =
        steering_.tick(lines, now_ns, led ? input::Ground{} : walking_.ground(steering_.flies(), walked_s));
    if (walking_.jumps() != jumps) {  // put elsewhere: the way there is no motion
        steering_.place(sample.pose, true);
        sample.velocity_m_s = sample.angular_rad_s = sample.carried_m_s = dvec3(0.0);
        sample.carried_rad_s = 0;
        sample.zoom_rate = 0;
    }
    if (keeper_ != nullptr) keeper_->set(steering_.safety().latched);
    tour_controller_.follow(sample, steering_, now_ns);
    walking_.publish();
    publish(sample, now_ns);
    tick_at_ns_ = now_ns + input_tick_ns;
}

void InputStepper::advance_to(std::int64_t now_ns) {
    for (std::int64_t due = next_ns(); due <= now_ns; due = next_ns()) {
        step(due);
        CHECK(next_ns() > due, "a step reads all that was due");
    }
}

void InputStepper::publish(const input::NavigationSample& sample, std::int64_t now_ns) {
    const std::uint32_t jumps = tour_controller_.jumps() + walking_.jumps();
    if (jumps != jumps_reported_) {
        jumps_reported_ = jumps;
        PoseSample& place = jump_poses_.back();
        place.pose = sample.pose;
        place.dt_s = static_cast<double>(input_tick_ns) * 1e-9;
        place.before = input::carried(sample, -place.dt_s);  // a tour goes on from there at once
        place.time_ns = now_ns;
        jump_poses_.publish();
    }
    SteeredSample& out = samples_.back();
    out.nav = sample;
    out.time_ns = now_ns;
    out.reports = source_.log().count();
    out.jumps = jumps;
    out.touring = tour_controller_.touring();
    out.on_schedule = tour_controller_.on_schedule();
    shown_used_.store(!out.touring || out.reports > 0, std::memory_order_relaxed);
    out.walking = walking_.walks();
    out.on_foot = walking_.stands(sample);
    if (out.on_foot) out.feet = walking_.walker()->feet();
    out.barrier = out.walking ? walking_.walker()->barrier() : model::Barrier::clear;
    samples_.publish();
}

}  // namespace surefoot::walk
