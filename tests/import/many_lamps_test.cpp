// A glTF file of a million lamps is read within bounds of time and memory, and the brightest lamps are kept. For the night.
#include <gtest/gtest.h>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include <fmt/format.h>

#include "tests/import/fixtures.hpp"

namespace surefoot::importer::test {
namespace {

/// So many lamps, each a light and a node of its own. Every 500th is ten times as bright.
std::string file_of_lamps(int count) {
    TriangleGltf gltf;
    std::string lights;
    gltf.nodes = R"([{"mesh":0,"name":"thing"})";
    gltf.scenes = R"([{"nodes":[0)";
    for (int i = 0; i < count; ++i) {
        lights += fmt::format(R"({}{{"type":"point","intensity":{}}})", i == 0 ? "" : ",", i % 500 == 0 ? 10 : 1);
        gltf.nodes += fmt::format(R"(,{{"extensions":{{"KHR_lights_punctual":{{"light":{}}}}}}})", i);
        gltf.scenes += fmt::format(",{}", i + 1);
    }
    gltf.nodes += "]";
    gltf.scenes += "]}]";
    gltf.more = R"(,"extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[)" + lights + "]}}";
    return gltf.file();
}

/// Bytes of address space that this process has.
std::size_t space_so_far() {
    std::ifstream status("/proc/self/statm");
    std::size_t pages = 0;
    status >> pages;
    return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// In a child that may take so much memory and CPU time: 0 where the file is read, and has its brightest lamps alone.
int read_lamps_within(std::size_t room, rlim_t seconds, const std::string& file, std::size_t bright) {
    const pid_t child = fork();
    if (child == 0) {
        const rlimit space{space_so_far() + room, space_so_far() + room}, time{seconds, seconds};
        if (setrlimit(RLIMIT_AS, &space) != 0 || setrlimit(RLIMIT_CPU, &time) != 0) _exit(10);
        const auto scene = import_files({file}, {});
        if (!scene.ok()) _exit(11);
        std::size_t found = 0;
        for (const Lamp& lamp : scene->lamps) found += lamp.candela == 10 ? 1 : 0;
        if (scene->lamps.size() != max_lamps || found != bright) _exit(12);
        _exit(warns(*scene, "995904 lamps are left out") && scene->triangles() == 1 ? 0 : 13);
    }
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(MillionLamps, InAFileAreLimitedInBoundedTimeAndMemory) {
#ifdef SUREFOOT_SANITIZED
    GTEST_SKIP() << "the sanitizers need the address space that this test takes away";
#endif
    const Folder folder;
    constexpr std::size_t million = 1'000'000, bytes_a_lamp = 6'000;
    std::string text = file_of_lamps(million);
    const std::string file = folder.write("lamps.glb", text);
    std::string().swap(text);
    EXPECT_EQ(read_lamps_within(million * bytes_a_lamp, 60, file, million / 500), 0);
}

}  // namespace
}  // namespace surefoot::importer::test
