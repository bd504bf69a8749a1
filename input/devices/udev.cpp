// udev's monitor. Events come from udevd, when the rules have run, not from the kernel: then permissions are set already.
#include "input/devices/udev.hpp"

#include <libudev.h>

#include <cerrno>
#include <cstring>

namespace surefoot::input {

void UdevDeleter::operator()(udev* context) const { udev_unref(context); }
void UdevDeleter::operator()(udev_monitor* monitor) const { udev_monitor_unref(monitor); }

Result<UdevMonitor> UdevMonitor::listen(udev* context) {
    UdevMonitor m;
    m.monitor_.reset(udev_monitor_new_from_netlink(context, "udev"));
    if (!m.monitor_ || udev_monitor_filter_add_match_subsystem_devtype(m.monitor_.get(), "hidraw", nullptr) < 0 ||
        udev_monitor_enable_receiving(m.monitor_.get()) < 0) {
        return Error{
            "udev",
            std::string("Events cannot be received, so devices are looked for five times a second: ") + std::strerror(errno),
            "Allow netlink sockets (AF_NETLINK) to this service", ErrorKind::no_device};
    }
    return m;
}

int UdevMonitor::fd() const { return udev_monitor_get_fd(monitor_.get()); }

UdevMonitor::Changes UdevMonitor::take_changes() {
    Changes changes;
    for (;;) {
        errno = 0;
        udev_device* device = udev_monitor_receive_device(monitor_.get());
        if (device == nullptr) {
            if (errno == ENOBUFS) {
                changes.any = changes.lost = true;
                continue;
            }
            return changes;
        }
        changes.any = true;
        const char* action = udev_device_get_action(device);
        const char* path = udev_device_get_syspath(device);
        if (path != nullptr && action != nullptr && std::strcmp(action, "remove") != 0) changes.changed.emplace_back(path);
        udev_device_unref(device);
    }
}

}  // namespace surefoot::input
