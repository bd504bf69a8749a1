// Reads and writes the emergency stop's memory.
#include "input/safety/stop_memory.hpp"

#include <filesystem>

#include "rt/base/file.hpp"

namespace surefoot::input {

namespace {

constexpr std::string_view latched_text = "surefoot emergency stop: latched\n", clear_text = "surefoot emergency stop: clear\n";

}  // namespace

RememberedStop load_stop(const std::string& file) {
    std::error_code problem;
    const auto status = std::filesystem::symlink_status(file, problem);
    if (status.type() == std::filesystem::file_type::not_found) return {};
    const auto text = read_text(file, 4096);
    if (!text) return {true, text.error().text() + " The stop counts as latched."};
    if (*text == clear_text) return {};
    if (*text == latched_text) return {true, {}};
    return {true, file + ": The file says neither latched nor clear. The stop counts as latched."};
}

Result<void> store_stop(const std::string& file, bool latched) { return write_text(file, latched ? latched_text : clear_text); }

Result<void> StopKeeper::flush() {
    const bool latched = latched_.load(std::memory_order_relaxed);
    if (latched == written_) return {};
    auto stored = store_stop(file_, latched);
    if (stored) written_ = latched;
    return stored;
}

}  // namespace surefoot::input
