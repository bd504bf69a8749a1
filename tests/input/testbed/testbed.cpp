// The synthetic devices.
#include "tests/input/testbed/testbed.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/capability.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace surefoot::input::test {

namespace {

std::string hex_text(std::span<const std::byte> bytes) {
    std::string text;
    for (const std::byte b : bytes) text += fmt::format("{:02X}", std::to_integer<unsigned>(b));
    return text;
}

/// The two ioctls that hidapi and we ask: the descriptor's size, and the descriptor with 4096 bytes of room.
void write_ioctls(const std::string& file, const std::string& node, std::span<const std::byte> descriptor) {
    const auto size = static_cast<unsigned>(descriptor.size());
    const std::string size_text = fmt::format("{:02X}{:02X}0000", size & 0xffU, size >> 8U);
    std::ofstream out(file);
    out << "@DEV " << node << "\nHIDIOCGRDESCSIZE 0 " << size_text << "\nHIDIOCGRDESC 0 " << size_text << hex_text(descriptor)
        << std::string(2 * (4096 - descriptor.size()), '0') << "\n";
}

/// Root's CAP_DAC_OVERRIDE and CAP_DAC_READ_SEARCH of the calling thread, off and on again; others have neither.
void override_modes(bool on) {
    __user_cap_header_struct head{_LINUX_CAPABILITY_VERSION_3, 0};
    __user_cap_data_struct data[2] = {};
    if (syscall(SYS_capget, &head, data) != 0) return;
    const std::uint32_t both = (1U << CAP_DAC_OVERRIDE) | (1U << CAP_DAC_READ_SEARCH);
    data[0].effective = on ? data[0].effective | (data[0].permitted & both) : data[0].effective & ~both;
    syscall(SYS_capset, &head, data);
}

}  // namespace

namespace {
constexpr std::int64_t nap_ns = 5'000'000, usual_ns = 20'000'000;  // a nap that took longer was a hold-up
std::int64_t held_up_since(std::int64_t beat_ns) {
    const std::int64_t gap = now_ns() - beat_ns;
    return gap > usual_ns ? gap - nap_ns : 0;
}
}  // namespace

HoldUps::HoldUps()
    : beat_ns_(now_ns()), thread_([this] {
          while (!stopping_.load()) {
              beat_ns_.store(now_ns());
              usleep(nap_ns / 1000);  // how much longer than asked this takes is what is measured
              ns_ += held_up_since(beat_ns_.load());
          }
      }) {}
double HoldUps::ms() const { return static_cast<double>(ns_.load() + held_up_since(beat_ns_.load())) * 1e-6; }
HoldUps::~HoldUps() {
    stopping_.store(true);
    thread_.join();
}

Patience::Patience(int ms) : left_ns_(ms * std::int64_t{1'000'000}), looked_ns_(now_ns()) {}
bool Patience::over() {
    const std::int64_t now = now_ns();
    left_ns_ -= std::min<std::int64_t>(now - looked_ns_, 100'000'000);
    looked_ns_ = now;
    return left_ns_ < 0;
}

Testbed::Testbed() : bed_(umockdev_testbed_new()) {
    gchar* root = umockdev_testbed_get_root_dir(bed_);
    root_ = root;
    g_free(root);
    chmod(root_.c_str(), 0755);
    std::filesystem::create_directories(root_ + "/dev");
}

Testbed::~Testbed() { g_object_unref(bed_); }

