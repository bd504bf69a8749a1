// Making, holding and resealing the fixtures (fixtures.hpp).
#include "tools/selftest/fixtures.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>
#include <jpeglib.h>

#include "render/import/ostf.hpp"
#include "render/measure/calibrate.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "rt/base/hash.hpp"
#include "tools/selftest/shapes.hpp"

namespace surefoot::selftest {

namespace {

/// A folder of its own that goes with it, for the writers that want a place on disk.
class Scratch {
public:
    Scratch() : path_((std::filesystem::temp_directory_path() / "surefoot-selftest-XXXXXX").string()) {
        if (::mkdtemp(path_.data()) == nullptr) path_.clear();
    }
    ~Scratch() {
        std::error_code ignored;
        if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }

private:
    std::string path_;
};

importer::Scene two_triangles() {
    importer::Scene scene = scene_of(triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5F}}, {0, 1, 2, 1, 3, 2}));
    place(scene, triangles({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {0, 1, 2}), "other", moved({5, 0, 0}));
    return scene;
}

template <class T>
void put(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
T take(const Bytes& bytes, std::size_t at) {
    T value{};
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

void overwrite(Bytes& bytes, std::size_t at, std::uint64_t value) { std::memcpy(bytes.data() + at, &value, sizeof value); }

}  // namespace

MemoryFile::MemoryFile() : fd_(::memfd_create("surefoot-selftest", MFD_CLOEXEC)) { name_ = fmt::format("/proc/self/fd/{}", fd_); }

MemoryFile::~MemoryFile() {
    if (fd_ >= 0) ::close(fd_);
}

bool MemoryFile::set(std::span<const std::byte> bytes) {
    return ::ftruncate(fd_, 0) == 0 && ::pwrite(fd_, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size());
}

Bytes bytes_of(std::string_view text) {
    const auto view = std::as_bytes(std::span<const char>(text.data(), text.size()));
    return {view.begin(), view.end()};
}

Result<Bytes> walk_fixture() {
    const Scratch scratch;
    auto model = import_and_bake(two_triangles());
    if (!model) return model.error();
    model->provenance.sources = {"by hand"};
    model->tour.samples.resize(3);  // so that every byte of the file can be tried
    if (auto written = model::write_walk(scratch.file("m.walk"), *model); !written) return written.error();
    return read_file(scratch.file("m.walk"));
}

Result<Bytes> ostf_fixture() {
    const Scratch scratch;
    auto scene = two_triangles();
    scene.materials.emplace_back();
    for (importer::Mesh& mesh : scene.meshes) {
        for (importer::Primitive& p : mesh.primitives) importer::clean(p, mesh.name, scene.warnings);
    }
    if (auto written = importer::write_ostf(scratch.file("m.ostf"), scene, {}); !written) return written.error();
    return read_file(scratch.file("m.ostf"));
}

Bytes glb_fixture() {
    std::string bin;
    for (const float v : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) put(bin, v);
    for (const unsigned i : {0U, 1U, 2U, 0U}) put(bin, static_cast<std::uint16_t>(i));
    std::string json =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"name":"a","children":[1]},)"
        R"({"mesh":0,"translation":[5,0,0],"rotation":[0,0,0,1],"scale":[1,2,1]}],"materials":[{"pbrMetallicRoughness":)"
        R"({"baseColorFactor":[1,0,0,1]},"doubleSided":true}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,)"
        R"("material":0}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,)"
        R"("componentType":5123,"count":3,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,)"
        R"("byteOffset":36,"byteLength":6}],"buffers":[{"byteLength":44}]})";
    while (json.size() % 4 != 0) json += ' ';
    std::string body;
    put(body, static_cast<std::uint32_t>(json.size()));
    body += "JSON" + json;
    put(body, static_cast<std::uint32_t>(bin.size()));
    body += std::string("BIN\0", 4) + bin;
    std::string file = "glTF";
    put(file, std::uint32_t{2});
    put(file, static_cast<std::uint32_t>(12 + body.size()));
    return bytes_of(file + body);
}

Bytes path_fixture() {
    std::string text = "# time_s,x,y,z,qx,qy,qz,qw,fov_y_deg\n";
    for (int i = 0; i < 20; ++i)
        text += fmt::format("{},{},1.7,{},0,{},0,{},60\n", 0.5 * i, 0.1 * i, -0.2 * i, 0.01 * i, 1 - 0.001 * i);
    return bytes_of(text);
}

