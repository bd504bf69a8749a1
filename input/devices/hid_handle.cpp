// hidapi's handle. Its descriptor is found by the inode of the node, because hidapi shows it nowhere.
#include "input/devices/hid_handle.hpp"

#include <fcntl.h>
#include <hidapi.h>
#include <linux/hidraw.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "rt/base/text.hpp"

namespace surefoot::input {

namespace {

/// A descriptor of this process, other than `not_this`, that stands for the same file; -1: none, or more than one.
int twin_of(int not_this) {
    struct stat wanted {};
    if (fstat(not_this, &wanted) != 0) return -1;
    int found = -1;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", ignored)) {
        const std::string name = entry.path().filename();
        const int fd = leading_number(name, -1);
        struct stat is {};
        if (fd < 0 || fd == not_this || fstat(fd, &is) != 0) continue;
        if (is.st_dev != wanted.st_dev || is.st_ino != wanted.st_ino) continue;
        if (found >= 0) return -1;
        found = fd;
    }
    return found;
}

}  // namespace

HidHandle::HidHandle(HidHandle&& other) noexcept
    : device_(std::exchange(other.device_, nullptr)),
      fd_(std::exchange(other.fd_, -1)),
      code_(other.code_),
      what_(std::move(other.what_)) {}

HidHandle& HidHandle::operator=(HidHandle&& other) noexcept {
    if (this == &other) return *this;
    close();
    device_ = std::exchange(other.device_, nullptr);
    fd_ = std::exchange(other.fd_, -1);
    code_ = other.code_;
    what_ = std::move(other.what_);
    return *this;
}

// The node is opened and asked before hidapi does so: only so the cause of a refusal is known for sure, and hidapi 0.13 writes
// into freed memory where a node that it has opened does not answer as hidraw.
bool HidHandle::open(const std::string& node) {
    close();
    const auto failed = [&](int code, const std::string& what) {
        code_ = code;
        what_ = what;
        return false;
    };
    const int probe = ::open(node.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
    if (probe < 0) return failed(errno, std::strerror(errno));
    int size = 0;
    if (ioctl(probe, HIDIOCGRDESCSIZE, &size) < 0) {
        const int code = errno;
        ::close(probe);
        return failed(code, std::string("it does not answer as a hidraw node: ") + std::strerror(code));
    }
    device_ = hid_open_path(node.c_str());
    const int code = errno;
    if (device_ != nullptr) fd_ = twin_of(probe);
    // hidapi polls and then reads: should the report be gone in between, read() would wait for the next one.
    if (fd_ >= 0) (void)fcntl(fd_, F_SETFL, fcntl(fd_, F_GETFL) | O_NONBLOCK);
    ::close(probe);
    if (device_ == nullptr) return failed(code, std::strerror(code));
    return true;
}

void HidHandle::close() {
    if (device_ != nullptr) hid_close(device_);
    device_ = nullptr;
    fd_ = -1;
}

bool HidHandle::hung_up() const {
    if (fd_ < 0) return true;
    pollfd p{fd_, POLLIN, 0};
    for (;;) {
        const int n = ::poll(&p, 1, 0);
        if (n < 0 && errno == EINTR) continue;
        return n < 0 || (p.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
    }
}

// hidapi takes a signal for a failure: asked again unless the device has hung up. Whether it has is asked first, too: for a
// device that is gone hidapi makes up an error text, and the reader must not allocate.
int HidHandle::read(std::span<std::byte> to) {
    if (fd_ >= 0 && hung_up()) return -1;
    int n = -1;
    for (int attempt = 0; attempt < 3 && n < 0; ++attempt) {
        n = hid_read_timeout(device_, reinterpret_cast<unsigned char*>(to.data()), to.size(), 0);
        if (n < 0 && hung_up()) break;
    }
    return n;
}

}  // namespace surefoot::input
