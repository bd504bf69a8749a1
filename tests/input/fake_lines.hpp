// GPIO lines made by hand: levels, edges, a kernel queue that overflows as version 1 or 2, a chip that vanishes, a busy line.
#pragma once

#include <algorithm>
#include <deque>
#include <string>
#include <vector>

#include "input/gpio/panel.hpp"

namespace surefoot::input::test {

/// What is soldered on; outlives the lines that are requested from it.
struct FakeChip {
    std::vector<bool> level = std::vector<bool>(16, false);  ///< active, index-parallel to the requests
    std::deque<LineEdge> queue;
    std::vector<std::uint32_t> sequence = std::vector<std::uint32_t>(16, 0);
    std::size_t queue_limit = 1024;
    bool drops_newest = false;  ///< version 1: and does not number
    bool gone = false;
    std::string busy_by;
    int opened = 0, tried = 0;

    void set(std::uint32_t line, bool active, std::int64_t stamp_ns) {
        if (level[line] == active) return;
        level[line] = active;
        const LineEdge edge{line, active, stamp_ns, drops_newest ? 0 : ++sequence[line]};
        if (queue.size() < queue_limit) return queue.push_back(edge);
        if (drops_newest) return;
        queue.pop_front();
        queue.push_back(edge);
    }
};

class FakeLines final : public GpioLines {
public:
    FakeLines(FakeChip& chip, std::size_t count) : chip_(chip), count_(count) {}
    [[nodiscard]] std::span<const pollfd> polled() const override { return {}; }
    Result<std::size_t> read(std::span<LineEdge> edges) override {
        if (chip_.gone) return Error{"fake", "The chip is gone", "Plug it in again"};
        const std::size_t count = std::min(edges.size(), chip_.queue.size());
        for (std::size_t i = 0; i < count; ++i) {
            edges[i] = chip_.queue.front();
            chip_.queue.pop_front();
        }
        return count;
    }
    Result<void> levels(std::span<bool> active) override {
        if (chip_.gone) return Error{"fake", "The chip is gone", "Plug it in again"};
        for (std::size_t i = 0; i < count_; ++i) active[i] = chip_.level[i];
        return {};
    }

private:
    FakeChip& chip_;
    std::size_t count_;
};

inline Result<std::unique_ptr<GpioLines>> open_fake(std::span<const LineRequest> requests, std::string_view, void* context) {
    auto& chip = *static_cast<FakeChip*>(context);
    ++chip.tried;
    if (chip.gone) return Error{"fake", "The chip cannot be opened: No such device", "Plug it in"};
    if (!chip.busy_by.empty()) return Error{"fake line 'ESTOP'", "is in use by '" + chip.busy_by + "'", "stop that program"};
    ++chip.opened;
    chip.queue.clear();
    std::fill(chip.sequence.begin(), chip.sequence.end(), 0);
    return std::unique_ptr<GpioLines>(std::make_unique<FakeLines>(chip, requests.size()));
}

}  // namespace surefoot::input::test
