// GPIO lines through libgpiod 1.6 (Debian 12; GPIO uAPI v1: 16 edges a line, the newest dropped, not numbered).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <gpiod.h>

#include "input/gpio/lines.hpp"
#include "rt/base/text.hpp"

namespace surefoot::input {

namespace {

constexpr std::size_t kernel_queue = 16;

struct Chip {
    std::string name;
    gpiod_chip* chip = nullptr;
    gpiod_line_bulk bulk{};
    std::vector<std::uint32_t> index;  ///< into the requests, a line of the bulk
};

Error system_error(std::string place, std::string_view what, int code, std::string remedy = "Check that the chip is plugged in") {
    return {std::move(place), fmt::format("{}: {}", what, std::strerror(code)), std::move(remedy), ErrorKind::no_device};
}

int flags_of(const LineRequest& request) {
    int flags = request.active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
    if (request.bias == Bias::pull_up) flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    if (request.bias == Bias::pull_down) flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
    if (request.bias == Bias::off) flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
    return flags;
}

gpiod_line* find(gpiod_chip* chip, const std::string& line) {
    if (gpiod_line* named = gpiod_chip_find_line(chip, line.c_str())) return named;
    const auto offset = number_in<unsigned>(line);
    return offset ? gpiod_chip_get_line(chip, *offset) : nullptr;
}

class LinesV1 final : public GpioLines {
public:
    ~LinesV1() override {
        for (Chip& chip : chips_)
            if (chip.chip != nullptr) gpiod_chip_close(chip.chip);  // releases its lines
    }

    Result<void> request(std::span<const LineRequest> requests, std::string_view consumer) {
        for (std::uint32_t i = 0; i < requests.size(); ++i)
            if (auto added = add(requests[i], i); !added) return added;
        for (Chip& chip : chips_)
            if (auto got = request_chip(chip, requests, std::string(consumer)); !got) return got;
        waiting_.reserve(polled_.size() * kernel_queue);
        return {};
    }

    [[nodiscard]] std::span<const pollfd> polled() const override { return polled_; }

    Result<std::size_t> read(std::span<LineEdge> edges) override {
        if (given_ == waiting_.size())
            if (auto filled = fill(); !filled) return filled.error();
        const std::size_t count = std::min(edges.size(), waiting_.size() - given_);
        std::copy_n(waiting_.begin() + static_cast<std::ptrdiff_t>(given_), count, edges.begin());
        given_ += count;
        return count;
    }

    Result<void> levels(std::span<bool> active) override {
        for (Chip& chip : chips_) {
            std::array<int, GPIOD_LINE_BULK_MAX_LINES> values{};
            if (gpiod_line_get_value_bulk(&chip.bulk, values.data()) != 0)
                return system_error(chip.name, "The lines cannot be read", errno);
            for (std::size_t i = 0; i < chip.index.size(); ++i) active[chip.index[i]] = values[i] != 0;
        }
        return {};
    }

private:
    Result<void> add(const LineRequest& request, std::uint32_t index) {
        auto at = std::find_if(chips_.begin(), chips_.end(), [&](const Chip& c) { return c.name == request.chip; });
        if (at == chips_.end()) {
            chips_.push_back({request.chip, gpiod_chip_open_lookup(request.chip.c_str()), {}, {}});
            at = chips_.end() - 1;
            gpiod_line_bulk_init(&at->bulk);
        }
        if (at->chip == nullptr)
            return system_error(request.chip, "The chip cannot be opened", errno,
                                "See `gpiodetect`, and add the user to the group gpio");
        gpiod_line* line = find(at->chip, request.line);
        const std::string place = fmt::format("{} line '{}'", request.chip, request.line);
        if (line == nullptr) return Error{place, "There is no such line", "See `gpioinfo`", ErrorKind::not_found};
        if (gpiod_line_is_used(line)) return busy(place, line);
        if (at->index.size() == GPIOD_LINE_BULK_MAX_LINES)
            return Error{place, "The line is the 65th of its chip; at most 64 are allowed", "Remove a line of this chip",
                         ErrorKind::out_of_limits};
        gpiod_line_bulk_add(&at->bulk, line);
        at->index.push_back(index);
        return {};
    }

