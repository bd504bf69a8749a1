// Small files of every kind that is read, made afresh by the writers, and bytes as a file without a disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "rt/base/result.hpp"

namespace surefoot::selftest {

using Bytes = std::vector<std::byte>;
constexpr std::size_t max_fixture_bytes = 4096;

/// A file in memory with a name that readers can open.
class MemoryFile {
public:
    MemoryFile();
    ~MemoryFile();
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    [[nodiscard]] bool ok() const { return fd_ >= 0; }
    [[nodiscard]] const std::string& name() const { return name_; }
    bool set(std::span<const std::byte> bytes);

private:
    int fd_ = -1;
    std::string name_;
};

Bytes bytes_of(std::string_view text);

/// Each the smallest file with something of everything in it.
Result<Bytes> walk_fixture();
Result<Bytes> ostf_fixture();
Bytes glb_fixture();
Bytes path_fixture();
Result<Bytes> costs_fixture();
Bytes settings_fixture();
Bytes recording_fixture();
/// Pictures of `width` x `height` texels, no two of a row alike.
Bytes png_fixture(std::uint32_t width, std::uint32_t height);
Bytes jpeg_fixture(std::uint32_t width, std::uint32_t height, bool progressive);

/// Puts the checksums of a changed .walk or cost table right again, so that the change reaches what lies behind them. Leaves
/// alone what has lost its form.
void reseal_walk(Bytes& bytes);
void reseal_costs(Bytes& bytes);

}  // namespace surefoot::selftest
