// Opens and closes the lines of a panel: in the reader's thread (tools), or in its own thread that hands over open lines.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "input/gpio/lines.hpp"

namespace surefoot::input {

constexpr std::size_t max_lines = 64;  // the kernel's limit of one request

/// Result of a try. Made and destroyed by the opener, so that the reader does not allocate when a chip comes or goes.
struct OpenedLines {
    std::unique_ptr<GpioLines> lines;      ///< null: they could not be opened
    std::array<bool, max_lines> levels{};  ///< as they were then
    Error error;                           ///< why they could not be opened, or can no longer be read
};

/// The lines to open, and the function that opens them: open_lines, or a fake.
struct LinesToOpen {
    std::vector<LineRequest> requests;
    OpenLines open = open_lines;
    void* context = nullptr;
    std::string consumer;
};

/// One thread calls all members. Failed tries are repeated, see Retry.
class LineOpener {
public:
    virtual ~LineOpener() = default;
    /// Returns when the first try is over, or will be made by next().
    virtual void wait_for_first() = 0;
    /// The lines, or a new reason why not; null: nothing new. Lines stay with the reader until it gives them back.
    virtual std::unique_ptr<OpenedLines> next(std::int64_t now_ns) = 0;
    /// Returns a result of next() that the reader no longer needs. Lines that can no longer be read are opened again.
    virtual void give_back(std::unique_ptr<OpenedLines> opened, std::int64_t now_ns) = 0;
};

/// Where lines are opened.
enum class Opening : std::uint8_t { same_thread, own_thread };

constexpr const char* lines_thread_name = "sf-lines";
/// same_thread: inside next(), when a try is due. own_thread: in a thread named lines_thread_name, at SCHED_OTHER; then the
/// calls neither allocate, free nor lock.
std::unique_ptr<LineOpener> make_line_opener(LinesToOpen lines, Opening where);

}  // namespace surefoot::input
