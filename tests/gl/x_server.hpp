// An X server without a screen for tests (Xvfb), and a visitor at it: a client of its own that sends real keys and motions by
// XTEST, and looks at the screen. What is missing is an Error with the reason, so that a test can be skipped.
#pragma once

#include <dlfcn.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "render/gl/x11.hpp"
#include "rt/base/result.hpp"

namespace surefoot::test {

inline void wait_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

/// A server of this test alone. $DISPLAY is its name while it lives.
class XServer {
public:
    static Result<std::unique_ptr<XServer>> start(const char* screen = "640x480x24") {
        std::array<int, 2> from{};
        if (::pipe(from.data()) != 0) return Error{"Xvfb", "There is no pipe", "", ErrorKind::failed};
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, from[1], 9);
        posix_spawn_file_actions_addclose(&actions, from[0]);
        posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", 1, 0);
        const std::vector<const char*> words = {"Xvfb", "-displayfd", "9",   "-screen",    "0",
                                                screen, "-nolisten",  "tcp", "-terminate", nullptr};
        std::unique_ptr<XServer> server(new XServer());
        const int refused =
            ::posix_spawnp(&server->pid_, "Xvfb", &actions, nullptr, const_cast<char* const*>(words.data()), environ);
        posix_spawn_file_actions_destroy(&actions);
        ::close(from[1]);
        if (refused != 0) server->pid_ = -1;
        std::string number;
        pollfd answer{from[0], POLLIN, 0};
        for (char c = 0; refused == 0 && ::poll(&answer, 1, 5000) > 0 && ::read(from[0], &c, 1) == 1 && c != '\n';) number += c;
        ::close(from[0]);
        if (number.empty()) return Error{"Xvfb", "No X server can be started", "Install xvfb", ErrorKind::not_found};
        if (const char* before = std::getenv("DISPLAY")) server->before_ = before;
        ::setenv("DISPLAY", (":" + number).c_str(), 1);
        return server;
    }
    ~XServer() {
        if (pid_ <= 0) return;
        ::kill(pid_, SIGTERM);
        ::waitpid(pid_, nullptr, 0);
        if (before_.empty())
            ::unsetenv("DISPLAY");
        else
            ::setenv("DISPLAY", before_.c_str(), 1);
    }
    XServer(const XServer&) = delete;
    XServer& operator=(const XServer&) = delete;

private:
    XServer() = default;
    pid_t pid_ = -1;
    std::string before_;
};

/// A pixel of the screen.
struct ScreenPixel {
    int r = 0, g = 0, b = 0;
    bool operator==(const ScreenPixel&) const = default;
};

/// The screen, row 0 on top.
struct ScreenPicture {
    int width = 0, height = 0;
    std::vector<ScreenPixel> pixels;
    [[nodiscard]] const ScreenPixel& at(int x, int y) const {
        return pixels.at(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
    }
};

/// The visitor.
class XVisitor {
public:
    using Id = gl::x11::Id;

    static Result<std::unique_ptr<XVisitor>> come() {
        auto x = gl::x11::load();
        if (!x) return x.error();
        void* const xtest = ::dlopen("libXtst.so.6", RTLD_NOW | RTLD_LOCAL);
        void* const xlib = ::dlopen("libX11.so.6", RTLD_NOW | RTLD_LOCAL);
        if (xtest == nullptr) return Error{"libXtst.so.6", "Keys cannot be pressed", "Install libxtst6", ErrorKind::not_found};
        std::unique_ptr<XVisitor> visitor(new XVisitor(*x));
        const auto get = [](void* library, auto& function, const char* name) {
            function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(library, name));
        };
        get(xtest, visitor->fake_key_, "XTestFakeKeyEvent");
        get(xtest, visitor->fake_button_, "XTestFakeButtonEvent");
        get(xtest, visitor->fake_motion_, "XTestFakeMotionEvent");
        get(xlib, visitor->keycode_, "XKeysymToKeycode");
        get(xlib, visitor->query_tree_, "XQueryTree");
        get(xlib, visitor->get_image_, "XGetImage");
        get(xlib, visitor->repeat_, "XkbSetAutoRepeatRate");
        visitor->display_ = x->OpenDisplay(nullptr);
        if (visitor->display_ == nullptr) return Error{"Xvfb", "The X server does not answer", "", ErrorKind::no_device};
        return visitor;
    }
    ~XVisitor() {
        if (display_ != nullptr) x_.CloseDisplay(display_);
    }
    XVisitor(const XVisitor&) = delete;
    XVisitor& operator=(const XVisitor&) = delete;

