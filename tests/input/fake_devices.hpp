// Devices that a test plugs, moves and pulls, behind the same door as the live ones; time is given.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "input/devices/source.hpp"
#include "tests/input/hid_test.hpp"

namespace surefoot::input::test {

class FakeDevices final : public DeviceSource {
public:
    int plug(const Recording& r, const std::string& serial = "", const std::string& socket = "usb-1/input0") {
        auto p = std::make_shared<PluggedDevice>();
        p->node = "/dev/hidraw" + std::to_string(next_);
        p->place = "/sys/fake/" + std::to_string(next_);
        p->name = r.name;
        p->socket = socket;
        p->serial = serial;
        p->bus = r.bus;
        p->vendor = r.vendor;
        p->product = r.product;
        p->descriptor = r.descriptor;
        p->device = device_of(r);
        DeviceEvent e;
        e.kind = DeviceEvent::Kind::added;
        e.device = next_++;
        if (attachment_factory) {
            attachments_.push_back(attachment_factory(*p));
            e.attachment = attachments_.back().get();
        }
        e.plugged = plugged_.emplace_back(std::move(p));
        push(e);
        return e.device;
    }
    void pull(int device) {
        DeviceEvent e;
        e.kind = DeviceEvent::Kind::removed;
        e.device = device;
        e.why = &unplugged_;
        push(e);
    }
    void send(int device, std::vector<std::byte> report) {
        kept_.push_back(std::move(report));
        DeviceEvent e;
        e.device = device;
        e.bytes = kept_.back();
        push(e);
        e = {};
        e.kind = DeviceEvent::Kind::drained;
        e.device = device;
        e.reports = 1;
        push(e);
    }
    void push(DeviceEvent e) {
        e.stamp_ns = now_ns;
        waiting_.push_back(std::move(e));
    }

    void wait(std::int64_t until_ns) override {
        if (waiting_.empty()) now_ns = std::max(now_ns, until_ns);
    }
    std::span<const DeviceEvent> take() override {
        std::swap(taken_, waiting_);
        waiting_.clear();
        return taken_;
    }
    [[nodiscard]] const std::optional<Error>& trouble() const override { return without; }
    std::optional<Error> without;
    std::int64_t now_ns = 1'000'000'000;
    std::function<std::unique_ptr<DeviceAttachment>(const PluggedDevice&)>
        attachment_factory;  ///< as FinderOptions::attachment_factory

private:
    std::deque<std::unique_ptr<DeviceAttachment>> attachments_;  ///< kept, as are the plugged: nothing is freed inside take()
    std::deque<std::shared_ptr<const PluggedDevice>> plugged_;
    int next_ = 0;
    Error unplugged_{"fake", "was unplugged", ""};
    std::deque<std::vector<std::byte>> kept_;
    std::vector<DeviceEvent> waiting_, taken_;
};

}  // namespace surefoot::input::test
