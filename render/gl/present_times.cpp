// Reading PresentCompleteNotify.
#include "render/gl/present_times.hpp"

#include <time.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>

#include "render/gl/api.hpp"

namespace surefoot::gl {

namespace {

constexpr std::uint32_t complete_notify_mask = 2;
constexpr std::uint16_t complete_notify = 1;
constexpr std::uint8_t generic_event = 35, of_pixmap = 0, skipped = 2;
constexpr std::int64_t longest_ns = 10'000'000'000, clock_step_ns = 1'000'000;

/// Of xcb_query_extension_reply_t.
struct ExtensionReply {
    std::uint8_t type, pad;
    std::uint16_t sequence;
    std::uint32_t length;
    std::uint8_t present, opcode;
};

/// Of xcb_present_complete_notify_event_t, up to UST.
struct CompleteEvent {
    std::uint8_t type, extension;
    std::uint16_t sequence;
    std::uint32_t length;
    std::uint16_t event_type;
    std::uint8_t kind, mode;
    std::uint32_t id, window, number;
    std::uint64_t ust_us;
};
static_assert(offsetof(CompleteEvent, ust_us) == 24);

std::int64_t present_clock_ns() {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * std::int64_t{1'000'000'000} + t.tv_nsec;
}

}  // namespace

/// Of <xcb/xcb.h> and <xcb/present.h> what is called here.
struct PresentTimes::Functions {
    void* (*connect)(const char*, int*) = nullptr;
    int (*has_error)(void*) = nullptr;
    void (*disconnect)(void*) = nullptr;
    int (*file_descriptor)(void*) = nullptr;
    std::uint32_t (*generate_id)(void*) = nullptr;
    int (*flush)(void*) = nullptr;
    void* (*poll_for_event)(void*) = nullptr;
    const void* (*extension_data)(void*, void*) = nullptr;
    unsigned (*query_version)(void*, std::uint32_t, std::uint32_t) = nullptr;
    void* (*query_version_reply)(void*, unsigned, void**) = nullptr;
    unsigned (*select_input)(void*, std::uint32_t, std::uint32_t, std::uint32_t) = nullptr;
    void* present_id = nullptr;

    bool load() {
        const auto xcb = Library::open("libxcb.so.1", "libxcb1"),
                   present = Library::open("libxcb-present.so.0", "libxcb-present0");
        if (!xcb || !present) return false;
        present_id = present->find("xcb_present_id");
        return present_id != nullptr && xcb->get(connect, "xcb_connect") && xcb->get(has_error, "xcb_connection_has_error") &&
               xcb->get(disconnect, "xcb_disconnect") && xcb->get(file_descriptor, "xcb_get_file_descriptor") &&
               xcb->get(generate_id, "xcb_generate_id") && xcb->get(flush, "xcb_flush") &&
               xcb->get(poll_for_event, "xcb_poll_for_event") && xcb->get(extension_data, "xcb_get_extension_data") &&
               present->get(query_version, "xcb_present_query_version") &&
               present->get(query_version_reply, "xcb_present_query_version_reply") &&
               present->get(select_input, "xcb_present_select_input");
    }
};

std::unique_ptr<PresentTimes> PresentTimes::open(x11::Id window) {
    auto functions = std::make_unique<Functions>();
    if (!functions->load()) return nullptr;
    std::unique_ptr<PresentTimes> times(new PresentTimes());
    times->x_ = std::move(functions);
    const Functions& x = *times->x_;
    times->connection_ = x.connect(nullptr, nullptr);
    if (x.has_error(times->connection_) != 0) return nullptr;
    const auto* extension = static_cast<const ExtensionReply*>(x.extension_data(times->connection_, x.present_id));
    if (extension == nullptr || extension->present == 0) return nullptr;
    times->opcode_ = extension->opcode;
    void* version = x.query_version_reply(times->connection_, x.query_version(times->connection_, 1, 0), nullptr);
    if (version == nullptr) return nullptr;
    std::free(version);
    x.select_input(times->connection_, x.generate_id(times->connection_), static_cast<std::uint32_t>(window),
                   complete_notify_mask);
    x.flush(times->connection_);
    return times;
}

PresentTimes::~PresentTimes() {
    if (connection_ != nullptr) x_->disconnect(connection_);
}

void PresentTimes::handed() noexcept {
    ++number_;
    handed_ns_[number_ % handed_ns_.size()].store(present_clock_ns(), std::memory_order_relaxed);
}

int PresentTimes::fd() const { return x_->file_descriptor(connection_); }

bool PresentTimes::next(PresentedPicture& picture) {
    while (void* const from = x_->poll_for_event(connection_)) {
        CompleteEvent event{};
        std::memcpy(&event, from, sizeof event);
        std::free(from);
        if ((event.type & 0x7fU) != generic_event || event.extension != opcode_) continue;
        if (event.event_type != complete_notify || event.kind != of_pixmap) continue;
        picture.handed_ns = handed_ns_[event.number % handed_ns_.size()].load(std::memory_order_relaxed);
        picture.shown_ns = event.mode == skipped ? 0 : static_cast<std::int64_t>(event.ust_us) * 1000;
        const std::int64_t age_ns = picture.shown_ns - picture.handed_ns;
        const bool possible = picture.shown_ns == 0 || (age_ns > -clock_step_ns && age_ns < longest_ns);
        if (picture.handed_ns != 0 && possible) return true;
        ++passed_over_;
    }
    return false;
}

}  // namespace surefoot::gl