    /// The first window on the screen; 0: none comes within two seconds.
    Id find_window() {
        for (int i = 0; i < 200; ++i) {
            Id root = 0, parent = 0, *children = nullptr;
            unsigned count = 0;
            query_tree_(display_, x_.DefaultRootWindow(display_), &root, &parent, &children, &count);
            const Id found = count > 0 ? children[0] : 0;
            if (children != nullptr) x_.Free(children);
            if (found != 0) return found;
            wait_ms(10);
        }
        return 0;
    }
    void key(unsigned long symbol, bool down) {
        fake_key_(display_, keycode_(display_, symbol), down ? 1 : 0, 0);
        x_.Sync(display_, 0);
    }
    /// How soon a held key repeats, and how often.
    void set_repeat(unsigned delay_ms, unsigned interval_ms) {
        repeat_(display_, 0x100, delay_ms, interval_ms);
        x_.Sync(display_, 0);
    }
    void tap(unsigned long symbol) {
        key(symbol, true);
        key(symbol, false);
    }
    void button(unsigned number, bool down) {
        fake_button_(display_, number, down ? 1 : 0, 0);
        x_.Sync(display_, 0);
    }
    void move_to(int x, int y) {
        fake_motion_(display_, -1, x, y, 0);
        x_.Sync(display_, 0);
    }
    /// A window of this client takes the keyboard.
    void take_focus() {
        const Id other = x_.CreateSimpleWindow(display_, x_.DefaultRootWindow(display_), 0, 0, 1, 1, 0, 0, 0);
        x_.MapWindow(display_, other);
        x_.Sync(display_, 0);
        x_.SetInputFocus(display_, other, 1, 0);
        x_.Sync(display_, 0);
    }
    void give_focus(Id window) {
        x_.SetInputFocus(display_, window, 1, 0);
        x_.Sync(display_, 0);
    }
    /// The keyboard follows the pointer: no window owns it.
    void let_focus_follow_pointer() {
        x_.SetInputFocus(display_, 1, 0, 0);
        x_.Sync(display_, 0);
    }
    void resize(Id window, unsigned width, unsigned height) {
        x_.MoveResizeWindow(display_, window, 0, 0, width, height);
        x_.Sync(display_, 0);
    }
    /// As a window manager closes it.
    void close(Id window) {
        gl::x11::Event event{};
        event.message.any.type = 33;
        event.message.any.window = window;
        event.message.type = x_.InternAtom(display_, "WM_PROTOCOLS", 0);
        event.message.format = 32;
        event.message.data[0] = static_cast<long>(x_.InternAtom(display_, "WM_DELETE_WINDOW", 0));
        x_.SendEvent(display_, window, 0, 0, &event);
        x_.Sync(display_, 0);
    }
    ScreenPicture look_at_screen() {
        ScreenPicture picture;
        const int screen = x_.DefaultScreen(display_);
        picture.width = x_.DisplayWidth(display_, screen);
        picture.height = x_.DisplayHeight(display_, screen);
        Image* const image = get_image_(display_, x_.DefaultRootWindow(display_), 0, 0, static_cast<unsigned>(picture.width),
                                        static_cast<unsigned>(picture.height), ~0UL, 2);
        if (image == nullptr) return {};
        picture.pixels.resize(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x) {
                const auto* p = reinterpret_cast<const unsigned char*>(image->data) + y * image->bytes_per_line + 4 * x;
                picture.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                               static_cast<std::size_t>(x)] = {p[2], p[1], p[0]};
            }
        std::free(image->data);
        std::free(image);
        return picture;
    }

private:
    explicit XVisitor(const gl::x11::Functions& x) : x_(x) {}

    /// Of an XImage what is read: it begins so.
    struct Image {
        int width, height, offset, format;
        char* data;
        int byte_order, unit, bit_order, pad, depth, bytes_per_line, bits_per_pixel;
    };

    gl::x11::Functions x_;
    gl::x11::Display* display_ = nullptr;
    int (*fake_key_)(gl::x11::Display*, unsigned, int, unsigned long) = nullptr;
    int (*fake_button_)(gl::x11::Display*, unsigned, int, unsigned long) = nullptr;
    int (*fake_motion_)(gl::x11::Display*, int, int, int, unsigned long) = nullptr;
    int (*repeat_)(gl::x11::Display*, unsigned, unsigned, unsigned) = nullptr;
    unsigned char (*keycode_)(gl::x11::Display*, unsigned long) = nullptr;
    int (*query_tree_)(gl::x11::Display*, Id, Id*, Id*, Id**, unsigned*) = nullptr;
    Image* (*get_image_)(gl::x11::Display*, Id, int, int, unsigned, unsigned, unsigned long, int) = nullptr;
};

}  // namespace surefoot::test
