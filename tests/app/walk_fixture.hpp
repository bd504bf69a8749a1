// A small forest, baked once a test program, in a folder of its own that goes away at the end.
#pragma once

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <string>

#include "render/bake/bake.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/path.hpp"
#include "tools/app/walk.hpp"
#include "tools/scenes/scenes.hpp"

namespace surefoot::test {

class Forest {
public:
    static const Forest& get() {
        static const Forest forest;
        return forest;
    }
    std::string dir, model_file, path_file;

    /// A request on the virtual clock without GL: the same numbers on every machine.
    [[nodiscard]] app::WalkRequest virtual_request(std::uint64_t frames) const {
        app::WalkRequest r;
        r.model_file = model_file;
        r.path_file = path_file;
        r.backend = "null";
        r.clock = "virtual";
        r.frames = frames;
        r.state_dir = dir;  // no table there: built-in costs on every machine
        return r;
    }

private:
    Forest() {
        dir = (std::filesystem::temp_directory_path() / ("surefoot-app-test-" + std::to_string(getpid()))).string();
        std::filesystem::create_directories(dir);
        model_file = dir + "/forest.walk";
        path_file = dir + "/forest.path.csv";
        auto scene = scenes::generate("forest", 4, 1);
        EXPECT_TRUE(scene.ok());
        auto model = bake::bake(scene->scene, {}, {});
        EXPECT_TRUE(model.ok()) << (model.ok() ? "" : model.error().text());
        auto written = model::write_walk(model_file, *model);
        EXPECT_TRUE(written.ok());
        EXPECT_TRUE(write_path(path_file, scene->path).ok());
    }
    ~Forest() {
        std::error_code ignored;
        std::filesystem::remove_all(dir, ignored);
    }
};

}  // namespace surefoot::test
