// Writes what the fuzz targets begin with: the smallest file of each kind, and what recordings of devices hold.
// usage: fuzz_seeds FOLDER [RECORDING.hid...]
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>

#include "input/replay/recording.hpp"
#include "rt/base/file.hpp"
#include "tools/selftest/fixtures.hpp"

namespace {

/// What fuzz::reports() takes: the descriptor's length in two bytes, the descriptor, and the first reports, not more than 4 KB.
surefoot::selftest::Bytes reports_of(const surefoot::input::Recording& r) {
    surefoot::selftest::Bytes out{static_cast<std::byte>(r.descriptor.size() & 0xffU),
                                  static_cast<std::byte>(r.descriptor.size() >> 8U)};
    out.insert(out.end(), r.descriptor.begin(), r.descriptor.end());
    const auto shown = static_cast<std::ptrdiff_t>(std::min<std::size_t>(r.bytes.size(), 4096));
    out.insert(out.end(), r.bytes.begin(), r.bytes.begin() + shown);
    return out;
}

}  // namespace

int main(int argc, char** argv) {
    using namespace surefoot;
    if (argc < 2) return std::fputs("usage: fuzz_seeds FOLDER [RECORDING.hid...]\n", stderr), 2;
    const auto put = [&](const char* target, const std::string& name, const selftest::Bytes& bytes) {
        const auto folder = std::filesystem::path(argv[1]) / target;
        std::filesystem::create_directories(folder);
        return write_file((folder / name).string(), bytes).ok();
    };
    const auto walk = selftest::walk_fixture();
    bool fine = walk.ok() && put("fuzz_file_walk", "two", *walk) && put("fuzz_file_gltf", "glb", selftest::glb_fixture()) &&
                put("fuzz_file_settings", "settings", selftest::settings_fixture()) &&
                put("fuzz_file_image", "png", selftest::png_fixture(5, 3)) &&
                put("fuzz_file_image", "jpeg", selftest::jpeg_fixture(17, 9, false)) &&
                put("fuzz_file_image", "progressive", selftest::jpeg_fixture(17, 9, true)) &&
                put("fuzz_file_obj", "obj",
                    selftest::bytes_of("mtllib a.mtl\nv 0 0 0\nv 1 0 0 1\nv 0 1e0 0\nvt 0 .5\nvn 0 0 1\nusemtl a\no b\ng c\n"
                                       "s off\nf 1/1/1 2/1/1 3/1/1\nf -3//-1 -2//-1 -1//-1\n")) &&
                put("fuzz_file_address", "socket", selftest::bytes_of("unix:/run/surefoot/surefoot.sock")) &&
                put("fuzz_file_address", "port", selftest::bytes_of("[::1]:9464"));
    for (int i = 2; i < argc && fine; ++i) {
        const auto text = read_file(argv[i]);
        const auto recording = input::read_recording(argv[i]);
        if (!text || !recording) continue;  // what is refused on purpose is no seed
        const std::string name = std::to_string(i);
        fine = put("fuzz_hid_recording", name, *text) && put("fuzz_hid_descriptor", name, recording->descriptor) &&
               put("fuzz_hid_report", name, reports_of(*recording));
    }
    return fine ? 0 : 1;
}
