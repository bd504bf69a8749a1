// The shared state, and its one line.
#include "systemd/daemon/service_state.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "rt/clock/grid.hpp"
#include "systemd/daemon/configuration.hpp"

namespace surefoot::daemon {

std::string status_text(const Facts& f) {
    std::string text;
    switch (f.phase) {
        case Phase::opening:
            text = fmt::format("opening {}", f.model);
            break;
        case Phase::walking:
            text = fmt::format("walking {} ({}): {} frames, {} missed, {} slots skipped", f.model, f.in_short, f.frames, f.misses,
                               f.skipped);
            break;
        case Phase::stopping:
            text = "stopping";
            break;
    }
    if (f.stalled) text = "NO FRAMES COME; " + text;
    if (!f.refused.empty()) text += "; the configuration was refused, the last good one is in use: " + f.refused;
    for (std::size_t i = 0; i < f.lacks.size(); ++i) text += (i == 0 ? "; not fully real-time: " : ", ") + f.lacks[i];
    if (f.uncalibrated) text += "; uncalibrated";
    return text;
}

void ServiceState::open(const config::Settings& settings) {
    if (leaving.load()) return;
    const MutexLock lock(mutex_);
    facts_.phase = Phase::opening;
    facts_.model = std::filesystem::path(settings.model_file).filename().string();
    facts_.in_short = in_short(settings);
    facts_.period_ns = rt::period_of_rate_ns(settings.rate_hz) ? *rt::period_of_rate_ns(settings.rate_hz) : 0;
    facts_.open_limit_ns = static_cast<std::int64_t>(settings.open_limit_s * 1e9);
    facts_.lacks.clear();
    facts_.uncalibrated = false;
    walk_frames_.store(0);
    stalled.store(false);
}

void ServiceState::walking(std::int64_t period_ns, std::int64_t first_due_ns) {
    const MutexLock lock(mutex_);
    facts_.phase = Phase::walking;
    facts_.period_ns = period_ns;
    facts_.first_due_ns = first_due_ns;
}

void ServiceState::count(const rt::FrameRecord& record) {
    misses_.fetch_add(record.missed ? 1 : 0);
    skipped_.fetch_add(record.skipped_before);
    frames_.fetch_add(1);
    walk_frames_.fetch_add(1);
}

bool ServiceState::lacks(const rt::Lack& lack) {
    const MutexLock lock(mutex_);
    facts_.lacks.push_back(lack.what);
    return logged_.insert(lack.what).second;
}

bool ServiceState::uncalibrated(const std::string& why) {
    const MutexLock lock(mutex_);
    facts_.uncalibrated = true;
    return logged_.insert(why).second;
}

std::optional<config::Configuration> ServiceState::take_next() {
    const MutexLock lock(mutex_);
    return std::exchange(next_, std::nullopt);
}

void ServiceState::put_next(config::Configuration configuration) {
    const MutexLock lock(mutex_);
    next_ = std::move(configuration);
}

void ServiceState::stopping() {
    const MutexLock lock(mutex_);
    facts_.phase = Phase::stopping;
}

void ServiceState::refuse(const std::string& why) {
    const MutexLock lock(mutex_);
    facts_.refused = why;
}

Facts ServiceState::facts() const {
    const MutexLock lock(mutex_);
    Facts facts = facts_;
    facts.frames = frames_.load();
    facts.walk_frames = walk_frames_.load();
    facts.misses = misses_.load();
    facts.skipped = skipped_.load();
    facts.stalled = stalled.load();
    return facts;
}

}  // namespace surefoot::daemon
