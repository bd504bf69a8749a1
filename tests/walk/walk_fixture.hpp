// A small forest, baked once a build (baked_forest.cpp) and copied to a folder of its own that goes away at the end.
#pragma once

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "rt/base/file.hpp"
#include "rt/base/path.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::test {

class Forest {
public:
    static const Forest& get() {
        static const Forest forest;
        return forest;
    }
    std::string dir, model_file, path_file;

    /// A request on the virtual clock without GL: the same numbers on every machine.
    [[nodiscard]] walk::WalkRequest virtual_request(std::uint64_t frames) const {
        walk::WalkRequest r;
        r.model_file = model_file;
        r.path_file = path_file;
        r.backend = "null";
        r.clock = rt::ClockKind::virtual_time;
        r.frames = frames;
        r.state_dir = dir;  // no table there: built-in costs on every machine
        return r;
    }

private:
    Forest() {
        dir = (std::filesystem::temp_directory_path() / ("surefoot-walk-test-" + std::to_string(getpid()))).string();
        std::filesystem::create_directories(dir);
        model_file = dir + "/forest.walk";
        path_file = dir + "/forest.path.csv";
        const std::string baked = shared_folder();
        std::filesystem::copy_file(baked + "/forest.walk", model_file);
        std::filesystem::copy_file(baked + "/forest.path.csv", path_file);
    }
    /// A bake takes seconds: the first program has it baked for all programs of this build. SUREFOOT_BAKED_FOREST names the
    /// baker of another build, so that a build with sanitizers needs none of its own.
    static std::string shared_folder() {
        const char* const other = std::getenv("SUREFOOT_BAKED_FOREST");
        const auto baker = other != nullptr ? std::filesystem::path(other)
                                            : std::filesystem::read_symlink("/proc/self/exe").parent_path() / "baked_forest";
        const auto built = std::filesystem::last_write_time(baker).time_since_epoch().count();
        std::string folder = baker.string() + ".kept";
        const std::string done = folder + "/baked-by-" + std::to_string(built);
        std::filesystem::create_directories(folder);
        const int lock = ::open((folder + "/lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
        EXPECT_EQ(::flock(lock, LOCK_EX), 0);
        if (!std::filesystem::exists(done)) {
            for (const auto& old : std::filesystem::directory_iterator(folder))
                if (old.path().filename() != "lock") std::filesystem::remove(old.path());
            if (std::system(("\"" + baker.string() + "\" \"" + folder + "\"").c_str()) == 0)
                EXPECT_TRUE(write_text(done, "").ok());
            else
                ADD_FAILURE() << baker << " made no forest";
        }
        ::close(lock);
        return folder;
    }
    ~Forest() {
        std::error_code ignored;
        std::filesystem::remove_all(dir, ignored);
    }
};

inline walk::WalkOutcome walk(const walk::WalkRequest& request) {
    auto outcome = walk::run_walk(request, {});
    EXPECT_TRUE(outcome.ok()) << (outcome.ok() ? "" : outcome.error().text());
    return outcome.ok() ? std::move(*outcome) : walk::WalkOutcome{};
}

}  // namespace surefoot::test
