// One open HID device: hidapi's handle as a resource, with the descriptor that poll() needs.
#pragma once

#include <cstddef>
#include <span>
#include <string>

struct hid_device_;

namespace surefoot::input {

/// An open hidraw node. Closes it at the end. Moves, does not copy.
class HidHandle {
public:
    HidHandle() = default;
    HidHandle(HidHandle&& other) noexcept;
    HidHandle& operator=(HidHandle&& other) noexcept;
    HidHandle(const HidHandle&) = delete;
    HidHandle& operator=(const HidHandle&) = delete;
    ~HidHandle() { close(); }

    /// Opens for reading and writing (hidapi knows no other way). False: code and what() say why.
    bool open(const std::string& node);
    void close();

    [[nodiscard]] explicit operator bool() const { return device_ != nullptr; }
    /// For poll(); -1 if unknown: then call read() periodically.
    [[nodiscard]] int fd() const { return fd_; }
    /// Reads one report into `to`. Returns its bytes; 0: none is waiting; -1: the device is gone or broken. Never blocks.
    int read(std::span<std::byte> to);
    [[nodiscard]] int code() const { return code_; }  ///< errno of the failed open
    [[nodiscard]] const std::string& what() const { return what_; }

private:
    [[nodiscard]] bool hung_up() const;

    hid_device_* device_ = nullptr;
    int fd_ = -1;
    int code_ = 0;
    std::string what_;
};

}  // namespace surefoot::input