Plug Testbed::plug(const Recording& r, const Facts& facts) {
    Plug p;
    p.node = "/dev/" + facts.node;
    const std::string node = root_ + p.node;
    std::filesystem::create_directories(root_ + "/dev");
    std::filesystem::remove(node);
    if (facts.wire == Wire::pipe) {
        // Opened both ways, so that it never hangs up; O_DIRECT: each write stays a report of its own.
        EXPECT_EQ(mkfifo(node.c_str(), 0600), 0);
        p.fd = open(node.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
        EXPECT_EQ(fcntl(p.fd, F_SETFL, O_NONBLOCK | O_DIRECT), 0);
        fcntl(p.fd, F_SETPIPE_SZ, 64 * 4096);
    } else {
        int tail = -1;
        char name[256] = {};
        termios raw{};
        cfmakeraw(&raw);
        EXPECT_EQ(openpty(&p.fd, &tail, name, &raw, nullptr), 0);
        p.tail = tail;
        fcntl(tail, F_SETFD, FD_CLOEXEC);
        fcntl(p.fd, F_SETFD, FD_CLOEXEC);
        chmod(name, facts.readable ? 0666 : 0);
        EXPECT_EQ(symlink(name, node.c_str()), 0);
    }
    EXPECT_GE(p.fd, 0);
    if (facts.wire == Wire::pipe) chmod(node.c_str(), facts.readable ? 0666 : 0);

    GError* error = nullptr;
    if (answering_.insert(p.node).second) {  // what answers for a node stays as long as the testbed
        const std::string ioctls = root_ + "/" + facts.node + ".ioctl";
        write_ioctls(ioctls, p.node, r.descriptor);
        EXPECT_TRUE(umockdev_testbed_load_ioctl(bed_, p.node.c_str(), ioctls.c_str(), &error)) << error->message;
    }

    // As the kernel: a new instance number at each plugging.
    ++plugged_;
    const std::string id = fmt::format("{:04X}:{:04X}:{:04X}.{:04X}", r.bus, r.vendor, r.product, plugged_);
    p.hid_place = fmt::format("/devices/pci0000:00/0000:00:14.0/usb1/1-1/1-1:1.0/{}", id);
    const std::string hid = fmt::format(
        "P: {}\nE: DRIVER=hid-generic\nE: HID_ID={:04X}:{:08X}:{:08X}\nE: HID_NAME={}\nE: HID_PHYS={}\nE: HID_UNIQ={}\n"
        "E: SUBSYSTEM=hid\nH: report_descriptor={}\n\n",
        p.hid_place, r.bus, r.vendor, r.product, r.name, facts.socket, facts.serial, hex_text(r.descriptor));
    const std::string raw = fmt::format(
        "P: {}/hidraw/{}\nE: DEVNAME={}\nE: MAJOR=240\nE: MINOR={}\nE: SUBSYSTEM=hidraw\nA: dev=240:{}\n"
        "L: device=../../../{}\n\n",
        p.hid_place, facts.node, p.node, facts.node.substr(6), facts.node.substr(6), id);
    EXPECT_TRUE(umockdev_testbed_add_from_string(bed_, (hid + raw).c_str(), &error)) << error->message;
    p.hid_place = "/sys" + p.hid_place;
    p.place = p.hid_place + "/hidraw/" + facts.node;
    return p;
}

bool Testbed::send(Plug& plug, std::span<const std::byte> report) {
    return write(plug.fd, report.data(), report.size()) == static_cast<ssize_t>(report.size());
}

bool Testbed::taken(const Plug& plug, int within_ms) {
    // Past the preloaded library: it takes a descriptor's number for the device that had it before, and waits for an answer for
    // ever. Looks every 0.5 ms: reports follow each other within 4 ms.
    int waiting = 0;
    for (Patience patience(within_ms); syscall(SYS_ioctl, plug.tail, FIONREAD, &waiting) == 0 && waiting > 0; usleep(500))
        if (patience.over()) return false;
    return true;
}

void Testbed::hang_up(Plug& plug) {
    if (plug.fd >= 0) close(plug.fd);
    plug.fd = -1;
    if (plug.tail >= 0) close(plug.tail);
    plug.tail = -1;
}

void Testbed::pull(Plug& plug) {
    hang_up(plug);
    // As with the kernel it is listed no more when udev tells; umockdev would tell of nothing that is gone altogether.
    std::filesystem::remove(root_ + "/sys/class/hidraw/" + plug.node.substr(5));
    umockdev_testbed_uevent(bed_, plug.place.c_str(), "remove");
    umockdev_testbed_remove_device(bed_, plug.place.c_str());
    umockdev_testbed_remove_device(bed_, plug.hid_place.c_str());
    std::filesystem::remove(root_ + plug.node);
}

void Testbed::permit(const Plug& plug, bool send_event) {
    chmod((root_ + plug.node).c_str(), 0666);
    if (send_event) umockdev_testbed_uevent(bed_, plug.place.c_str(), "change");
}

NoOverride::NoOverride() { override_modes(false); }
NoOverride::~NoOverride() { override_modes(true); }

std::int64_t now_ns() { return rt::RealClock().now_ns(); }

std::size_t open_descriptors() {
    std::size_t n = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) n += entry.exists() || true ? 1 : 0;
    return n;
}

void Watcher::take(std::span<const DeviceEvent> events) {
    for (const DeviceEvent& e : events)
        seen.push_back({e, {e.bytes.begin(), e.bytes.end()}, e.why == nullptr ? Error{} : *e.why});
}

const Watcher::Seen* Watcher::next(DeviceEvent::Kind kind, int within_ms) {
    Patience patience(within_ms);
    for (;;) {
        for (; looked_at_ < seen.size(); ++looked_at_)
            if (seen[looked_at_].event.kind == kind) return &seen[looked_at_++];
        if (patience.over()) return nullptr;
        take(poll(source_, now_ns() + 50'000'000));
    }
}

void Watcher::watch_for(int ms) {
    const std::int64_t end = now_ns() + ms * std::int64_t{1'000'000};
    while (now_ns() < end) take(poll(source_, end));
}

std::size_t Watcher::count(DeviceEvent::Kind kind) const {
    return static_cast<std::size_t>(std::count_if(seen.begin(), seen.end(), [&](const Seen& s) { return s.event.kind == kind; }));
}

}  // namespace surefoot::input::test
