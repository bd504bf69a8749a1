// The .walk file: a model on disk. Little-endian, section table, a checksum a section, zstd pages.
#pragma once

#include <cstdint>
#include <string>

#include "render/model/model.hpp"
#include "rt/base/result.hpp"

namespace surefoot::model {

/// Sizes of a `.walk` file.
struct WalkFileInfo {
    std::uint64_t bytes = 0;          ///< on disk
    std::uint64_t payload_bytes = 0;  ///< geometry and texels, unpacked
    std::uint32_t pages = 0;
    std::uint64_t hash = 0;  ///< of all sections that are drawn; equal for equal bakes
};

/// Written under a temporary name, synced, renamed: the old file survives any failure.
Result<WalkFileInfo> write_walk(const std::string& file, const Model& model);

/// Checks the checksum of every byte, and bounds every count and offset before it allocates. Then validate().
Result<Model> read_walk(const std::string& file, WalkFileInfo* info = nullptr);

}  // namespace surefoot::model
