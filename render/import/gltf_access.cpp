// Reads glTF accessors as flat arrays, every offset, stride, count and sparse index checked (tinygltf checks none).
#include "render/import/gltf_parts.hpp"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

namespace surefoot::importer {
namespace {

/// An accessor without a view is all zeros and has no bytes to bound its count: more than this is a mistake.
constexpr std::uint64_t max_implicit_elements = 1U << 24U;

Error bad_accessor(const std::string& place, int accessor, std::string what) {
    return Error{place, fmt::format("Accessor {} {}", accessor, what), export_again, ErrorKind::damaged};
}

std::size_t component_bytes(int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            return 0;
    }
}

std::size_t components_of(int type) {
    switch (type) {
        case TINYGLTF_TYPE_SCALAR:
            return 1;
        case TINYGLTF_TYPE_VEC2:
            return 2;
        case TINYGLTF_TYPE_VEC3:
            return 3;
        case TINYGLTF_TYPE_VEC4:
            return 4;
        default:
            return 0;
    }
}

template <class T>
T load(const unsigned char* from) {
    T value;
    std::memcpy(&value, from, sizeof(T));
    return value;
}

float as_float(const unsigned char* from, int type, bool normalized) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE: {
            const auto v = static_cast<float>(load<std::int8_t>(from));
            return normalized ? std::max(v / 127.0F, -1.0F) : v;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return static_cast<float>(*from) / (normalized ? 255.0F : 1.0F);
        case TINYGLTF_COMPONENT_TYPE_SHORT: {
            const auto v = static_cast<float>(load<std::int16_t>(from));
            return normalized ? std::max(v / 32767.0F, -1.0F) : v;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return static_cast<float>(load<std::uint16_t>(from)) / (normalized ? 65535.0F : 1.0F);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return static_cast<float>(load<std::uint32_t>(from));
        default:
            return load<float>(from);
    }
}

std::uint32_t as_index(const unsigned char* from, int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return *from;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return load<std::uint16_t>(from);
        default:
            return load<std::uint32_t>(from);
    }
}

struct Bytes {
    const unsigned char* data = nullptr;  ///< null: all zeros
    std::size_t stride = 0;
};

/// `count` elements of `element` bytes at `offset` of a view lie inside the view, and the view inside its buffer.
Result<Bytes> locate(const tinygltf::Model& model, int view_index, std::uint64_t offset, std::uint64_t count,
                     std::uint64_t element, bool may_stride, const std::string& place, int accessor) {
    if (view_index < 0 || static_cast<std::size_t>(view_index) >= model.bufferViews.size())
        return bad_accessor(place, accessor, "names a buffer view that does not exist");
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(view_index)];
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model.buffers.size())
        return bad_accessor(place, accessor, "names a buffer that does not exist");
    const std::vector<unsigned char>& buffer = model.buffers[static_cast<std::size_t>(view.buffer)].data;
    if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
        return bad_accessor(
            place, accessor,
            fmt::format("uses buffer view {}, which reaches beyond its buffer of {} bytes", view_index, buffer.size()));
    }
    const std::uint64_t stride = may_stride && view.byteStride != 0 ? view.byteStride : element;
    if (stride < element)
        return bad_accessor(place, accessor, fmt::format("has a stride of {} bytes for elements of {}", stride, element));
    const bool starts_inside = offset <= view.byteLength && element <= view.byteLength - offset;
    if (count > 0 && (!starts_inside || count - 1 > (view.byteLength - offset - element) / stride)) {
        return bad_accessor(place, accessor, fmt::format("has {} elements that reach beyond buffer view {}", count, view_index));
    }
    return Bytes{buffer.data() + view.byteOffset + offset, stride};
}

struct Located {
    const tinygltf::Accessor* accessor = nullptr;
    Bytes bytes;
    std::size_t components = 0, component_size = 0;
};

