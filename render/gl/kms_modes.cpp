// Choosing a screen and its mode (kms_modes.hpp).
#include "render/gl/kms_modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace surefoot::gl {

namespace {

constexpr double same_rate = 5e-3;  // 59.94 is 60

/// The number at the front of the text, which is taken away from it; nothing where there is none.
template <class Number>
std::optional<Number> take_number(std::string_view& text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{}) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return number;
}

Error wrong_mode(std::string_view text) {
    return Error{fmt::format("mode '{}'", text), "This is no mode", "Write WIDTHxHEIGHT@HZ, as in 1920x1080@60, or nothing",
                 ErrorKind::misuse};
}

std::string connected_names(std::span<const Screen> screens) {
    std::string text;
    for (const Screen& screen : screens)
        text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", screen.name, screen.connected ? "connected" : "nothing on it");
    return text;
}

/// Each mode once; the screen's own order, which begins with the best.
std::string mode_names(const Screen& screen) {
    constexpr std::size_t max_names = 16;
    std::vector<std::string> names;
    for (const ScreenMode& mode : screen.modes) {
        std::string name = in_words(mode);
        if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
    }
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), max_names); ++i) text += (i == 0 ? "" : ", ") + names[i];
    if (names.size() > max_names) text += fmt::format(" and {} more", names.size() - max_names);
    return text;
}

bool fits(const ScreenMode& mode, const ModeRequest& request, const ScreenMode* preferred) {
    if (mode.interlaced || mode.refresh_ns <= 0) return false;
    if (request.rate_hz > 0 && std::abs(rate_hz(mode) / request.rate_hz - 1) > same_rate) return false;
    if (request.width > 0) return mode.width == request.width && mode.height == request.height;
    return preferred == nullptr || (mode.width == preferred->width && mode.height == preferred->height);
}

}  // namespace

double rate_hz(const ScreenMode& mode) { return 1e9 / static_cast<double>(mode.refresh_ns); }

std::string in_words(const ScreenMode& mode) {
    return fmt::format("{}x{}@{:.4g}{}", mode.width, mode.height, rate_hz(mode), mode.interlaced ? " interlaced" : "");
}

Result<ModeRequest> read_mode(std::string_view text) {
    ModeRequest request;
    std::string_view rest = text;
    if (!rest.empty() && rest.front() != '@') {
        const auto width = take_number<std::uint32_t>(rest);
        if (!width || !rest.starts_with('x')) return wrong_mode(text);
        rest.remove_prefix(1);
        const auto height = take_number<std::uint32_t>(rest);
        if (!height || *width == 0 || *height == 0) return wrong_mode(text);
        request.width = *width;
        request.height = *height;
    }
    if (rest.starts_with('@')) {
        rest.remove_prefix(1);
        const auto rate = take_number<double>(rest);
        if (!rate || !(*rate >= 1 && *rate <= 1000)) return wrong_mode(text);
        request.rate_hz = *rate;
    }
    if (!rest.empty()) return wrong_mode(text);
    return request;
}

Result<const Screen*> choose_screen(std::span<const Screen> screens, std::string_view name) {
    const auto found = std::ranges::find_if(
        screens, [&](const Screen& screen) { return name.empty() ? screen.connected : screen.name == name; });
    if (found != screens.end() && found->connected) return &*found;
    const std::string here = connected_names(screens);
    if (here.empty())
        return Error{"screen", "No graphics card here has a screen's connector",
                     "Use --backend egl, or install the card's driver", ErrorKind::no_device};
    if (name.empty())
        return Error{"screen", "Nothing is connected. The connectors here: " + here, "Connect a screen and switch it on",
                     ErrorKind::no_device};
    if (found != screens.end())
        return Error{fmt::format("screen '{}'", name), "Nothing is connected there. The connectors here: " + here,
                     "Connect a screen and switch it on, or choose another one", ErrorKind::no_device};
    return Error{fmt::format("screen '{}'", name), "There is no such connector. Those here: " + here, "Choose one of them",
                 ErrorKind::no_device};
}

Result<ScreenMode> choose_mode(const Screen& screen, const ModeRequest& request) {
    const auto preferred = std::ranges::find_if(screen.modes, &ScreenMode::preferred);
    const ScreenMode* usual = preferred != screen.modes.end() ? &*preferred
                              : screen.modes.empty()          ? nullptr
                                                              : &screen.modes.front();
    const ScreenMode* best = nullptr;
    for (const ScreenMode& mode : screen.modes) {
        if (!fits(mode, request, usual)) continue;
        const bool better = best == nullptr ? true
                            : request.rate_hz > 0
                                ? std::abs(rate_hz(mode) - request.rate_hz) < std::abs(rate_hz(*best) - request.rate_hz)
                                : !best->preferred && (mode.preferred || mode.refresh_ns < best->refresh_ns);
        if (better) best = &mode;
    }
    if (best != nullptr) return *best;
    return Error{"mode of " + screen.name, "The screen has no such mode. Its modes: " + mode_names(screen), "Choose one of them",
                 ErrorKind::not_found};
}

}  // namespace surefoot::gl
