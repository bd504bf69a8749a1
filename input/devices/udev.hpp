// udev as resources: its context, and its monitor of hidraw devices that come, change and go.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rt/base/result.hpp"

struct udev;
struct udev_monitor;

namespace surefoot::input {

/// Releases what libudev allocated.
struct UdevDeleter {
    void operator()(udev* context) const;
    void operator()(udev_monitor* monitor) const;
};
using UdevContext = std::unique_ptr<udev, UdevDeleter>;

/// Events of the kernel and of udev about hidraw nodes. One thread calls all members.
class UdevMonitor {
public:
    /// Listens from now on. Error: no netlink socket, as in some containers; then devices must be found by scanning.
    static Result<UdevMonitor> listen(udev* context);

    [[nodiscard]] int fd() const;
    /// What came since the last call, without blocking.
    struct Changes {
        bool any = false;
        bool lost = false;                 ///< more came than the socket holds: anything may have changed
        std::vector<std::string> changed;  ///< sysfs paths that were added or changed
    };
    Changes take_changes();

private:
    std::unique_ptr<udev_monitor, UdevDeleter> monitor_;
};

}  // namespace surefoot::input
