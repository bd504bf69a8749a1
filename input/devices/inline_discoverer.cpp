// The finder in the reader's own thread.
#include <deque>

#include "input/devices/discoverer.hpp"

namespace surefoot::input {

namespace {

class InlineDiscoverer final : public Discoverer {
public:
    explicit InlineDiscoverer(Finder finder) : finder_(std::move(finder)) {}

    std::unique_ptr<Discovery> next(std::int64_t now_ns) override {
        if (waiting_.empty())
            for (Discovery& d : finder_.look(now_ns)) waiting_.push_back(std::make_unique<Discovery>(std::move(d)));
        if (waiting_.empty()) return nullptr;
        auto first = std::move(waiting_.front());
        waiting_.pop_front();
        return first;
    }
    void give_back(std::unique_ptr<Discovery> discovery, bool failed, std::int64_t now_ns) override {
        if (failed) finder_.failed(discovery->device, now_ns);
    }
    [[nodiscard]] int fd() const override { return finder_.fd(); }
    [[nodiscard]] std::int64_t due_ns() const override { return finder_.due_ns(); }

private:
    Finder finder_;
    std::deque<std::unique_ptr<Discovery>> waiting_;
};

}  // namespace

std::unique_ptr<Discoverer> inline_discoverer(Finder finder) { return std::make_unique<InlineDiscoverer>(std::move(finder)); }

}  // namespace surefoot::input
