// OSTF, Object Separated Triangle Format (Selcuk 1997, appendix A): a text tree of objects, leaves of raw triangles.
// Streaming: an index of the tree with offsets first, then one leaf at a time, so files may be larger than memory.
#pragma once

#include <cstdint>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "render/import/scene.hpp"
#include "rt/base/result.hpp"

namespace surefoot::importer {

/// An object of an OSTF file, not yet read.
struct OstfObject {
    std::string name;
    Index parent = none;          ///< index in OstfIndex::objects; parents come first
    std::uint64_t triangles = 0;  ///< count field; 0: holds other objects
    std::string texture;          ///< leaf only; may be empty
    std::uint64_t offset = 0;     ///< byte offset of the leaf's first triangle
    std::uint64_t line = 0;       ///< line of its START_TAG, for errors
};

/// The table of contents of an OSTF file.
struct OstfIndex {
    std::string file;
    std::vector<OstfObject> objects;
};

/// One corner: normal, coordinate, colour, texture coordinate, in the file's order.
struct OstfVertex {
    vec3 normal, position, colour;
    vec2 uv;
};

/// One pass over the file; memory grows with the number of objects, not of triangles. Errors carry the line.
Result<OstfIndex> index_ostf(const std::string& file, const Progress& progress);
/// Reads one leaf by its offset: 3 * triangles vertices.
Result<std::vector<OstfVertex>> read_ostf_leaf(const OstfIndex& index, Index object);
/// The whole file as a scene (leaf by leaf).
Result<Scene> import_ostf(const std::string& file, const Progress& progress);
/// Writes leaf by leaf. Textures become PNG files beside the file. Replaces the old file only when complete.
Result<void> write_ostf(const std::string& file, const Scene& scene, const Progress& progress);

}  // namespace surefoot::importer
