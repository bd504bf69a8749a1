// Fetches a page from a monitor, within a time limit.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "rt/base/result.hpp"
#include "tools/monitor/address.hpp"

namespace surefoot::monitor {

/// The body of GET `path`. Errors name the place and the remedy: nobody there, no permission, no answer in time, another program.
Result<std::string> fetch(const Address& address, std::string_view path, std::int64_t timeout_ms = 3000);

}  // namespace surefoot::monitor
