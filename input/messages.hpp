// Messages of the input thread for people: lines of fixed size, so that emitting one neither allocates, locks nor waits.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <string_view>

#include "rt/base/result.hpp"

namespace surefoot::input {

/// One line; longer text is cut off.
struct MessageLine {
    std::array<char, 760> text{};
    std::size_t size = 0;
    [[nodiscard]] std::string_view view() const { return {text.data(), size}; }
};

/// The receiver of messages. Must neither allocate nor lock if its caller must not.
using MessageSink = std::function<void(std::string_view)>;

template <class... T>
MessageLine format_message(fmt::format_string<T...> format, T&&... what) {
    MessageLine line;
    const auto end = fmt::format_to_n(line.text.data(), line.text.size(), format, std::forward<T>(what)...);
    line.size = std::min(end.size, line.text.size());
    return line;
}

/// The words of Error::text(), which allocates: the input thread may not.
inline MessageLine format_message(const Error& error) {
    const std::string_view colon = error.place.empty() || error.what.empty() ? "" : ": ";
    const std::string_view before = error.what.empty() ? error.place : error.what;
    if (error.remedy.empty()) return format_message("{}{}{}{}", error.place, colon, error.what, full_stop_after(before));
    return format_message("{}{}{}{} {}{}", error.place, colon, error.what, full_stop_after(before), error.remedy,
                          full_stop_after(error.remedy));
}

template <class... T>
void emit(const MessageSink& sink, fmt::format_string<T...> format, T&&... what) {
    if (sink) sink(format_message(format, std::forward<T>(what)...).view());
}

inline void emit(const MessageSink& sink, const Error& error) {
    if (sink) sink(format_message(error).view());
}

}  // namespace surefoot::input
