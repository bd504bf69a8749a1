// What is plugged in: an entry a hidraw node, with what sysfs knows of it. Opens no device.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "input/devices/source.hpp"

struct udev;

namespace surefoot::input {

/// /dev/hidraw3, and its folder in sysfs.
struct ListedNode {
    std::string node, place;
};
std::vector<ListedNode> list_nodes(udev* context);

/// Reads name, socket, serial, ids and the report descriptor of a node, and describes it. A descriptor that cannot be read or is
/// malformed is `trouble`; the rest is filled in all the same.
PluggedDevice read_node(udev* context, const ListedNode& node, std::optional<Error>& trouble);

}  // namespace surefoot::input
