// The screens of a running service: one page (`surefoot status`), and a live screen or a line a second (`surefoot top`). Pure
// functions of /status.json.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/result.hpp"
#include "tools/monitor/address.hpp"
#include "tools/report/terminal.hpp"

namespace surefoot::monitor {

/// /status.json of `address` as read; an Error where it is something else.
Result<nlohmann::json> parse_status(const Address& address, const std::string& text);

std::vector<std::string> status_page(const nlohmann::json& status, const report::TerminalStyle& style);

/// before: the status some time ago, null for none; between_s: how long ago. Rates come from the two.
std::vector<std::string> top_page(const nlohmann::json& status, const nlohmann::json& before, double between_s,
                                  const report::TerminalStyle& style);
std::string top_line(const nlohmann::json& status, const nlohmann::json& before, double between_s);

}  // namespace surefoot::monitor
