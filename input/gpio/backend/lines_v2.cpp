// GPIO lines through libgpiod 2 (Debian 13; GPIO uAPI v2: one numbered queue a request, the oldest edge dropped).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include <gpiod.h>

#include "input/gpio/lines.hpp"
#include "rt/base/text.hpp"

namespace surefoot::input {

namespace {

constexpr std::size_t edges_at_once = 64, queue = 1024;

template <auto Free>
struct Freed {
    template <class T>
    void operator()(T* object) const {
        Free(object);
    }
};
using ChipPtr = std::unique_ptr<gpiod_chip, Freed<gpiod_chip_close>>;
using RequestPtr = std::unique_ptr<gpiod_line_request, Freed<gpiod_line_request_release>>;
using BufferPtr = std::unique_ptr<gpiod_edge_event_buffer, Freed<gpiod_edge_event_buffer_free>>;
using SettingsPtr = std::unique_ptr<gpiod_line_settings, Freed<gpiod_line_settings_free>>;
using LinesPtr = std::unique_ptr<gpiod_line_config, Freed<gpiod_line_config_free>>;
using ConfigPtr = std::unique_ptr<gpiod_request_config, Freed<gpiod_request_config_free>>;
using InfoPtr = std::unique_ptr<gpiod_line_info, Freed<gpiod_line_info_free>>;
using ChipInfoPtr = std::unique_ptr<gpiod_chip_info, Freed<gpiod_chip_info_free>>;

struct Chip {
    std::string name;
    ChipPtr chip;
    RequestPtr request;
    std::vector<std::uint32_t> index;  ///< into the requests
    std::vector<unsigned> offsets;     ///< parallel to index
};

Error system_error(std::string place, std::string_view what, int code, std::string remedy = "Check that the chip is plugged in") {
    return {std::move(place), fmt::format("{}: {}", what, std::strerror(code)), std::move(remedy), ErrorKind::no_device};
}

/// By name, path or label, as libgpiod 1 looks chips up.
ChipPtr open_chip(const std::string& name) {
    if (name.find('/') != std::string::npos) return ChipPtr(gpiod_chip_open(name.c_str()));
    if (ChipPtr chip{gpiod_chip_open(("/dev/" + name).c_str())}) return chip;
    const int code = errno;
    std::error_code problem;
    for (const auto& entry : std::filesystem::directory_iterator("/dev", problem)) {
        const auto file = entry.path().string();
        if (!entry.path().filename().string().starts_with("gpiochip") || !gpiod_is_gpiochip_device(file.c_str())) continue;
        ChipPtr chip{gpiod_chip_open(file.c_str())};
        const ChipInfoPtr info{chip ? gpiod_chip_get_info(chip.get()) : nullptr};
        if (info && name == gpiod_chip_info_get_label(info.get())) return chip;
    }
    errno = code;
    return nullptr;
}

SettingsPtr settings_of(const LineRequest& request) {
    SettingsPtr settings{gpiod_line_settings_new()};
    if (!settings) return settings;
    gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT);
    gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH);
    gpiod_line_settings_set_event_clock(settings.get(), GPIOD_LINE_CLOCK_MONOTONIC);
    gpiod_line_settings_set_active_low(settings.get(), request.active_low);
    constexpr std::array biases = {GPIOD_LINE_BIAS_AS_IS, GPIOD_LINE_BIAS_PULL_UP, GPIOD_LINE_BIAS_PULL_DOWN,
                                   GPIOD_LINE_BIAS_DISABLED};
    gpiod_line_settings_set_bias(settings.get(), biases[static_cast<std::size_t>(request.bias)]);
    return settings;
}

class LinesV2 final : public GpioLines {
public:
    Result<void> request(std::span<const LineRequest> requests, std::string_view consumer) {
        buffer_.reset(gpiod_edge_event_buffer_new(edges_at_once));
        if (!buffer_) return system_error("gpio", "No memory is left for edges", errno, "Close other programs");
        for (std::uint32_t i = 0; i < requests.size(); ++i)
            if (auto added = add(requests[i], i); !added) return added;
        for (Chip& chip : chips_)
            if (auto got = request_chip(chip, requests, std::string(consumer)); !got) return got;
        return {};
    }

    [[nodiscard]] std::span<const pollfd> polled() const override { return polled_; }

