// The bodies of the fuzz targets on files and on words from outside: what must hold of whatever a reader takes.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "config/settings.hpp"
#include "render/image/image.hpp"
#include "render/import/scene.hpp"
#include "render/model/model.hpp"
#include "render/model/walk_file.hpp"
#include "tests/config/toy_schema.hpp"
#include "tests/fuzz/targets.hpp"
#include "tools/monitor/address.hpp"
#include "tools/selftest/fixtures.hpp"

namespace surefoot::fuzz {

inline std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// One file in memory for the whole run; its name ends as nothing does, which the readers below do not ask.
inline const std::string& file_with(std::span<const std::byte> bytes) {
    static selftest::MemoryFile file;
    require(file.ok() && file.set(bytes));
    return file.name();
}

/// An answer is a model that holds what the draw code relies on; a refusal says what is wrong. Checksums are put right first,
/// or nothing would come past them.
inline void walk_file(std::span<const std::byte> bytes) {
    selftest::Bytes resealed(bytes.begin(), bytes.end());
    selftest::reseal_walk(resealed);
    const auto read = model::read_walk(file_with(resealed));
    if (!read) return require(!read.error().what.empty());
    require(model::validate(*read).ok());
}

inline void picture(std::span<const std::byte> bytes) {
    const auto read = image::decode_image(bytes, "fuzz");
    if (!read) return require(!read.error().what.empty());
    require(read->width > 0 && read->width <= 16384 && read->height > 0 && read->height <= 16384);
    require(read->rgba.size() == std::size_t{4} * read->width * read->height);
}

/// Every index of what an importer hands on is of something that is there.
inline void scene(const Result<importer::Scene>& read) {
    if (!read) return require(!read.error().what.empty());
    for (const importer::Mesh& mesh : read->meshes) {
        for (const importer::Primitive& p : mesh.primitives) {
            require(p.indices.size() % 3 == 0 && p.material < read->materials.size());
            for (const std::uint32_t index : p.indices) require(index < p.positions.size());
        }
    }
}
inline void gltf(std::span<const std::byte> bytes) { scene(importer::import_gltf(file_with(bytes), {})); }
inline void obj(std::span<const std::byte> bytes) { scene(importer::import_obj(file_with(bytes), {})); }

inline void settings(std::span<const std::byte> bytes) {
    config::Configuration read(config::test::toy_schema());
    const auto loaded = config::load_text(read, text_of(bytes), "fuzz");
    if (!loaded) return require(loaded.error().place.starts_with("fuzz") && !loaded.error().what.empty());
    (void)config::check(read);
}

/// Where to listen, and a request's Host: an address that is taken is written and read again to the same.
inline void address(std::span<const std::byte> bytes) {
    (void)monitor::host_is_loopback(text_of(bytes));
    const auto first = monitor::parse_address(std::string(text_of(bytes)));
    if (!first) return require(!first.error().what.empty());
    const auto second = monitor::parse_address(first->text());
    require(second.ok() && second->text() == first->text());
}

}  // namespace surefoot::fuzz
