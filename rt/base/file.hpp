// Whole files in and out: bounded reads, and writes that replace the old file only when complete.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/result.hpp"

namespace surefoot {

/// The whole file. Refuses directories, and files over max_bytes.
Result<std::vector<std::byte>> read_file(const std::string& path, std::uint64_t max_bytes = 1ULL << 34U);
Result<std::string> read_text(const std::string& path, std::uint64_t max_bytes = 1ULL << 30U);

/// Refuses a `path` that is not a plain file. For names that come out of a file, which may be untrusted: reading a pipe or
/// /dev/stdin would wait for ever. A missing file passes; reading it gives the error.
Result<void> require_plain(const std::string& path);

/// A file written under a temporary name beside its place; commit() syncs and renames it over the old one.
/// Destroyed without commit(): the temporary is removed and the old file stays (Ctrl-C handlers rely on it).
class AtomicFile {
public:
    static Result<AtomicFile> create(const std::string& path);
    AtomicFile(AtomicFile&& other) noexcept;
    AtomicFile& operator=(AtomicFile&& other) noexcept;
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;
    ~AtomicFile();

    Result<void> write(std::span<const std::byte> bytes);
    Result<void> write(std::string_view text);
    Result<void> write_at(std::uint64_t offset, std::span<const std::byte> bytes);
    Result<void> commit();

private:
    friend class FileSet;
    Result<void> sync();        ///< contents are on the disk
    Result<void> take_place();  ///< renamed
    AtomicFile() = default;
    void discard() noexcept;
    std::string path_;
    std::string temporary_;
    int fd_ = -1;
};

/// Whether an AtomicFile could be made at `path` now. Tries it, and leaves nothing behind. Call it before long work, so that the
/// result is not lost for a wrong name. make_folders: missing folders are accepted if the nearest one above is writable.
Result<void> probe_writable(const std::string& path, bool make_folders = false);

/// Files of one folder that belong together. A missing folder is created. All files are written and synced before the first is
/// renamed, so that a full disk leaves all old files unchanged. (A power cut between two renames may mix old and new.)
class FileSet {
public:
    static Result<FileSet> create(const std::string& folder);
    /// A file of that name, to be written; the reference holds until the next call.
    Result<AtomicFile*> add(std::string_view name);
    Result<void> add(std::string_view name, std::string_view text);
    Result<void> commit();
    /// Whether one with these could be made now: see probe_writable.
    static Result<void> probe(const std::string& folder, std::initializer_list<std::string_view> names);

private:
    std::string folder_;
    std::vector<AtomicFile> files_;
};

/// write + commit in one call.
Result<void> write_file(const std::string& path, std::span<const std::byte> bytes);
Result<void> write_text(const std::string& path, std::string_view text);

/// Opens /dev/null in the place of a closed stdin, stdout or stderr. Their numbers would go to the next files that are opened,
/// and what is printed or logged would go there. To be called first of all.
void keep_standard_files();

}  // namespace surefoot
