// A device is opened while other threads run: it must leave the environment, which they may be reading, as it is.
#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "render/gl/device.hpp"

namespace surefoot {
namespace {

std::vector<std::string> environment() {
    std::vector<std::string> all;
    for (char** entry = environ; *entry != nullptr; ++entry) all.emplace_back(*entry);
    return all;
}

TEST(Environment, opening_a_device_changes_nothing_in_it) {
    for (const gl::BackendKind kind : {gl::BackendKind::egl, gl::BackendKind::osmesa, gl::BackendKind::null}) {
        gl::DeviceOptions options;
        options.kind = kind;
        options.viewport = {16, 16};
        options.rasterisers = 3;
        const auto before = environment();
        (void)gl::open_device(options);  // whether or not it opens here
        EXPECT_EQ(environment(), before);
    }
}

TEST(Environment, preparing_the_process_returns_how_many_rasterisers) {
    const char* before = std::getenv("LP_NUM_THREADS");
    const std::string was = before != nullptr ? before : "";
    gl::prepare_process(3);
    EXPECT_STREQ(std::getenv("LP_NUM_THREADS"), "3");
    gl::prepare_process(0);
    EXPECT_EQ(std::getenv("LP_NUM_THREADS"), std::to_string(gl::effective_rasterisers(0)));
    if (was.empty())
        unsetenv("LP_NUM_THREADS");
    else
        setenv("LP_NUM_THREADS", was.c_str(), 1);
}

}  // namespace
}  // namespace surefoot