Result<Bytes> costs_fixture() {
    const Scratch scratch;
    model::CostModel costs;
    costs.grids.push_back({0, 3, 4, {}});
    costs.grids.push_back({model::effect_sun, 2, 2, {}});
    for (model::CostGrid& grid : costs.grids) {
        for (std::uint32_t i = 0; i < grid.triangle_steps * grid.pixel_steps; ++i)
            grid.cells.push_back({1.0F + static_cast<float>(i), 2.0F + static_cast<float>(i)});
    }
    costs.machine = "by hand";
    if (auto written = measure::write_costs(scratch.file("costs.toml"), costs); !written) return written.error();
    return read_file(scratch.file("costs.toml"));
}

Bytes settings_fixture() {
    return bytes_of(
        "model = \"town.walk\"\nrate_hz = 59.94\nbudget_ms = 12.5\nwidth = 1280\nheight = 720\nselector = \"two-stage\"\nlate = "
        "\"float\"\n"
        "fifo = false\nworkers = 2\n[profile.kiosk]\nrate_hz = 30\nstrict = true\n");
}

Bytes recording_fixture() {
    // A pad of two axes up to 200, whose reports say more, and of eight buttons.
    std::string text =
        "# by hand\nD: 0\nR: 44 05 01 09 04 a1 01 15 00 26 c8 00 75 08 95 02 09 30 09 31 81 02 05 09 19 01 29 08 15 00 25 01 75 "
        "01 95 08 81 02 c0 00 00 00 00 00 00\nN: pad\nP: usb-1\nI: 3 046d c626\n";
    for (int i = 0; i < 40; ++i)
        text += fmt::format("E: 00000{}.{:06} 3 {:02x} {:02x} {:02x}\n", i / 10, 16000 * i % 1000000, 6 * i, 255 - i, i % 4);
    return bytes_of(text);
}

void reseal_walk(Bytes& bytes) {
    constexpr std::size_t header = 56, entry = 20;
    if (bytes.size() < header) return;
    const std::size_t sections = take<std::uint32_t>(bytes, 12);
    if (sections > (bytes.size() - header) / entry) return;
    const std::size_t table = entry * sections;
    const std::span<const std::byte> all(bytes);
    const std::size_t at_table = bytes.size() - table;
    const auto pages = take<std::uint64_t>(bytes, 24);
    if (pages > at_table - header) return;
    std::size_t at = header + pages;
    for (std::size_t i = 0; i < sections; ++i) {
        const auto size = take<std::uint64_t>(bytes, at_table + entry * i + 4);
        if (size > at_table - at) return;
        overwrite(bytes, at_table + entry * i + 12, hash_bytes(all.subspan(at, size)));
        at += size;
    }
    overwrite(bytes, 16, bytes.size());
    overwrite(bytes, 32, hash_bytes(all.last(table)));
    overwrite(bytes, 48, hash_bytes(all.first(48)));
}

void reseal_costs(Bytes& bytes) {
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t line = text.find('\n');
    if (line == std::string::npos) return;
    const std::string body = text.substr(line + 1);
    bytes = bytes_of(fmt::format("hash = \"{:016x}\"\n", hash_bytes(std::as_bytes(std::span<const char>(body)))) + body);
}

Bytes png_fixture(std::uint32_t width, std::uint32_t height) {
    std::vector<std::uint8_t> texels(4ULL * width * height);
    for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = static_cast<std::uint8_t>(i * 37);
    const std::vector<std::uint8_t> png = image::encode_png(width, height, texels);
    const auto view = std::as_bytes(std::span(png));
    return {view.begin(), view.end()};
}

Bytes jpeg_fixture(std::uint32_t width, std::uint32_t height, bool progressive) {
    jpeg_compress_struct jpeg{};
    jpeg_error_mgr errors{};
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    unsigned char* data = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&jpeg, &data, &size);
    jpeg.image_width = width;
    jpeg.image_height = height;
    jpeg.input_components = 3;
    jpeg.in_color_space = JCS_RGB;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, 60, TRUE);
    if (progressive) jpeg_simple_progression(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    std::vector<std::uint8_t> row(3ULL * width);
    while (jpeg.next_scanline < jpeg.image_height) {
        for (std::size_t i = 0; i < row.size(); ++i) row[i] = static_cast<std::uint8_t>(i * 37 + jpeg.next_scanline * 11);
        JSAMPROW pointer = row.data();
        jpeg_write_scanlines(&jpeg, &pointer, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    const auto view = std::as_bytes(std::span(data, size));
    Bytes out(view.begin(), view.end());
    std::free(data);
    return out;
}

}  // namespace surefoot::selftest
