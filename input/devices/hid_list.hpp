// Lists hidraw nodes with their facts from sysfs. Opens no device.
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

/// Reads name, socket, serial, ids and report descriptor of a node, and describes it. A descriptor that is unreadable or
/// malformed sets `trouble`; the other members are filled in.
PluggedDevice read_node(udev* context, const ListedNode& node, std::optional<Error>& trouble);

}  // namespace surefoot::input
