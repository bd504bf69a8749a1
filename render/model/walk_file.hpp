// The .walk file: a model on disk (DESIGN 6). Little-endian, section table, a checksum a section, zstd pages.
#pragma once

#include <cstdint>
#include <string>

#include "render/model/model.hpp"
#include "rt/base/result.hpp"

namespace surefoot::model {

struct WalkFileInfo {
    std::uint64_t bytes = 0;          ///< on disk
    std::uint64_t payload_bytes = 0;  ///< geometry and texels, unpacked
    std::uint32_t pages = 0;
    std::uint64_t hash = 0;  ///< of all sections but the provenance, which names folders: the same for the same bake
};

/// Written under a temporary name, synced, renamed: what was there before survives any failure.
Result<WalkFileInfo> write_walk(const std::string& file, const Model& model);

/// Every byte is covered by a checksum, every count and offset is bounded before anything is allocated, then validate().
Result<Model> read_walk(const std::string& file, WalkFileInfo* info = nullptr);

}  // namespace surefoot::model
