// The fields of a .walk file's records, listed once for writing and reading; little-endian, without padding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "render/model/model.hpp"
#include "rt/base/reader.hpp"

namespace surefoot::model::walk {

/// Appends values to a byte buffer.
struct PutArchive {
    std::vector<std::byte> bytes;

    template <class T>
    void operator()(const T& value) {
        static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
        const auto at = bytes.size();
        bytes.resize(at + sizeof(T));
        std::memcpy(bytes.data() + at, &value, sizeof(T));
    }
    void operator()(const std::string& text) {
        (*this)(static_cast<std::uint32_t>(text.size()));
        const auto* data = reinterpret_cast<const std::byte*>(text.data());
        bytes.insert(bytes.end(), data, data + text.size());
    }
    template <class T>
    void list(const std::vector<T>& values) {
        (*this)(static_cast<std::uint64_t>(values.size()));
        for (const T& value : values) fields(*this, value);
    }
    void list(const std::vector<std::byte>& raw) {
        (*this)(static_cast<std::uint64_t>(raw.size()));
        bytes.insert(bytes.end(), raw.begin(), raw.end());
    }
};

/// Takes values from bounded bytes; failed() after any read beyond the end, or a flag that is neither 0 nor 1.
struct TakeArchive {
    ByteReader reader;
    bool bad = false;

