// A device for who has no code to make one: plugged in as a recording says, its stick held forward, until stdin ends; or plugged
// in and pulled again and again.
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "tests/vm/checks.hpp"
#include "tests/vm/uhid.hpp"

namespace {

using namespace surefoot;

std::vector<std::byte> pad_at(int y) {
    const auto byte = [](int value) { return static_cast<std::byte>(value); };
    return {byte(128), byte(y), byte(128), byte(128), byte(0x08), byte(0), byte(0)};
}

int hold(const input::Recording& like) {
    vm::UhidDevice device(like, "plug");
    const std::string node = device.node(10'000);
    if (node.empty()) return 1;
    std::printf("%s\n", node.c_str());
    std::fflush(stdout);
    // At rest first: what comes deflected does not steer.
    const std::int64_t began = vm::now_ns();
    for (pollfd end{STDIN_FILENO, POLLIN, 0}; ::poll(&end, 1, 10) == 0;)
        if (!device.send(pad_at(vm::ms_since(began) < 3000 ? 128 : 0))) return 1;
    device.unplug();
    return 0;
}

/// A different while each time, so that the pulls meet every moment of who looks for devices.
int pull(const input::Recording& like, int times) {
    for (int i = 0; i < times; ++i) {
        vm::UhidDevice device(like, "pull");
        if (!device.plugged()) return 1;
        vm::sleep_ms(20 + 37 * i % 500);
        device.unplug();
        vm::sleep_ms(5 + 11 * i % 50);
    }
    return 0;
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 2 && count != 3) {
        std::fprintf(stderr,
                     "usage: vm_plug RECORDING.hid [TIMES]   (a pad like tests/input/devices/f310-like.hid; without TIMES "
                     "unplugged when stdin ends)\n");
        return 2;
    }
    const auto like = input::read_recording(arguments[1]);
    if (!like) {
        std::fprintf(stderr, "%s\n", like.error().text().c_str());
        return 2;
    }
    return count == 2 ? hold(*like) : pull(*like, std::atoi(arguments[2]));
}
