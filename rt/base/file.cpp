// Whole files in and out through plain system calls: errors keep their errno, and the old file outlives a failed write.
#include "rt/base/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace surefoot {

namespace {

constexpr const char* surefoot_bug = "This is an error of surefoot. Report it with the command that you gave";

/// What a system error means to the person at the keyboard.
std::string remedy_for(int error) {
    switch (error) {
        case ENOENT:
            return "Check the path";
        case EACCES:
        case EPERM:
            return "Check who may read and write there";
        case EROFS:
            return "Choose another place: this file system is mounted read-only";
        case ENOSPC:
        case EDQUOT:
            return "Free some space, or choose another disk";
        case ENOTDIR:
            return "Check the path: a part of it is a file, not a folder";
        case EFBIG:
            return "Raise the limit of file sizes (ulimit -f), or choose another disk";
        case EMFILE:
        case ENFILE:
            return "Raise the limit of open files (ulimit -n)";
        case ENAMETOOLONG:
        case ELOOP:
            return "Choose a shorter, plainer name";
        default:
            return "Check the disk";
    }
}

/// "The file cannot be opened: No such file or directory".
Error system_error(const std::string& place, std::string_view what, int error, ErrorKind kind) {
    if (kind == ErrorKind::unreadable && (error == ENOENT || error == ENOTDIR)) kind = ErrorKind::not_found;
    return {place, fmt::format("{}: {}", what, std::strerror(error)), remedy_for(error), kind};  // NOLINT(concurrency-mt-unsafe)
}

Error too_large(const std::string& path, std::uint64_t limit) {
    return {path, fmt::format("The file is larger than the limit of {} bytes", limit), "Check that this is the right file",
            ErrorKind::out_of_limits};
}

/// Closes on every way out.
struct Descriptor {
    int fd = -1;
    explicit Descriptor(int opened) : fd(opened) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (fd >= 0) ::close(fd);
    }
};

std::string folder_of(const std::string& path) {
    const std::string folder = std::filesystem::path(path).parent_path().string();
    return folder.empty() ? "." : folder;
}

/// A name is on the disk when its folder is. `path`: of the file, for the error.
Result<void> sync_folder(const std::string& folder, const std::string& path) {
    const Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    // Some file systems refuse to sync a folder (EINVAL); the file itself is complete either way.
    if (opened.fd >= 0 && ::fsync(opened.fd) != 0 && errno != EINVAL)
        return system_error(path, "The folder cannot be synced", errno, ErrorKind::unwritable);
    return {};
}

/// Reads to the end into a string or vector; the size hint only saves growing (a pipe has none).
template <class Bytes>
Result<Bytes> read_all(const std::string& path, std::uint64_t max_bytes) {
    struct stat info {};
    // Opening a pipe that nobody writes to would wait for ever, and no signal would end it. A shell's <(...) has its writer.
    if (::stat(path.c_str(), &info) == 0 && S_ISFIFO(info.st_mode) && !path.starts_with("/dev/") && !path.starts_with("/proc/")) {
        return Error{path, "The name is a named pipe, not a file", "Name a file", ErrorKind::unreadable};
    }
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.fd < 0) return system_error(path, "The file cannot be opened", errno, ErrorKind::unreadable);
    if (::fstat(file.fd, &info) != 0) return system_error(path, "The file cannot be examined", errno, ErrorKind::unreadable);
    if (S_ISDIR(info.st_mode)) return Error{path, "The name is a folder, not a file", "Name a file", ErrorKind::unreadable};
    if (S_ISCHR(info.st_mode) || S_ISBLK(info.st_mode))
        return Error{path, "The name is a device, not a file", "Name a file", ErrorKind::unreadable};
    const auto hint = static_cast<std::uint64_t>(std::max<off_t>(info.st_size, 0));
    if (hint > max_bytes) return too_large(path, max_bytes);
    Bytes bytes;
    bytes.resize(hint);
    std::size_t filled = 0;
    std::array<std::byte, 65536> beyond{};
    for (;;) {
        const bool fits = filled < bytes.size();
        auto* into = fits ? reinterpret_cast<std::byte*>(bytes.data()) + filled : beyond.data();
        const ssize_t got = ::read(file.fd, into, fits ? bytes.size() - filled : beyond.size());
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return system_error(path, "The file cannot be read", errno, ErrorKind::unreadable);
        if (got == 0) break;
        if (!fits) {
            if (filled + static_cast<std::size_t>(got) > max_bytes) return too_large(path, max_bytes);
            bytes.resize(filled + static_cast<std::size_t>(got));
            std::memcpy(bytes.data() + filled, beyond.data(), static_cast<std::size_t>(got));
        }
        filled += static_cast<std::size_t>(got);
    }
    bytes.resize(filled);
    return bytes;
}

}  // namespace

