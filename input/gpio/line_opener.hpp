// Opening a panel's lines, and closing them: in the reader's own thread (tools), or in one beside it that hands them over open.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "input/gpio/lines.hpp"

namespace surefoot::input {

constexpr std::size_t max_lines = 64;  // what one request may hold in the kernel

/// What became of a try. Made and unmade by the opener, so that the reader needs no memory when a chip comes or goes.
struct OpenedLines {
    std::unique_ptr<GpioLines> lines;      ///< null: they could not be opened
    std::array<bool, max_lines> levels{};  ///< as they were then
    Error error;                           ///< why they could not be opened; later, why they can no longer be read
};

/// What is to be opened, and by what: open_lines, or a fake.
struct LinesToOpen {
    std::vector<LineRequest> requests;
    OpenLines open = open_lines;
    void* context = nullptr;
    std::string consumer;
};

/// One thread calls all of it. What could not be opened is tried again, see Retry.
class LineOpener {
public:
    virtual ~LineOpener() = default;
    /// Returns when the first try is over, or will be made by next().
    virtual void wait_for_first() = 0;
    /// The lines, or a new reason why not; null: nothing new. Lines stay with the reader until it gives them back.
    virtual std::unique_ptr<OpenedLines> next(std::int64_t now_ns) = 0;
    /// Whatever next() gave, when the reader is done with it: lines that can no longer be read are opened anew.
    virtual void give_back(std::unique_ptr<OpenedLines> opened, std::int64_t now_ns) = 0;
};

/// Where lines are opened.
enum class Opening : std::uint8_t { here, beside };

constexpr const char* lines_thread_name = "sf-lines";
/// here: whenever next() is called and it is time. beside: in a thread of its own named lines_thread_name, at SCHED_OTHER; the
/// calls then neither allocate, free nor lock.
std::unique_ptr<LineOpener> make_line_opener(LinesToOpen lines, Opening where);

}  // namespace surefoot::input