    static Error busy(const std::string& place, gpiod_line* line) {
        const char* user = gpiod_line_consumer(line);
        return {place, fmt::format("The line is in use by '{}'", user != nullptr ? user : "the kernel"),
                "Stop that program, or use another line", ErrorKind::no_device};
    }

    /// Flags hold for a whole request in libgpiod 1, so lines that differ in them are requested one by one.
    Result<void> request_chip(Chip& chip, std::span<const LineRequest> requests, const std::string& consumer) {
        const int first = flags_of(requests[chip.index.front()]);
        const bool same =
            std::all_of(chip.index.begin(), chip.index.end(), [&](std::uint32_t i) { return flags_of(requests[i]) == first; });
        const auto failed = [&](std::size_t i, int code) -> Error {
            gpiod_line* line = chip.bulk.lines[i];
            const std::string place = fmt::format("{} line '{}'", chip.name, requests[chip.index[i]].line);
            if (code == EBUSY && gpiod_line_update(line) == 0 && gpiod_line_is_used(line)) return busy(place, line);
            return system_error(place, "The line cannot be requested", code);
        };
        if (same) {
            if (gpiod_line_request_bulk_both_edges_events_flags(&chip.bulk, consumer.c_str(), first) != 0)
                return failed(0, errno);
        } else {
            for (std::size_t i = 0; i < chip.index.size(); ++i)
                if (gpiod_line_request_both_edges_events_flags(chip.bulk.lines[i], consumer.c_str(),
                                                               flags_of(requests[chip.index[i]])) != 0)
                    return failed(i, errno);
        }
        for (std::size_t i = 0; i < chip.index.size(); ++i) {
            polled_.push_back({gpiod_line_event_get_fd(chip.bulk.lines[i]), POLLIN, 0});
            index_.push_back(chip.index[i]);
        }
        return {};
    }

    /// Each line has its own queue; an encoder needs the order across lines, which only the stamps tell.
    Result<void> fill() {
        waiting_.clear();
        given_ = 0;
        const int ready = ::poll(polled_.data(), polled_.size(), 0);
        if (ready < 0 && errno != EINTR) return system_error("gpio", "The lines cannot be polled", errno);
        if (ready <= 0) return {};
        for (std::size_t i = 0; i < polled_.size(); ++i) {
            if ((polled_[i].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0)
                return Error{"gpio", "The chip is gone", "Plug it in again", ErrorKind::no_device};
            if ((polled_[i].revents & POLLIN) == 0) continue;
            std::array<gpiod_line_event, kernel_queue> events{};
            const int count = gpiod_line_event_read_fd_multiple(polled_[i].fd, events.data(), events.size());
            if (count < 0) return system_error("gpio", "The edges cannot be read", errno);
            for (int k = 0; k < count; ++k) {
                const auto& event = events[static_cast<std::size_t>(k)];
                waiting_.push_back({index_[i], event.event_type == GPIOD_LINE_EVENT_RISING_EDGE,
                                    event.ts.tv_sec * 1'000'000'000LL + event.ts.tv_nsec, 0});
            }
        }
        std::sort(waiting_.begin(), waiting_.end(), [](const LineEdge& a, const LineEdge& b) {
            return a.stamp_ns < b.stamp_ns || (a.stamp_ns == b.stamp_ns && a.line < b.line);
        });
        return {};
    }

    std::vector<Chip> chips_;
    std::vector<pollfd> polled_;
    std::vector<std::uint32_t> index_;  ///< of a polled descriptor into the requests
    std::vector<LineEdge> waiting_;
    std::size_t given_ = 0;
};

}  // namespace

Result<std::unique_ptr<GpioLines>> open_lines(std::span<const LineRequest> requests, std::string_view consumer, void*) {
    auto lines = std::make_unique<LinesV1>();
    if (auto requested = lines->request(requests, consumer); !requested) return requested.error();
    return std::unique_ptr<GpioLines>(std::move(lines));
}

std::string gpio_back_end() { return fmt::format("libgpiod {}", gpiod_version_string()); }

}  // namespace surefoot::input
