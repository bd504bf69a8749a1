// One figure of a /proc file: "NAME value" or "NAME: value" at the beginning of a line.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace surefoot::soak {

/// 0 where there is no such line.
std::uint64_t proc_figure(std::string_view text, std::string_view name);
/// The same, of a file; 0 where it cannot be read, too.
std::uint64_t proc_figure_of(const std::string& file, std::string_view name);

}  // namespace surefoot::soak
