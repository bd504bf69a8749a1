// Writes what the fuzz targets on files begin with: the smallest file of each kind. usage: fuzz_seeds FOLDER
#include <cstdio>
#include <filesystem>
#include <string>

#include "rt/base/file.hpp"
#include "tools/selftest/fixtures.hpp"

int main(int argc, char** argv) {
    using namespace surefoot;
    if (argc != 2) return std::fputs("usage: fuzz_seeds FOLDER\n", stderr), 2;
    const auto put = [&](const char* target, const char* name, const selftest::Bytes& bytes) {
        const auto folder = std::filesystem::path(argv[1]) / target;
        std::filesystem::create_directories(folder);
        return write_file((folder / name).string(), bytes).ok();
    };
    const auto walk = selftest::walk_fixture();
    const bool fine =
        walk.ok() && put("fuzz_file_walk", "two", *walk) && put("fuzz_file_gltf", "glb", selftest::glb_fixture()) &&
        put("fuzz_file_settings", "settings", selftest::settings_fixture()) &&
        put("fuzz_file_image", "png", selftest::png_fixture(5, 3)) &&
        put("fuzz_file_image", "jpeg", selftest::jpeg_fixture(17, 9, false)) &&
        put("fuzz_file_image", "progressive", selftest::jpeg_fixture(17, 9, true)) &&
        put("fuzz_file_obj", "obj",
            selftest::bytes_of("mtllib a.mtl\nv 0 0 0\nv 1 0 0 1\nv 0 1e0 0\nvt 0 .5\nvn 0 0 1\nusemtl a\no b\ng c\n"
                               "s off\nf 1/1/1 2/1/1 3/1/1\nf -3//-1 -2//-1 -1//-1\n")) &&
        put("fuzz_file_address", "socket", selftest::bytes_of("unix:/run/surefoot/surefoot.sock")) &&
        put("fuzz_file_address", "port", selftest::bytes_of("[::1]:9464"));
    return fine ? 0 : 1;
}
