// From bytes to tinygltf's structures: first the checks that tinygltf 2.7 does not make, then tinygltf.
#include "render/import/gltf_parts.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "rt/base/file.hpp"
#include "rt/base/reader.hpp"

namespace surefoot::importer {
namespace {

using nlohmann::json;

/// tinygltf copies extras by recursion: deeper files would run out of stack. Real ones stay below 20.
constexpr int deepest_json = 100;
constexpr std::uint32_t glb_magic = 0x46546c67, json_chunk = 0x4e4f534a, bin_chunk = 0x004e4942;
constexpr std::size_t glb_json_at = 20;  ///< behind the header and the head of the first chunk

struct Text {
    std::span<const std::byte> json;
    std::uint64_t bin_bytes = 0;
    bool binary = false;
};

bool is_glb(std::span<const std::byte> bytes) { return bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0; }

/// The container as glTF 2.0 section 4.4 describes it. tinygltf 2.7 forgets the second chunk's own header when it
/// compares lengths, and so reads 8 bytes beyond the end.
Result<Text> split_glb(std::span<const std::byte> bytes, const std::string& file) {
    ByteReader reader(bytes);
    const auto magic = reader.read<std::uint32_t>();
    const auto version = reader.read<std::uint32_t>();
    const auto length = reader.read<std::uint32_t>();
    const auto json_bytes = reader.read<std::uint32_t>();
    const auto json_kind = reader.read<std::uint32_t>();
    if (reader.failed() || magic != glb_magic)
        return Error{file, "The GLB header is truncated", export_again, ErrorKind::damaged};
    if (version != 2)
        return Error{file, fmt::format("The GLB has version {}; only 2 is read", version), "Convert it to glTF 2.0",
                     ErrorKind::unsupported};
    if (length > bytes.size())
        return Error{file, fmt::format("The file is truncated: {} bytes of {}", bytes.size(), length), export_again,
                     ErrorKind::damaged};
    Text text;
    text.binary = true;
    text.json = reader.bytes(json_bytes);
    if (reader.failed() || json_kind != json_chunk || reader.at() > length)
        return Error{file, "The first GLB chunk is not whole JSON", export_again, ErrorKind::damaged};
    if (reader.at() == length) return text;
    text.bin_bytes = reader.read<std::uint32_t>();
    const auto bin_kind = reader.read<std::uint32_t>();
    if (reader.failed() || reader.at() + text.bin_bytes > length) {
        return Error{
            file, fmt::format("The file is truncated: the GLB chunk at byte {} reaches beyond the end", glb_json_at + json_bytes),
            export_again, ErrorKind::damaged};
    }
    if (bin_kind != bin_chunk) return Error{file, "The second GLB chunk is not binary data", export_again, ErrorKind::damaged};
    return text;
}

int depth_of(std::span<const std::byte> bytes) {
    int depth = 0, deepest = 0;
    bool quoted = false, escaped = false;
    for (const std::byte b : bytes) {
        const char c = static_cast<char>(b);
        if (quoted) {
            quoted = escaped || c != '"';
            escaped = !escaped && c == '\\';
        } else if (c == '"') {
            quoted = true;
        } else if (c == '{' || c == '[') {
            deepest = std::max(deepest, ++depth);
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
    return deepest;
}

std::uint64_t number_in(const json& object, const char* key, std::uint64_t otherwise) {
    if (!object.is_object()) return otherwise;
    const auto found = object.find(key);
    return found != object.end() && found->is_number_unsigned() ? found->get<std::uint64_t>() : otherwise;
}

const json& array_in(const json& root, const char* key) {
    static const json empty = json::array();
    const auto found = root.find(key);
    return found != root.end() && found->is_array() ? *found : empty;
}

bool is_of_sound(const std::string& extension) {
    static constexpr std::array known{"KHR_audio", "KHR_audio_emitter", "KHR_audio_graph", "MSFT_audio_emitter",
                                      "OMI_audio_emitter"};
    return std::find(known.begin(), known.end(), extension) != known.end();
}

/// A warning that names the extensions by which the file has sounds, if it has any: used, required, or there without a word.
void warn_of_sound(const json& root, std::vector<std::string>& warnings) {
    std::set<std::string> names;
    for (const char* list : {"extensionsUsed", "extensionsRequired"})
        for (const json& entry : array_in(root, list))
            if (entry.is_string() && is_of_sound(entry.get_ref<const std::string&>())) names.insert(entry.get<std::string>());
    if (const auto own = root.find("extensions"); own != root.end() && own->is_object())
        for (const auto& [name, value] : own->items())
            if (is_of_sound(name)) names.insert(name);
    if (!names.empty())
        warnings.push_back(
            fmt::format("Sounds are left out ({}). Let another program play them beside the walk", fmt::join(names, ", ")));
}

Result<void> check_extensions(const json& root, const std::string& file, std::vector<std::string>& warnings) {
    warn_of_sound(root, warnings);
    static constexpr std::array known{"KHR_materials_unlit",
                                      "KHR_texture_transform",
                                      "KHR_mesh_quantization",
                                      "EXT_mesh_gpu_instancing",
                                      "KHR_lights_punctual",
                                      "KHR_materials_pbrSpecularGlossiness",
                                      "KHR_materials_emissive_strength",
                                      "MSFT_lod"};
    for (const json& entry : array_in(root, "extensionsRequired")) {
        if (!entry.is_string()) continue;
        const auto& name = entry.get_ref<const std::string&>();
        if (name.find("draco") != std::string::npos || name.find("meshopt") != std::string::npos) {
            return Error{file, fmt::format("The file is compressed with {}", name),
                         "Decompress it (gltf-transform copy, or gltfpack -noq)", ErrorKind::unsupported};
        }
        if (std::find(known.begin(), known.end(), name) == known.end() && !is_of_sound(name))
            warnings.push_back(fmt::format("Extension {} is required but ignored", name));
    }
    return {};
}

/// tinygltf takes the address of an image's bytes unchecked.
Result<void> check_image_views(const json& root, const std::string& file) {
    constexpr auto absent = std::numeric_limits<std::uint64_t>::max();
    const json &views = array_in(root, "bufferViews"), &buffers = array_in(root, "buffers");
    std::size_t index = 0;
    for (const json& image : array_in(root, "images")) {
        const std::size_t at = index++;
        if (!image.is_object() || !image.contains("bufferView")) continue;
        const std::uint64_t view = number_in(image, "bufferView", absent);
        const std::uint64_t buffer = view < views.size() ? number_in(views[view], "buffer", absent) : absent;
        const std::uint64_t size = buffer < buffers.size() ? number_in(buffers[buffer], "byteLength", 0) : 0;
        const std::uint64_t offset = buffer < buffers.size() ? number_in(views[view], "byteOffset", 0) : 0;
        const std::uint64_t length = buffer < buffers.size() ? number_in(views[view], "byteLength", absent) : absent;
        if (offset >= size || length > size - offset)
            return Error{file, fmt::format("Image {} lies outside its buffer", at), export_again, ErrorKind::damaged};
    }
    return {};
}

/// What tinygltf's file callbacks need to know: external files may be longer than byteLength (glTF 2.0, 5.10), tinygltf
/// wants them equal.
struct Files {
    std::string folder;
    std::map<std::string, std::uint64_t> wanted_bytes;  ///< by file name
};

Files external_files(const json& root, const std::string& file) {
    Files files{std::filesystem::path(file).parent_path().string(), {}};
    for (const json& buffer : array_in(root, "buffers")) {
        if (!buffer.is_object() || !buffer.contains("uri") || !buffer["uri"].is_string()) continue;
        const std::string name = decode_uri(buffer["uri"].get<std::string>());
        if (!name.starts_with("data:")) files.wanted_bytes[name] = number_in(buffer, "byteLength", 0);
    }
    return files;
}

/// Only names that a buffer refers to, only in the folder of the file: tinygltf would also look in the working directory.
bool wanted_file(const std::string& path, void* user) {
    const auto* files = static_cast<const Files*>(user);
    return std::any_of(files->wanted_bytes.begin(), files->wanted_bytes.end(), [&](const auto& entry) {
        const std::string full = files->folder.empty() ? entry.first : files->folder + "/" + entry.first;
        return path == full && std::filesystem::is_regular_file(path);
    });
}

bool read_wanted(std::vector<unsigned char>* out, std::string* error, const std::string& path, void* user) {
    const auto* files = static_cast<const Files*>(user);
    auto bytes = read_file(path);
    if (!bytes) {
        *error += bytes.error().text();
        return false;
    }
    std::uint64_t keep = bytes->size();
    for (const auto& [name, wanted] : files->wanted_bytes) {
        if (path.ends_with(name)) keep = std::min<std::uint64_t>(keep, wanted);
    }
    out->resize(keep);
    std::memcpy(out->data(), bytes->data(), keep);
    return true;
}

bool keep_encoded(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes, int size,
                  void*) {
    image->as_is = true;
    if (image->bufferView < 0 && size > 0) image->image.assign(bytes, bytes + size);
    return true;
}

/// Where the first buffer that is missing should be; none: tinygltf complains of something else.
std::optional<std::string> missing_buffer(Files& files) {
    for (const auto& [name, bytes] : files.wanted_bytes) {
        const std::string path = files.folder.empty() ? name : files.folder + "/" + name;
        if (!wanted_file(path, &files)) return path;
    }
    return std::nullopt;
}

/// At most 160 bytes: tinygltf quotes whole data URIs.
std::string one_line(std::string text) {
    if (text.size() > 160) text = text.substr(0, 157) + "...";
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    std::replace(text.begin(), text.end(), '\n', ';');
    return text;
}

Result<tinygltf::Model> run_tinygltf(std::span<const std::byte> bytes, bool binary, Files& files, const std::string& file,
                                     std::vector<std::string>& warnings) {
    tinygltf::TinyGLTF reader;
    reader.SetImageLoader(keep_encoded, nullptr);
    tinygltf::FsCallbacks callbacks{};
    callbacks.FileExists = wanted_file;
    callbacks.ExpandFilePath = [](const std::string& path, void*) { return path; };
    callbacks.ReadWholeFile = read_wanted;
    callbacks.user_data = &files;
    reader.SetFsCallbacks(callbacks);
    tinygltf::Model model;
    std::string errors, notes;
    const auto size = static_cast<unsigned>(bytes.size());
    const bool good = binary
                          ? reader.LoadBinaryFromMemory(&model, &errors, &notes,
                                                        reinterpret_cast<const unsigned char*>(bytes.data()), size, files.folder)
                          : reader.LoadASCIIFromString(&model, &errors, &notes, reinterpret_cast<const char*>(bytes.data()), size,
                                                       files.folder);
    const std::optional<std::string> missing = good ? std::nullopt : missing_buffer(files);
    if (missing)
        return Error{file, fmt::format("The buffer '{}' is missing", *missing), "Put it there, or export the model again",
                     ErrorKind::damaged};
    if (!good)
        return Error{file,
                     errors.empty() ? "The file is not a glTF file" : "The glTF reader refuses the file: " + one_line(errors),
                     export_again, ErrorKind::damaged};
    if (!errors.empty()) warnings.push_back("The glTF reader dropped something: " + one_line(errors));
    return model;
}

/// at: the byte of the JSON, counted from 1, where its grammar ends. In a glTF file the place is a line, in a GLB the byte.
Error wrong_json(const std::string& file, const Text& text, std::size_t at) {
    const std::string_view written(reinterpret_cast<const char*>(text.json.data()), text.json.size());
    const std::size_t first = written.find_first_not_of("\xef\xbb\xbf \t\r\n");
    if (!text.binary && (first == std::string_view::npos || written[first] != '{'))
        return {file, "The file is not a glTF file: it begins neither with 'glTF' nor with '{'", "Export the model as glTF 2.0",
                ErrorKind::damaged};
    if (text.binary)
        return {file, fmt::format("The JSON is truncated or wrong at byte {} of the file", glb_json_at + at), export_again,
                ErrorKind::damaged};
    const auto line =
        1 + std::count(written.begin(), written.begin() + static_cast<std::ptrdiff_t>(std::min(at, written.size())), '\n');
    return {fmt::format("{}:{}", file, line), fmt::format("The JSON is truncated or wrong at byte {} of the file", at),
            export_again, ErrorKind::damaged};
}

Result<tinygltf::Model> load_checked(const std::string& file, std::vector<std::string>& warnings) {
    auto bytes = read_file(file);
    if (!bytes) return bytes.error();
    if (bytes->size() >= std::numeric_limits<std::uint32_t>::max())
        return Error{file, "The file is larger than 4 GiB, the limit of glTF", "Split the model", ErrorKind::out_of_limits};
    Text text{*bytes, 0, is_glb(*bytes)};
    if (text.binary) {
        auto split = split_glb(*bytes, file);
        if (!split) return split.error();
        text = *split;
    }
    if (depth_of(text.json) > deepest_json)
        return Error{file, fmt::format("The JSON is nested deeper than {}", deepest_json), export_again,
                     ErrorKind::out_of_limits};
    const auto* first = reinterpret_cast<const char*>(text.json.data());
    json root;
    try {
        root = json::parse(first, first + text.json.size());
    } catch (const json::parse_error& trouble) {
        return wrong_json(file, text, trouble.byte);
    }
    if (!root.is_object())
        return Error{file, "The file is not a glTF file: its JSON is no object", export_again, ErrorKind::damaged};
    if (auto readable = check_extensions(root, file, warnings); !readable) return readable.error();
    if (auto inside = check_image_views(root, file); !inside) return inside.error();
    Files files = external_files(root, file);
    return run_tinygltf(*bytes, text.binary, files, file, warnings);
}

}  // namespace

std::string decode_uri(const std::string& uri) {
    std::string out;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        unsigned value = 0;
        if (uri[i] == '%' && i + 2 < uri.size() && std::sscanf(uri.c_str() + i + 1, "%2x", &value) == 1) {
            out += static_cast<char>(value);
            i += 2;
        } else {
            out += uri[i];
        }
    }
    return out;
}

Result<tinygltf::Model> load_gltf(const std::string& file, std::vector<std::string>& warnings) {
    try {
        return load_checked(file, warnings);
    } catch (const json::exception& trouble) {
        return Error{file, fmt::format("The JSON is truncated or wrong: {}", trouble.what()), export_again, ErrorKind::damaged};
    } catch (const std::exception& trouble) {
        return Error{file, fmt::format("The glTF reader failed: {}", trouble.what()), export_again, ErrorKind::damaged};
    }
}

}  // namespace surefoot::importer
