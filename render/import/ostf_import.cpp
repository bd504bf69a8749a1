// One leaf of an OSTF file by its offset; and the whole file as a Scene.
#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "render/image/image.hpp"
#include "render/import/finish.hpp"
#include "render/import/ostf.hpp"
#include "render/import/text_cursor.hpp"
#include "rt/base/hash.hpp"

namespace surefoot::importer {
namespace {

constexpr std::size_t read_at_once = 1U << 20U;  // bytes

/// Reads number after number from an open file, window by window: a leaf may be larger than memory likes.
class NumberStream {
public:
    NumberStream(const std::string& file, std::uint64_t offset) : in_(file, std::ios::binary) {
        in_.seekg(static_cast<std::streamoff>(offset));
    }

    bool next(float& value) {
        while (true) {
            while (at_ < buffer_.size() && static_cast<unsigned char>(buffer_[at_]) <= ' ') ++at_;
            const char* first = buffer_.data() + at_;
            const char* end = buffer_.data() + buffer_.size();
            const char* last = first;
            while (last != end && static_cast<unsigned char>(*last) > ' ') ++last;
            if (last == end && refill()) continue;  // the number may go on
            if (first == last) return false;
            TextCursor cursor(std::string_view(first, static_cast<std::size_t>(last - first)));
            if (!cursor.number(value)) return false;
            at_ = static_cast<std::size_t>(last - buffer_.data());
            return true;
        }
    }

private:
    bool refill() {
        if (!in_) return false;
        buffer_.erase(0, at_);
        at_ = 0;
        const std::size_t kept = buffer_.size();
        buffer_.resize(kept + read_at_once);
        in_.read(buffer_.data() + kept, static_cast<std::streamsize>(read_at_once));
        buffer_.resize(kept + static_cast<std::size_t>(in_.gcount()));
        return buffer_.size() > kept;
    }
    std::ifstream in_;
    std::string buffer_;
    std::size_t at_ = 0;
};

std::uint64_t hash_of(const OstfVertex& v) { return hash_bytes(std::as_bytes(std::span(&v, 1))); }

/// Bit for bit, as the hash is.
bool same(const OstfVertex& a, const OstfVertex& b) {
    using Bits = std::array<std::uint32_t, 11>;
    return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

/// Raw triangles to an indexed primitive: equal vertices become one.
Primitive weld(const std::vector<OstfVertex>& vertices) {
    Primitive p;
    float largest = 0;
    for (const OstfVertex& v : vertices) largest = std::max({largest, v.colour.x, v.colour.y, v.colour.z});
    const float scale = largest > 1.0F ? 1.0F / 255.0F : 1.0F;  // the format does not say 0..1 or 0..255
    std::size_t slots = 64;
    while (slots < vertices.size() * 2) slots *= 2;
    std::vector<std::uint32_t> table(slots, none), first_of;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const OstfVertex& v = vertices[i];
        std::size_t slot = hash_of(v) & (slots - 1);
        while (table[slot] != none && !same(vertices[first_of[table[slot]]], v)) slot = (slot + 1) & (slots - 1);
        if (table[slot] == none) {
            table[slot] = static_cast<std::uint32_t>(first_of.size());
            first_of.push_back(static_cast<std::uint32_t>(i));
            p.positions.push_back(v.position);
            p.normals.push_back(v.normal);
            p.uvs.emplace_back(v.uv.x, 1.0F - v.uv.y);  // OpenGL's, from the picture's lower edge
            p.colours.push_back({image::to_byte(v.colour.x * scale), image::to_byte(v.colour.y * scale),
                                 image::to_byte(v.colour.z * scale), 255});
        }
        p.indices.push_back(table[slot]);
    }
    return p;
}

class Materials {
public:
    Materials(const std::string& file, Scene& scene) : file_(file), scene_(scene) {}
    Index of_texture(const std::string& name) {
        const auto [found, added] = done_.try_emplace(name, static_cast<Index>(scene_.materials.size()));
        if (added) {
            Material material;
            material.name = name.empty() ? "plain" : name;
            material.two_sided = true;  // the format says nothing of facing
            if (!name.empty()) material.image = picture_for(material, load_texture(scene_, file_, name));
            scene_.materials.push_back(std::move(material));
        }
        return found->second;
    }

private:
    const std::string& file_;
    Scene& scene_;
    std::map<std::string, Index> done_;
};

}  // namespace

Result<std::vector<OstfVertex>> read_ostf_leaf(const OstfIndex& index, Index object) {
    if (object >= index.objects.size() || index.objects[object].triangles == 0)
        return Error{index.file, fmt::format("Object {} is no leaf", object), "Name an object that has triangles",
                     ErrorKind::not_found};
    const OstfObject& leaf = index.objects[object];
    NumberStream numbers(index.file, leaf.offset);
    std::vector<OstfVertex> vertices;
    vertices.reserve(leaf.triangles * 3);
    for (std::uint64_t i = 0; i < leaf.triangles * 3; ++i) {
        OstfVertex v{};
        for (float* to : {&v.normal.x, &v.normal.y, &v.normal.z, &v.position.x, &v.position.y, &v.position.z, &v.colour.x,
                          &v.colour.y, &v.colour.z, &v.uv.x, &v.uv.y}) {
            if (!numbers.next(*to)) {
                return Error{fmt::format("{}: '{}' from line {}", index.file, leaf.name, leaf.line),
                             fmt::format("Vertex {} of {} is incomplete", i, leaf.triangles * 3), "Export the model again",
                             ErrorKind::damaged};
            }
        }
        vertices.push_back(v);
    }
    return vertices;
}

Result<Scene> import_ostf(const std::string& file, const Progress& progress) {
    auto index = index_ostf(file, progress);
    if (!index) return index.error();
    Scene scene;
    Materials materials(file, scene);
    for (std::size_t i = 0; i < index->objects.size(); ++i) {
        const OstfObject& object = index->objects[i];
        if (progress.stopped()) return Error{file, "The import was stopped", "", ErrorKind::stopped};
        Node node;
        node.name = object.name;
        node.parent = object.parent;
        if (object.triangles > 0) {
            auto vertices = read_ostf_leaf(*index, static_cast<Index>(i));
            if (!vertices) return vertices.error();
            Primitive primitive = weld(*vertices);
            primitive.material = materials.of_texture(object.texture);
            node.mesh = static_cast<Index>(scene.meshes.size());
            scene.meshes.push_back(Mesh{object.name, {}});
            scene.meshes.back().primitives.push_back(std::move(primitive));
        }
        scene.nodes.push_back(std::move(node));
        progress.update("import", static_cast<double>(i + 1) / static_cast<double>(index->objects.size()));
    }
    if (auto usable = finish(scene, file, progress); !usable) return usable.error();
    return scene;
}

}  // namespace surefoot::importer
