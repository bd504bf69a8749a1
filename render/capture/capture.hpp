// One frame's selection in a file: prepared arrays, input and state of the selector, and the resulting cut. The selection can be
// repeated from it without model or device, and must give the same cut.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/prepare/prepared.hpp"
#include "render/select/select.hpp"
#include "rt/base/result.hpp"

namespace surefoot::capture {

/// What a selector remembered, SelectState::before and bought_before after the selection, and how it prefers that.
struct Memory {
    std::vector<select::Shown> shown;
    select::RememberedItems bought{};
    float hysteresis = 1, reserve_share = 0;  ///< of the state
};

/// One captured frame: prepared arrays, cut, and all that the selection depended on.
struct Capture {
    std::uint64_t frame = 0;  ///< of the walk; prepared.frame is the frame whose pose started the preparation
    prepare::PreparedFrame prepared;
    std::string selector;
    double budget_us = 0, correction = 1, target_error_rad = 0, slice_us = 1000;
    double max_error_rad = 0;                     ///< that was guaranteed; 0 in files that do not hold it
    model::FrameCombine combine;                  ///< of the resolution that is drawn
    float enlarge_ns_per_pixel = 0;               ///< of the cost model
    float headroom = 1, slice_end_us = 0;         ///< of the cost model; selection uses no more of it
    float hysteresis = 1, reserve_share = 0.03F;  ///< the share in files that do not hold it
    std::uint32_t node_count = 0;                 ///< of the model
    std::vector<select::Shown> memory;            ///< state of the selector before the selection
    std::vector<select::ItemName> bought_before;  ///< the same, of what was bought beside forms
    std::vector<select::Item> offered;            ///< what could be bought beside forms
    std::vector<select::CutItem> items;           ///< the cut
    std::uint64_t hash = 0;                       ///< of the cut
    float predicted_us = 0;
};

/// Makes a capture. Allocates, so not for the frame thread.
Capture take(const select::SelectInput& input, std::string_view selector, Memory memory, const select::Cut& cut);

/// Little-endian; magic, version, sizes and a checksum, then one zstd frame. Replaces the file only when complete.
Result<void> write_capture(const std::string& file, const Capture& capture);

/// Refuses files that are truncated, changed in any byte, or inconsistent in any index.
Result<Capture> read_capture(const std::string& file);
Result<Capture> parse_capture(std::span<const std::byte> bytes, const std::string& place);

/// The captured offers, as the selection had them.
select::ItemList items_of(const Capture& capture);

/// Repeats the selection, by the captured selector or by another one, the oracle too.
Result<select::Cut> replay(const Capture& capture, std::string_view selector = {});

/// replay() by the captured selector. If the cut differs, the error names the first difference.
Result<void> verify(const Capture& capture);

}  // namespace surefoot::capture
