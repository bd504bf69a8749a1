// Reads glTF accessors as flat arrays, every offset, stride, count and sparse index checked (tinygltf checks none).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/import/tinygltf.hpp"
#include "rt/base/result.hpp"

namespace surefoot::importer {

/// An accessor as floats; normalised integers become 0..1 or -1..1 (glTF 2.0, 3.11).
struct FloatArray {
    std::vector<float> values;  ///< count * components
    std::size_t components = 0;
    [[nodiscard]] std::size_t count() const { return components == 0 ? 0 : values.size() / components; }
};

/// `place` names file and mesh in errors.
Result<FloatArray> read_floats(const tinygltf::Model& model, int accessor, const std::string& place);
/// Scalar unsigned integers.
Result<std::vector<std::uint32_t>> read_indices(const tinygltf::Model& model, int accessor, const std::string& place);

}  // namespace surefoot::importer