Result<std::vector<std::byte>> read_file(const std::string& path, std::uint64_t max_bytes) {
    return read_all<std::vector<std::byte>>(path, max_bytes);
}

Result<std::string> read_text(const std::string& path, std::uint64_t max_bytes) { return read_all<std::string>(path, max_bytes); }

Result<void> require_plain(const std::string& path) {
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0 || S_ISREG(info.st_mode) || S_ISDIR(info.st_mode)) return {};
    return Error{path, "The name is not a plain file", "Name a plain file", ErrorKind::unreadable};
}

Result<AtomicFile> AtomicFile::create(const std::string& path) {
    if (path.empty()) return Error{"output", "The file name is empty", "Name a file", ErrorKind::misuse};
    AtomicFile file;
    std::error_code ignored;
    // Through a link, the file that it names is replaced, not the link.
    const auto target = std::filesystem::canonical(path, ignored);
    file.path_ = ignored ? path : target.string();

    struct stat old {};
    const bool exists = ::stat(file.path_.c_str(), &old) == 0;
    if (exists && S_ISDIR(old.st_mode))
        return Error{path, "The name is a folder, not a file", "Name a file in it", ErrorKind::unwritable};
    if (exists && !S_ISREG(old.st_mode))
        return Error{path, "The name is not a plain file", "Name a plain file", ErrorKind::unwritable};
    if (exists && ::access(file.path_.c_str(), W_OK) != 0)
        return system_error(path, "The file cannot be replaced", errno, ErrorKind::unwritable);

    for (int attempt = 0; attempt < 100; ++attempt) {
        file.temporary_ = fmt::format("{}.{}-{}.tmp", file.path_, ::getpid(), attempt);
        file.fd_ = ::open(file.temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file.fd_ >= 0 || errno != EEXIST) break;
    }
    if (file.fd_ < 0) {
        const int error = errno;
        file.temporary_.clear();
        return system_error(path, fmt::format("No file can be written in {}", folder_of(file.path_)), error,
                            ErrorKind::unwritable);
    }
    if (exists) (void)::fchmod(file.fd_, old.st_mode & 07777);
    return file;
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : path_(std::move(other.path_)), temporary_(std::move(other.temporary_)), fd_(std::exchange(other.fd_, -1)) {
    other.temporary_.clear();
}

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
    if (this == &other) return *this;
    discard();
    path_ = std::move(other.path_);
    temporary_ = std::move(other.temporary_);
    fd_ = std::exchange(other.fd_, -1);
    other.temporary_.clear();
    return *this;
}

AtomicFile::~AtomicFile() { discard(); }

void AtomicFile::discard() noexcept {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
    temporary_.clear();
}

Result<void> AtomicFile::write(std::span<const std::byte> bytes) {
    if (fd_ < 0) return Error{path_, "The file was written to after it was closed", surefoot_bug, ErrorKind::unwritable};
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t put = ::write(fd_, bytes.data() + done, bytes.size() - done);
        if (put < 0 && errno == EINTR) continue;
        if (put < 0) return system_error(path_, "The file cannot be written", errno, ErrorKind::unwritable);
        done += static_cast<std::size_t>(put);
    }
    return {};
}

Result<void> AtomicFile::write(std::string_view text) { return write(std::as_bytes(std::span(text.data(), text.size()))); }

Result<void> AtomicFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
    if (fd_ < 0) return Error{path_, "The file was written to after it was closed", surefoot_bug, ErrorKind::unwritable};
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t put = ::pwrite(fd_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
        if (put < 0 && errno == EINTR) continue;
        if (put < 0) return system_error(path_, "The file cannot be written", errno, ErrorKind::unwritable);
        done += static_cast<std::size_t>(put);
    }
    return {};
}

