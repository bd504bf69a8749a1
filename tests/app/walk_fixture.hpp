// A small forest, baked once a build of the test program and copied to a folder of its own that goes away at the end.
#pragma once

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "render/bake/bake.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
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
        const std::string baked = shared_folder();
        std::filesystem::copy_file(baked + "/forest.walk", model_file);
        std::filesystem::copy_file(baked + "/forest.path.csv", path_file);
    }
    /// Every test is a process of its own, and a bake takes seconds: the first one bakes for all that run this very program.
    static std::string shared_folder() {
        const auto program = std::filesystem::read_symlink("/proc/self/exe");
        const auto built = std::filesystem::last_write_time(program).time_since_epoch().count();
        const std::string folder = program.string() + ".forest";
        const std::string of = std::to_string(built), done = folder + "/baked-by-" + of;
        std::filesystem::create_directories(folder);
        const int lock = ::open((folder + "/lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
        EXPECT_EQ(::flock(lock, LOCK_EX), 0);
        if (!std::filesystem::exists(done)) {
            for (const auto& old : std::filesystem::directory_iterator(folder)) {
                if (old.path().filename().string().starts_with("baked-by-")) std::filesystem::remove(old.path());
            }
            auto scene = scenes::generate("forest", 4, 1);
            EXPECT_TRUE(scene.ok());
            auto model = bake::bake(scene->scene, {}, {});
            EXPECT_TRUE(model.ok()) << (model.ok() ? "" : model.error().text());
            EXPECT_TRUE(model::write_walk(folder + "/forest.walk", *model).ok());
            EXPECT_TRUE(write_path(folder + "/forest.path.csv", scene->path).ok());
            EXPECT_TRUE(write_text(done, "").ok());
        }
        ::close(lock);
        return folder;
    }
    ~Forest() {
        std::error_code ignored;
        std::filesystem::remove_all(dir, ignored);
    }
};

inline app::WalkOutcome walk(const app::WalkRequest& request) {
    auto outcome = app::run_walk(request, {});
    EXPECT_TRUE(outcome.ok()) << (outcome.ok() ? "" : outcome.error().text());
    return outcome.ok() ? std::move(*outcome) : app::WalkOutcome{};
}

}  // namespace surefoot::test
