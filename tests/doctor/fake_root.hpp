// A made-up machine: files below a folder that is removed at the end.
#pragma once

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace surefoot::doctor {

struct FakeFile {
    std::string path, text;
    unsigned mode = 0644;
};
using FakeFiles = std::vector<FakeFile>;

class FakeRoot {
public:
    explicit FakeRoot(const FakeFiles& files = {}) {
        std::string name = (std::filesystem::temp_directory_path() / "surefoot-doctor-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) ADD_FAILURE() << "no temporary folder";
        path_ = name;
        for (const FakeFile& file : files) add(file);
    }
    ~FakeRoot() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    FakeRoot(const FakeRoot&) = delete;
    FakeRoot& operator=(const FakeRoot&) = delete;

    /// A path that ends in '/' is a folder.
    void add(const FakeFile& file) const {
        const std::filesystem::path at = path_ + file.path;
        if (file.path.ends_with('/')) {
            std::filesystem::create_directories(at);
            return;
        }
        std::filesystem::create_directories(at.parent_path());
        std::ofstream(at) << file.text;
        chmod(at.c_str(), file.mode);
    }
    [[nodiscard]] const std::string& path() const { return path_; }

private:
    std::string path_;
};

}  // namespace surefoot::doctor
