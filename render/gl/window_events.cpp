// Events of a window, and what is ordered from the X server.
#include "render/gl/window_events.hpp"

#include <time.h>

#include <algorithm>
#include <cstdlib>

namespace surefoot::gl {

namespace {

// Of <X11/X.h>.
constexpr int key_press = 2, key_release = 3, button_press = 4, button_release = 5, motion_notify = 6, leave_notify = 8,
              focus_in = 9, focus_out = 10, keymap_notify = 11, map_notify = 19, configure_notify = 22, client_message = 33,
              mapping_notify = 34;
constexpr long key_press_mask = 1L << 0, key_release_mask = 1L << 1, button_press_mask = 1L << 2, button_release_mask = 1L << 3,
               leave_mask = 1L << 5, motion_mask = 1L << 6, keymap_mask = 1L << 14, structure_mask = 1L << 17,
               redirect_mask = 1L << 20, notify_mask = 1L << 19, focus_mask = 1L << 21;
constexpr long wanted_events = key_press_mask | key_release_mask | button_press_mask | button_release_mask | leave_mask |
                               motion_mask | keymap_mask | structure_mask | focus_mask;
constexpr unsigned pointer_events = static_cast<unsigned>(button_press_mask | button_release_mask | motion_mask);
constexpr int notify_pointer = 5;  // a detail of FocusIn
constexpr int revert_to_root = 1, grab_asynchronously = 1, replace = 0;
constexpr x11::Id atom_of_atoms = 4, any_type = 0;
constexpr unsigned long now = 0;

std::int64_t monotonic_ns() {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * std::int64_t{1'000'000'000} + t.tv_nsec;
}

}  // namespace

Result<std::shared_ptr<WindowEvents>> WindowEvents::open(model::Viewport viewport, const std::string& title, bool fullscreen) {
    auto x = x11::load();
    if (!x) return x.error();
    const char* where = std::getenv("DISPLAY");
    const std::string remedy = "Run inside an X session, start one with `Xvfb :99 &` and set DISPLAY=:99, or use --backend egl";
    if (where == nullptr || *where == 0) return Error{"window", "DISPLAY is not set", remedy, ErrorKind::no_device};
    std::shared_ptr<WindowEvents> window(new WindowEvents(*x));
    window->display_ = x->OpenDisplay(where);
    if (window->display_ == nullptr)
        return Error{"window", std::string("No X server answers at DISPLAY ") + where, remedy, ErrorKind::no_device};
    x11::count_refusals(*x);
    const std::uint32_t before = x11::refusals().count;
    window->fullscreen_ = fullscreen;
    window->show(viewport, title);
    if (const x11::Refusals after = x11::refusals(); after.count != before)
        return Error{"window", "The X server refuses the window: " + after.text(), "Choose another --size, or use --backend egl",
                     ErrorKind::no_device};
    window->times_ = PresentTimes::open(window->window_);
    return window;
}

WindowEvents::~WindowEvents() {
    if (display_ == nullptr) return;
    if (window_ != 0) x_.DestroyWindow(display_, window_);
    x_.CloseDisplay(display_);
}

void WindowEvents::show(model::Viewport viewport, const std::string& title) {
    before_ = {viewport.width, viewport.height};
    WindowSize size = before_;
    const bool managed = is_managed();
    if (fullscreen_ && !managed) {
        const int screen = x_.DefaultScreen(display_);
        size = {static_cast<std::uint32_t>(x_.DisplayWidth(display_, screen)),
                static_cast<std::uint32_t>(x_.DisplayHeight(display_, screen))};
    }
    size_.store((std::uint64_t{size.width} << 32U) | size.height);
    window_ = x_.CreateSimpleWindow(display_, x_.DefaultRootWindow(display_), 0, 0, size.width, size.height, 0, 0, 0);
    x_.SelectInput(display_, window_, wanted_events);
    int detectable = 0;
    x_.SetDetectableAutoRepeat(display_, 1, &detectable);
    // Closing is the program's to decide: without this the window manager would cut the connection, and Xlib exit().
    closing_ = x_.InternAtom(display_, "WM_DELETE_WINDOW", 0);
    protocols_ = x_.InternAtom(display_, "WM_PROTOCOLS", 0);
    state_ = x_.InternAtom(display_, "_NET_WM_STATE", 0);
    state_fullscreen_ = x_.InternAtom(display_, "_NET_WM_STATE_FULLSCREEN", 0);
    x_.SetWMProtocols(display_, window_, &closing_, 1);
    if (fullscreen_ && managed) {
        const auto* wanted = reinterpret_cast<const unsigned char*>(&state_fullscreen_);
        x_.ChangeProperty(display_, window_, state_, atom_of_atoms, 32, replace, wanted, 1);
    }
    make_hidden_cursor();
    x_.StoreName(display_, window_, title.c_str());
    x_.MapWindow(display_, window_);
    x_.Sync(display_, 0);
}

void WindowEvents::make_hidden_cursor() {
    constexpr char nothing[1] = {0};
    std::array<unsigned long, 2> black{};  // an XColor
    const x11::Id empty = x_.CreateBitmapFromData(display_, window_, nothing, 1, 1);
    hidden_cursor_ = x_.CreatePixmapCursor(display_, empty, empty, black.data(), black.data(), 0, 0);
    x_.FreePixmap(display_, empty);
}

/// Whether a window manager runs: it names a window of its own on the root.
bool WindowEvents::is_managed() const {
    const x11::Id check = x_.InternAtom(display_, "_NET_SUPPORTING_WM_CHECK", 0);
    x11::Id type = 0;
    int format = 0;
    unsigned long items = 0, left = 0;
    unsigned char* data = nullptr;
    x_.GetWindowProperty(display_, x_.DefaultRootWindow(display_), check, 0, 1, 0, any_type, &type, &format, &items, &left,
                         &data);
    if (data != nullptr) x_.Free(data);
    return items > 0;
}

int WindowEvents::fd() const { return x_.ConnectionNumber(display_); }

bool WindowEvents::next(WindowEvent& event) {
    while (x_.Pending(display_) > 0) {
        x11::Event from{};
        x_.NextEvent(display_, &from);
        event = {};
        if (translate(from, event)) {
            event.stamp_ns = monotonic_ns();
            return true;
        }
    }
    return false;
}

bool WindowEvents::translate(x11::Event& from, WindowEvent& event) {
    using Kind = WindowEvent::Kind;
    switch (from.type) {
        case key_press:
        case key_release:
            event.kind = from.type == key_press ? Kind::key_down : Kind::key_up;
            event.code = from.pointer.detail & 0xffU;
            event.symbol = static_cast<std::uint32_t>(x_.KeycodeToKeysym(display_, static_cast<unsigned char>(event.code), 0, 0));
            return true;
        case button_press:
        case button_release:
        case motion_notify:
            event.kind = from.type == button_press     ? Kind::button_down
                         : from.type == button_release ? Kind::button_up
                                                       : Kind::motion;
            event.code = from.type == motion_notify ? 0 : from.pointer.detail;
            event.x = from.pointer.x;
            event.y = from.pointer.y;
            event.x_screen = from.pointer.x_root;
            event.y_screen = from.pointer.y_root;
            return true;
        case leave_notify:
            event.kind = Kind::pointer_out;
            return true;
        case focus_in:
        case focus_out:
            event.kind = from.type == focus_in ? Kind::focus_in : Kind::focus_out;
            // Keys come only while the pointer is here: the window does not own the keyboard.
            return from.type == focus_out || from.focus.detail != notify_pointer;
        case keymap_notify:
            event.kind = Kind::held_keys;
            std::copy_n(from.keymap.keys, event.held.size(), event.held.begin());
            return true;
        case map_notify:
            take_focus();
            return false;
        case configure_notify:
            return translate_configure(from.configure, event);
        case client_message:
            event.kind = Kind::close;
            return from.message.type == protocols_ && static_cast<x11::Id>(from.message.data[0]) == closing_;
        case mapping_notify:
            x_.RefreshKeyboardMapping(&from);
            return false;
        default:
            return false;
    }
}

bool WindowEvents::translate_configure(const x11::ConfigureEvent& from, WindowEvent& event) {
    const WindowSize size{static_cast<std::uint32_t>(std::max(1, from.width)),
                          static_cast<std::uint32_t>(std::max(1, from.height))};
    x_px_ = from.x;
    y_px_ = from.y;
    size_.store((std::uint64_t{size.width} << 32U) | size.height);
    event.kind = WindowEvent::Kind::resized;
    event.x = from.width;
    event.y = from.height;
    return true;
}

/// Where nobody manages windows, nobody gives the keyboard to them either.
void WindowEvents::take_focus() {
    if (!is_managed()) x_.SetInputFocus(display_, window_, revert_to_root, now);
}

bool WindowEvents::capture() {
    return x_.GrabPointer(display_, window_, 1, pointer_events, grab_asynchronously, grab_asynchronously, window_, hidden_cursor_,
                          now) == 0;
}

void WindowEvents::release() {
    x_.UngrabPointer(display_, now);
    x_.Flush(display_);
}

void WindowEvents::centre_pointer() {
    const WindowSize at = size();
    x_.WarpPointer(display_, 0, window_, 0, 0, 0, 0, static_cast<int>(at.width / 2), static_cast<int>(at.height / 2));
    x_.Flush(display_);
}

void WindowEvents::request_state(bool add) {
    x11::Event request{};
    request.message.any.type = client_message;
    request.message.any.window = window_;
    request.message.type = state_;
    request.message.format = 32;
    request.message.data[0] = add ? 1 : 0;
    request.message.data[1] = static_cast<long>(state_fullscreen_);
    request.message.data[3] = 1;  // asked for by an ordinary program
    x_.SendEvent(display_, x_.DefaultRootWindow(display_), 0, redirect_mask | notify_mask, &request);
}

void WindowEvents::toggle_fullscreen() {
    fullscreen_ = !fullscreen_;
    if (is_managed()) {
        request_state(fullscreen_);
    } else if (fullscreen_) {
        const int screen = x_.DefaultScreen(display_);
        before_ = size();
        before_x_ = x_px_;
        before_y_ = y_px_;
        x_.MoveResizeWindow(display_, window_, 0, 0, static_cast<unsigned>(x_.DisplayWidth(display_, screen)),
                            static_cast<unsigned>(x_.DisplayHeight(display_, screen)));
    } else {
        x_.MoveResizeWindow(display_, window_, before_x_, before_y_, before_.width, before_.height);
    }
    x_.Flush(display_);
}

WindowSize WindowEvents::size() const {
    const std::uint64_t both = size_.load(std::memory_order_relaxed);
    return {static_cast<std::uint32_t>(both >> 32U), static_cast<std::uint32_t>(both & 0xffffffffU)};
}

}  // namespace surefoot::gl
