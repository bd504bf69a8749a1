// The loop of the window's thread.
#include "tools/walk/window_thread.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cstdint>

#include "rt/base/statistics.hpp"

namespace surefoot::walk {

namespace {

constexpr int idle_ms = 100, retry_ms = 2;
constexpr std::size_t max_shown = 1U << 16U;  // a quarter of an hour at 60 Hz

}  // namespace

WindowThread::WindowThread(std::shared_ptr<gl::WindowEvents> window, WindowThreadOptions options, rt::Placement placement)
    : window_(std::move(window)),
      options_(std::move(options)),
      placement_(std::move(placement)),
      refused_before_(gl::x11::refusals().count),
      wake_fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    if (window_->present_times() != nullptr) shown_ms_.reserve(max_shown);
    thread_ = std::thread([this] { run(); });
    placed_.wait();
}

WindowThread::~WindowThread() {
    stop();
    if (wake_fd_ >= 0) ::close(wake_fd_);
}

void WindowThread::stop() {
    stopping_.store(true);
    constexpr std::uint64_t one = 1;
    if (wake_fd_ >= 0) (void)!::write(wake_fd_, &one, sizeof one);
    if (thread_.joinable()) thread_.join();
}

void WindowThread::run() {
    if (auto placed = rt::place_thread(0, placement_); !placed) misplaced_ = placed.error();
    placed_.count_down();
    const gl::WindowSize size = window_->size();
    input::WindowReports reports(static_cast<std::int32_t>(size.width), static_cast<std::int32_t>(size.height),
                                 options_.stop_keys);
    while (!stopping_.load(std::memory_order_relaxed)) {
        take_events(reports);
        take_shown();
        const bool waits = options_.feed && !options_.feed->flush();
        const int times_fd = window_->present_times() != nullptr ? window_->present_times()->fd() : -1;
        std::array<pollfd, 3> watched{{{window_->fd(), POLLIN, 0}, {wake_fd_, POLLIN, 0}, {times_fd, POLLIN, 0}}};
        (void)::poll(watched.data(), watched.size(), waits ? retry_ms : idle_ms);
    }
    if (reports.captured()) window_->release();
}

void WindowThread::take_shown() {
    if (window_->present_times() == nullptr) return;
    for (gl::PresentedPicture picture; window_->present_times()->next(picture);) {
        if (picture.shown_ns == 0) {
            ++replaced_;
            continue;
        }
        const double took_ms = static_cast<double>(picture.shown_ns - picture.handed_ns) * 1e-6;
        if (shown_ms_.size() < max_shown)
            shown_ms_.push_back(took_ms);
        else
            shown_ms_[shown_ % max_shown] = took_ms;
        ++shown_;
    }
}

report::DisplaySummary WindowThread::displayed() const {
    report::DisplaySummary summary;
    summary.pictures = shown_;
    summary.replaced = replaced_;
    if (!shown_ms_.empty()) summary.after_ms = quantiles(shown_ms_);
    return summary;
}

std::string WindowThread::refused() const {
    const gl::x11::Refusals now = gl::x11::refusals();
    if (now.count == refused_before_) return {};
    return fmt::format("The X server refused requests of the window: {}. The last: {}.", now.count - refused_before_, now.text());
}

void WindowThread::take_events(input::WindowReports& reports) {
    for (WindowEvent event; window_->next(event);) {
        const input::WindowReports::Step step = reports.take(event);
        if (step.reports && options_.feed) options_.feed->push(reports.report());
        obey(step.command, reports);
    }
}

void WindowThread::obey(input::WindowCommand command, input::WindowReports& reports) {
    using Command = input::WindowCommand;
    switch (command) {
        case Command::none:
            return;
        case Command::leave:
            if (options_.may_leave) left_.store(true);
            return;
        case Command::capture:
            if (options_.feed && window_->capture())
                window_->centre_pointer();
            else
                reports.capture_refused();
            return;
        case Command::release:
            return window_->release();
        case Command::centre:
            return window_->centre_pointer();
        case Command::fullscreen:
            if (options_.feed || options_.may_leave) window_->toggle_fullscreen();
            return;
    }
}

}  // namespace surefoot::walk