    template <class T>
    void operator()(T& value) {
        static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
        if constexpr (std::is_same_v<T, bool>) {
            const auto raw = reader.read<std::uint8_t>();
            bad = bad || raw > 1;
            value = raw == 1;
        } else {
            value = reader.read<T>();
        }
    }
    void operator()(std::string& text) {
        const auto view = reader.bytes(reader.read<std::uint32_t>());
        text.assign(reinterpret_cast<const char*>(view.data()), view.size());
    }
    /// Grows as records are read: a wrong count meets the end of the bytes before it costs memory.
    template <class T>
    void list(std::vector<T>& values) {
        const auto count = reader.read<std::uint64_t>();
        for (std::uint64_t i = 0; i < count && !failed(); ++i) fields(*this, values.emplace_back());
    }
    void list(std::vector<std::byte>& raw) {
        const auto view = reader.bytes(reader.read<std::uint64_t>());
        raw.assign(view.begin(), view.end());
    }
    [[nodiscard]] bool failed() const { return bad || reader.failed(); }
};

template <class Archive, class Vec>
void vector3(Archive& a, Vec& v) {
    a(v.x), a(v.y), a(v.z);
}

template <class Archive, class NodeT>
requires std::is_same_v<std::remove_const_t<NodeT>, Node>
void fields(Archive& a, NodeT& n) {
    vector3(a, n.box.min), vector3(a, n.box.max);
    a(n.parent), a(n.first_child), a(n.child_count), a(n.first_rep), a(n.rep_count), a(n.name), a(n.object);
    a(n.importance), a(n.kind), a(n.triangles);
}

template <class Archive, class RepT>
requires std::is_same_v<std::remove_const_t<RepT>, Representation>
void fields(Archive& a, RepT& r) {
    a(r.kind), a(r.everywhere), a(r.error_m), a(r.min_distance_m), a(r.placement), a(r.first_part), a(r.part_count);
    a(r.triangles), a(r.effects), a(r.area_m2[0]), a(r.area_m2[1]), a(r.area_m2[2]);
}

template <class Archive, class LossT>
requires std::is_same_v<std::remove_const_t<LossT>, PictureLoss>
void fields(Archive& a, LossT& l) {
    a(l.coverage);
    for (auto& colour : l.colour) a(colour);
}

template <class Archive, class LossT>
requires std::is_same_v<std::remove_const_t<LossT>, LossOfGroup>
void fields(Archive& a, LossT& l) {
    for (auto& colour : l.colour) a(colour);
}

template <class Archive, class SpreadT>
requires std::is_same_v<std::remove_const_t<SpreadT>, ColourSpread>
void fields(Archive& a, SpreadT& s) {
    for (auto& mean : s.mean) a(mean);
    a(s.variance);
}

template <class Archive, class LightT>
requires std::is_same_v<std::remove_const_t<LightT>, LightFacts>
void fields(Archive& a, LightT& l) {
    a(l.day), a(l.latitude_deg), a(l.max_lamp_light), a(l.fog_visibility_m), a(l.night_room_light);
}

template <class Archive, class PartT>
requires std::is_same_v<std::remove_const_t<PartT>, Part>
void fields(Archive& a, PartT& p) { a(p.material), a(p.first_index), a(p.index_count), a(p.first_vertex), a(p.vertex_count); }

template <class Archive, class PlacementT>
requires std::is_same_v<std::remove_const_t<PlacementT>, Placement>
void fields(Archive& a, PlacementT& p) {
    vector3(a, p.origin);
    for (int column = 0; column < 3; ++column) vector3(a, p.linear[column]);
}

template <class Archive, class KeyT>
requires std::is_same_v<std::remove_const_t<KeyT>, MotionKey>
void fields(Archive& a, KeyT& k) {
    a(k.time_s);
    vector3(a, k.translation);
    for (auto& component : k.rotation) a(component);
}

template <class Archive, class MotionT>
requires std::is_same_v<std::remove_const_t<MotionT>, Motion>
void fields(Archive& a, MotionT& m) {
    vector3(a, m.pivot);
    a(m.first_key), a(m.key_count), a(m.period_s), a(m.outer);
}

/// A placement that moves. Sections of placements hold none, so that files without motion stay as they were.
struct MovingPlacement {
    Index placement = none, motion = none;
};

template <class Archive, class MovingT>
requires std::is_same_v<std::remove_const_t<MovingT>, MovingPlacement>
void fields(Archive& a, MovingT& m) { a(m.placement), a(m.motion); }

template <class Archive, class MaterialT>
requires std::is_same_v<std::remove_const_t<MaterialT>, Material>
void fields(Archive& a, MaterialT& m) {
    for (auto& c : m.colour) a(c);
    a(m.texture), a(m.alpha_cutoff), a(m.alpha), a(m.two_sided), a(m.effects);
}

template <class Archive, class TextureT>
requires std::is_same_v<std::remove_const_t<TextureT>, Texture>
void fields(Archive& a, TextureT& t) { a(t.width), a(t.height), a(t.levels), a(t.first_byte), a(t.clamp); }

template <class Archive, class FindingT>
requires std::is_same_v<std::remove_const_t<FindingT>, EffectFinding>
void fields(Archive& a, FindingT& f) { a(f.bit), a(f.called_for), a(f.triangles), a(f.reason); }

template <class Archive, class TextT>
requires std::is_same_v<std::remove_const_t<TextT>, std::string>
void fields(Archive& a, TextT& text) { a(text); }

template <class Archive, class BoxT>
requires std::is_same_v<std::remove_const_t<BoxT>, GroundBox>
void fields(Archive& a, BoxT& b) {
    for (auto& v : b.min) a(v);
    for (auto& v : b.max) a(v);
}

template <class Archive, class BlockT>
requires std::is_same_v<std::remove_const_t<BlockT>, GroundBlock>
void fields(Archive& a, BlockT& b) {
    for (auto& v : b.origin) a(v);
    a(b.first_byte), a(b.corners), a(b.triangles), a(b.wide);
}

template <class Archive, class MeshT>
requires std::is_same_v<std::remove_const_t<MeshT>, GroundMesh>
void fields(Archive& a, MeshT& m) {
    vector3(a, m.origin), a(m.step_m);
    for (auto& v : m.min) a(v);
    for (auto& v : m.max) a(v);
    a(m.first_block), a(m.block_count), a(m.first_node);
}

template <class Archive, class InstanceT>
requires std::is_same_v<std::remove_const_t<InstanceT>, GroundInstance>
void fields(Archive& a, InstanceT& i) {
    vector3(a, i.origin);
    for (int column = 0; column < 3; ++column) vector3(a, i.linear[column]);
    a(i.mesh);
}

template <class Archive, class NumberT>
requires std::is_same_v<std::remove_const_t<NumberT>, std::uint32_t>
void fields(Archive& a, NumberT& number) { a(number); }

template <class Archive, class SampleT>
requires std::is_same_v<std::remove_const_t<SampleT>, PathSample>
void fields(Archive& a, SampleT& s) {
    a(s.time_s);
    vector3(a, s.pose.position);
    a(s.pose.orientation.x), a(s.pose.orientation.y), a(s.pose.orientation.z), a(s.pose.orientation.w);
    a(s.pose.fov_y_rad);
}

template <class Archive, class GroundT>
void ground(Archive& a, GroundT& g) {
    a(g.triangles);
    a.list(g.meshes), a.list(g.blocks), a.list(g.boxes), a.list(g.bytes), a.list(g.instances);
}

/// All that is not an array: counts, sun, provenance. Eight spare bytes among them once held the time of the bake.
template <class Archive, class ModelT>
void rest(Archive& a, ModelT& m) {
    a(m.object_count);
    vector3(a, m.sun_direction);
    a(m.names);
    std::uint64_t spare = 0;
    a(m.provenance.quality), a(spare);
    a.list(m.provenance.sources), a.list(m.provenance.warnings);
}

}  // namespace surefoot::model::walk