Result<void> AtomicFile::sync() {
    if (fd_ < 0) return Error{path_, "The file was committed after it was closed", surefoot_bug, ErrorKind::unwritable};
    if (::fsync(fd_) != 0) return system_error(path_, "The file cannot be completed", errno, ErrorKind::unwritable);
    return {};
}

Result<void> AtomicFile::take_place() {
    if (fd_ < 0) return Error{path_, "The file was committed after it was closed", surefoot_bug, ErrorKind::unwritable};
    int error = ::close(std::exchange(fd_, -1)) != 0 ? errno : 0;
    if (error == 0 && ::rename(temporary_.c_str(), path_.c_str()) != 0) error = errno;
    if (error != 0) {
        discard();
        return system_error(path_, "The file cannot be completed", error, ErrorKind::unwritable);
    }
    temporary_.clear();
    return {};
}

// The order matters: contents reach the disk before the name does, and the name before we say that it is done.
Result<void> AtomicFile::commit() {
    if (auto ok = sync(); !ok) return discard(), ok;
    if (auto ok = take_place(); !ok) return ok;
    return sync_folder(folder_of(path_), path_);
}

Result<void> probe_writable(const std::string& path, bool make_folders) {
    if (path.empty()) return Error{"output", "The file name is empty", "Name a file", ErrorKind::misuse};
    std::filesystem::path folder = folder_of(path);
    std::error_code ignored;
    bool missing = false;
    while (make_folders && !std::filesystem::exists(folder, ignored)) {
        missing = true;
        const std::filesystem::path above = folder.has_parent_path() ? folder.parent_path() : std::filesystem::path(".");
        if (above == folder) break;
        folder = above;
    }
    if (make_folders && !std::filesystem::is_directory(folder, ignored)) {
        return Error{path, "The path " + folder.string() + " is a file, not a folder", "Name another folder",
                     ErrorKind::unwritable};
    }
    const std::string tried = missing ? (folder / "surefoot-probe").string() : path;
    if (auto file = AtomicFile::create(tried); !file)
        return Error{path, file.error().what, file.error().remedy, file.error().kind};
    return {};
}

Result<FileSet> FileSet::create(const std::string& folder) {
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed)
        return Error{folder, "The folder cannot be created: " + failed.message(), "Choose a folder that you may write in",
                     ErrorKind::unwritable};
    FileSet set;
    set.folder_ = folder;
    return set;
}

Result<AtomicFile*> FileSet::add(std::string_view name) {
    auto file = AtomicFile::create((std::filesystem::path(folder_) / name).string());
    if (!file) return file.error();
    files_.push_back(std::move(*file));
    return &files_.back();
}

Result<void> FileSet::add(std::string_view name, std::string_view text) {
    auto file = add(name);
    if (!file) return file.error();
    return (*file)->write(text);
}

Result<void> FileSet::commit() {
    for (AtomicFile& file : files_)
        if (auto ok = file.sync(); !ok) return ok;
    // From here on one that fails keeps none of the others back.
    Result<void> done;
    for (AtomicFile& file : files_)
        if (auto ok = file.take_place(); !ok && done) done = ok;
    files_.clear();
    return done ? sync_folder(folder_, folder_) : done;
}

Result<void> FileSet::probe(const std::string& folder, std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names)
        if (auto ok = probe_writable((std::filesystem::path(folder) / name).string(), true); !ok) return ok;
    return {};
}

Result<void> write_file(const std::string& path, std::span<const std::byte> bytes) {
    auto file = AtomicFile::create(path);
    if (!file) return file.error();
    if (auto written = file->write(bytes); !written) return written;
    return file->commit();
}

Result<void> write_text(const std::string& path, std::string_view text) {
    return write_file(path, std::as_bytes(std::span(text.data(), text.size())));
}

void keep_standard_files() {
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd) {
        if (fcntl(fd, F_GETFD) == -1 && errno == EBADF) (void)open("/dev/null", fd == STDERR_FILENO ? O_WRONLY : O_RDONLY);
    }
}

}  // namespace surefoot
