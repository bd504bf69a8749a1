// A made-up machine: files below a folder that is removed at the end.
#pragma once

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/temporary_folder.hpp"

namespace surefoot::doctor {

struct FakeFile {
    std::string path, text;
    unsigned mode = 0644;
};
using FakeFiles = std::vector<FakeFile>;

class FakeRoot {
public:
    explicit FakeRoot(const FakeFiles& files = {}) {
        for (const FakeFile& file : files) add(file);
    }

    /// A path that ends in '/' is a folder.
    void add(const FakeFile& file) const {
        const std::filesystem::path at = path() + file.path;
        if (file.path.ends_with('/')) {
            std::filesystem::create_directories(at);
            return;
        }
        std::filesystem::create_directories(at.parent_path());
        std::ofstream(at) << file.text;
        chmod(at.c_str(), file.mode);
    }
    [[nodiscard]] const std::string& path() const { return folder_.path(); }

private:
    test::TemporaryFolder folder_;
};

}  // namespace surefoot::doctor
