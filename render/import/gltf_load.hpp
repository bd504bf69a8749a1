// From bytes to tinygltf's structures: first the checks that tinygltf 2.7 does not make, then tinygltf.
#pragma once

#include <string>
#include <vector>

#include "render/import/tinygltf.hpp"
#include "rt/base/result.hpp"

namespace surefoot::importer {

/// The remedy for a file that is damaged.
inline constexpr const char* export_again = "export the model again";

/// Buffers are loaded and at least as long as their byteLength says; nothing else in the model may be trusted: accessors,
/// views (but those of images), indices of every kind are checked where they are used.
/// Images: `image` holds the encoded bytes of a data URI; else `bufferView` or `uri` says where they are.
Result<tinygltf::Model> load_gltf(const std::string& file, std::vector<std::string>& warnings);

/// %20 and the like, as URIs write them.
std::string decode_uri(const std::string& uri);

}  // namespace surefoot::importer
