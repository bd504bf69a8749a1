// What pictures show in place of forms: boxes of the scene as bits, and the test that leaves out what lies in them.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>

namespace surefoot::model {

/// Boxes of the scene, a bit each. Fixed memory, so that threads exchange it by copying.
constexpr std::size_t max_cover_boxes = 8192;
using CoverBits = std::bitset<max_cover_boxes>;

/// Finds what lies wholly in covered boxes. Any thread may use it.
class CoverTest {
public:
    virtual ~CoverTest() = default;
    /// Whether the boxes of these bits show all of a node of the model.
    [[nodiscard]] virtual bool covered(std::uint32_t node, const CoverBits& bits) const = 0;
};

}  // namespace surefoot::model
