// uhid's events, written and answered. Source: Documentation/hid/uhid.rst of the kernel.
#include "tests/vm/uhid.hpp"

#include <fcntl.h>
#include <linux/uhid.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "tests/eventually.hpp"
#include "tests/vm/checks.hpp"

namespace surefoot::vm {

namespace {

bool write_event(int fd, const uhid_event& e) { return ::write(fd, &e, sizeof e) == static_cast<ssize_t>(sizeof e); }

void copy_text(std::uint8_t* to, std::size_t room, const std::string& text) {
    std::copy_n(text.data(), std::min(room - 1, text.size()), to);
}

}  // namespace

UhidDevice::UhidDevice(const input::Recording& like, const std::string& serial, Features features)
    : serial_(serial), features_(std::move(features)) {
    fd_ = ::open("/dev/uhid", O_RDWR | O_CLOEXEC | O_NONBLOCK);
    uhid_event e{};
    e.type = UHID_CREATE2;
    copy_text(e.u.create2.name, sizeof e.u.create2.name, like.name);
    copy_text(e.u.create2.phys, sizeof e.u.create2.phys, "surefoot-vm/" + serial);
    copy_text(e.u.create2.uniq, sizeof e.u.create2.uniq, serial);
    e.u.create2.rd_size = static_cast<std::uint16_t>(like.descriptor.size());
    e.u.create2.bus = like.bus;
    e.u.create2.vendor = like.vendor;
    e.u.create2.product = like.product;
    std::memcpy(e.u.create2.rd_data, like.descriptor.data(), like.descriptor.size());
    if (fd_ < 0 || !write_event(fd_, e)) {
        std::fprintf(stderr, "/dev/uhid: cannot make a device: %s\n", std::strerror(errno));
        if (fd_ >= 0) ::close(fd_);
        fd_ = -1;
        return;
    }
    server_ = std::thread([this] { serve(); });
}

void UhidDevice::serve() {
    while (!ending_) {
        pollfd one{fd_, POLLIN, 0};
        if (::poll(&one, 1, 2) <= 0) continue;
        uhid_event e{}, answer{};
        if (::read(fd_, &e, sizeof e) <= 0) continue;
        if (e.type == UHID_GET_REPORT) {
            const auto data = features_.get ? features_.get(e.u.get_report.rnum) : std::nullopt;
            answer.type = UHID_GET_REPORT_REPLY;
            answer.u.get_report_reply.id = e.u.get_report.id;
            answer.u.get_report_reply.err = data ? 0 : EIO;
            if (data) {
                answer.u.get_report_reply.size = static_cast<std::uint16_t>(data->size());
                std::memcpy(answer.u.get_report_reply.data, data->data(), data->size());
            }
            (void)write_event(fd_, answer);
        } else if (e.type == UHID_SET_REPORT) {
            const auto bytes = std::as_bytes(std::span(e.u.set_report.data, e.u.set_report.size));
            answer.type = UHID_SET_REPORT_REPLY;
            answer.u.set_report_reply.id = e.u.set_report.id;
            answer.u.set_report_reply.err = features_.set && features_.set(e.u.set_report.rnum, bytes) ? 0 : EIO;
            (void)write_event(fd_, answer);
        }
    }
}

bool UhidDevice::send(std::span<const std::byte> report) {
    uhid_event e{};
    e.type = UHID_INPUT2;
    e.u.input2.size = static_cast<std::uint16_t>(report.size());
    std::memcpy(e.u.input2.data, report.data(), report.size());
    return fd_ >= 0 && write_event(fd_, e);
}

void UhidDevice::unplug() {
    if (fd_ < 0) return;
    uhid_event e{};
    e.type = UHID_DESTROY;
    (void)write_event(fd_, e);
    ending_ = true;
    server_.join();
    ::close(fd_);
    fd_ = -1;
}

std::string UhidDevice::node(int within_ms) const {
    std::string found;
    (void)test::eventually(within_ms * 1e-3, [&] {
        std::error_code problem;
        for (const auto& entry : std::filesystem::directory_iterator("/sys/class/hidraw", problem)) {
            const std::string name = entry.path().filename().string();
            if (get(entry.path() / "device/uevent").find("HID_UNIQ=" + serial_) != std::string::npos &&
                std::filesystem::exists("/dev/" + name))
                found = name;
        }
        return !found.empty();
    });
    return found;
}

}  // namespace surefoot::vm