    /// One chip's queue at a time: it keeps the order across its lines.
    Result<std::size_t> read(std::span<LineEdge> edges) override {
        std::size_t count = 0;
        for (std::size_t c = 0; c < chips_.size(); ++c) {
            while (count < edges.size()) {
                pollfd one = polled_[c];
                const int ready = ::poll(&one, 1, 0);
                if (ready < 0 && errno != EINTR) return system_error(chips_[c].name, "The lines cannot be polled", errno);
                if (ready > 0 && (one.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0)
                    return Error{chips_[c].name, "The chip is gone", "Plug it in again", ErrorKind::no_device};
                if (ready <= 0 || (one.revents & POLLIN) == 0) break;
                const int got = gpiod_line_request_read_edge_events(chips_[c].request.get(), buffer_.get(),
                                                                    std::min(edges_at_once, edges.size() - count));
                if (got < 0) return system_error(chips_[c].name, "The edges cannot be read", errno);
                for (int k = 0; k < got; ++k) edges[count++] = edge_of(chips_[c], static_cast<unsigned long>(k));
            }
        }
        return count;
    }

    Result<void> levels(std::span<bool> active) override {
        for (Chip& chip : chips_) {
            std::array<gpiod_line_value, 64> values{};
            if (gpiod_line_request_get_values_subset(chip.request.get(), chip.offsets.size(), chip.offsets.data(),
                                                     values.data()) != 0)
                return system_error(chip.name, "The lines cannot be read", errno);
            for (std::size_t i = 0; i < chip.index.size(); ++i) active[chip.index[i]] = values[i] == GPIOD_LINE_VALUE_ACTIVE;
        }
        return {};
    }

private:
    Result<void> add(const LineRequest& request, std::uint32_t index) {
        auto at = std::find_if(chips_.begin(), chips_.end(), [&](const Chip& c) { return c.name == request.chip; });
        if (at == chips_.end()) {
            chips_.push_back({request.chip, open_chip(request.chip), nullptr, {}, {}});
            at = chips_.end() - 1;
        }
        if (!at->chip)
            return system_error(request.chip, "The chip cannot be opened", errno,
                                "See `gpiodetect`, and add the user to the group gpio");
        const std::string place = fmt::format("{} line '{}'", request.chip, request.line);
        int offset = gpiod_chip_get_line_offset_from_name(at->chip.get(), request.line.c_str());
        if (offset < 0) offset = number_in<int>(request.line).value_or(-1);
        const InfoPtr info{offset < 0 ? nullptr : gpiod_chip_get_line_info(at->chip.get(), static_cast<unsigned>(offset))};
        if (!info) return Error{place, "There is no such line", "See `gpioinfo`", ErrorKind::not_found};
        if (gpiod_line_info_is_used(info.get())) return busy(place, info.get());
        if (at->index.size() == 64)
            return Error{place, "The line is the 65th of its chip; at most 64 are allowed", "Remove a line of this chip",
                         ErrorKind::out_of_limits};
        at->index.push_back(index);
        at->offsets.push_back(static_cast<unsigned>(offset));
        return {};
    }

    static Error busy(const std::string& place, gpiod_line_info* info) {
        const char* user = gpiod_line_info_get_consumer(info);
        return {place, fmt::format("The line is in use by '{}'", user != nullptr ? user : "the kernel"),
                "Stop that program, or use another line", ErrorKind::no_device};
    }

    Result<void> request_chip(Chip& chip, std::span<const LineRequest> requests, const std::string& consumer) {
        const LinesPtr lines{gpiod_line_config_new()};
        const ConfigPtr config{gpiod_request_config_new()};
        if (!lines || !config) return system_error(chip.name, "No memory is left for a request", errno, "Close other programs");
        gpiod_request_config_set_consumer(config.get(), consumer.c_str());
        gpiod_request_config_set_event_buffer_size(config.get(), queue);
        for (std::size_t i = 0; i < chip.index.size(); ++i) {
            const SettingsPtr settings = settings_of(requests[chip.index[i]]);
            if (!settings || gpiod_line_config_add_line_settings(lines.get(), &chip.offsets[i], 1, settings.get()) != 0)
                return system_error(chip.name, "A line cannot be set up", errno);
        }
        chip.request.reset(gpiod_chip_request_lines(chip.chip.get(), config.get(), lines.get()));
        if (!chip.request) {
            const int code = errno;
            for (std::size_t i = 0; code == EBUSY && i < chip.index.size(); ++i) {
                const InfoPtr info{gpiod_chip_get_line_info(chip.chip.get(), chip.offsets[i])};
                if (info && gpiod_line_info_is_used(info.get()))
                    return busy(fmt::format("{} line '{}'", chip.name, requests[chip.index[i]].line), info.get());
            }
            return system_error(chip.name, "The lines cannot be requested", code);
        }
        polled_.push_back({gpiod_line_request_get_fd(chip.request.get()), POLLIN, 0});
        return {};
    }

    [[nodiscard]] LineEdge edge_of(const Chip& chip, unsigned long k) const {
        gpiod_edge_event* event = gpiod_edge_event_buffer_get_event(buffer_.get(), k);
        const auto at = std::find(chip.offsets.begin(), chip.offsets.end(), gpiod_edge_event_get_line_offset(event));
        // A line that nobody asked for cannot come; its index would be out of range and be ignored.
        const auto line = at == chip.offsets.end() ? UINT32_MAX : chip.index[static_cast<std::size_t>(at - chip.offsets.begin())];
        return {line, gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE,
                static_cast<std::int64_t>(gpiod_edge_event_get_timestamp_ns(event)),
                static_cast<std::uint32_t>(gpiod_edge_event_get_line_seqno(event))};
    }

    std::vector<Chip> chips_;
    std::vector<pollfd> polled_;  ///< parallel to chips_
    BufferPtr buffer_;
};

}  // namespace

Result<std::unique_ptr<GpioLines>> open_lines(std::span<const LineRequest> requests, std::string_view consumer, void*) {
    auto lines = std::make_unique<LinesV2>();
    if (auto requested = lines->request(requests, consumer); !requested) return requested.error();
    return std::unique_ptr<GpioLines>(std::move(lines));
}

std::string gpio_back_end() { return fmt::format("libgpiod {}", gpiod_api_version()); }

}  // namespace surefoot::input