Result<Located> locate_accessor(const tinygltf::Model& model, int index, const std::string& place) {
    if (index < 0 || static_cast<std::size_t>(index) >= model.accessors.size())
        return bad_accessor(place, index, "does not exist");
    Located found;
    found.accessor = &model.accessors[static_cast<std::size_t>(index)];
    found.components = components_of(found.accessor->type);
    found.component_size = component_bytes(found.accessor->componentType);
    if (found.components == 0 || found.component_size == 0) return bad_accessor(place, index, "has an unsupported type");
    if (found.accessor->bufferView < 0) {
        if (found.accessor->count > max_implicit_elements)
            return bad_accessor(place, index, fmt::format("has {} elements without data", found.accessor->count));
        return found;
    }
    auto bytes = locate(model, found.accessor->bufferView, found.accessor->byteOffset, found.accessor->count,
                        found.components * found.component_size, true, place, index);
    if (!bytes) return bytes.error();
    found.bytes = *bytes;
    return found;
}

/// Calls put(element, bytes) for each sparse element (glTF 2.0, 3.6.2.3).
template <class Put>
Result<void> apply_sparse(const tinygltf::Model& model, const Located& found, int index, const std::string& place,
                          const Put& put) {
    const auto& sparse = found.accessor->sparse;
    if (!sparse.isSparse) return {};
    if (sparse.count < 0 || static_cast<std::size_t>(sparse.count) > found.accessor->count || sparse.indices.byteOffset < 0 ||
        sparse.values.byteOffset < 0) {
        return bad_accessor(place, index, "has a sparse count or offset out of range");
    }
    const auto count = static_cast<std::uint64_t>(sparse.count);
    const int type = sparse.indices.componentType;
    if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
        return bad_accessor(place, index, "has sparse indices that are not unsigned integers");
    }
    auto where = locate(model, sparse.indices.bufferView, static_cast<std::uint64_t>(sparse.indices.byteOffset), count,
                        component_bytes(type), false, place, index);
    if (!where) return where.error();
    const std::size_t element = found.components * found.component_size;
    auto values = locate(model, sparse.values.bufferView, static_cast<std::uint64_t>(sparse.values.byteOffset), count, element,
                         false, place, index);
    if (!values) return values.error();
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint32_t at = as_index(where->data + i * where->stride, type);
        if (at >= found.accessor->count)
            return bad_accessor(place, index, fmt::format("has the sparse index {} of {} elements", at, found.accessor->count));
        put(at, values->data + i * values->stride);
    }
    return {};
}

}  // namespace

Result<FloatArray> read_floats(const tinygltf::Model& model, int accessor, const std::string& place) {
    auto found = locate_accessor(model, accessor, place);
    if (!found) return found.error();
    FloatArray out;
    out.components = found->components;
    out.values.resize(found->accessor->count * found->components);
    const int type = found->accessor->componentType;
    const auto put = [&](std::size_t element, const unsigned char* bytes) {
        float* to = out.values.data() + element * found->components;
        for (std::size_t c = 0; c < found->components; ++c)
            to[c] = as_float(bytes + c * found->component_size, type, found->accessor->normalized);
    };
    if (found->bytes.data != nullptr) {
        for (std::size_t i = 0; i < found->accessor->count; ++i) put(i, found->bytes.data + i * found->bytes.stride);
    }
    if (auto sparse = apply_sparse(model, *found, accessor, place, put); !sparse) return sparse.error();
    return out;
}

Result<std::vector<std::uint32_t>> read_indices(const tinygltf::Model& model, int accessor, const std::string& place) {
    auto found = locate_accessor(model, accessor, place);
    if (!found) return found.error();
    const int type = found->accessor->componentType;
    const bool is_unsigned = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                             type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (found->components != 1 || !is_unsigned) return bad_accessor(place, accessor, "has indices that are not unsigned scalars");
    std::vector<std::uint32_t> out(found->accessor->count, 0);
    const auto put = [&](std::size_t element, const unsigned char* bytes) { out[element] = as_index(bytes, type); };
    if (found->bytes.data != nullptr) {
        for (std::size_t i = 0; i < out.size(); ++i) put(i, found->bytes.data + i * found->bytes.stride);
    }
    if (auto sparse = apply_sparse(model, *found, accessor, place, put); !sparse) return sparse.error();
    return out;
}

}  // namespace surefoot::importer
