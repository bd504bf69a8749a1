// When pictures were shown, by the server's Present extension: a client presents real pixmaps on a window, and their times come.
#include "render/gl/present_times.hpp"

#include <gtest/gtest.h>

#include <dlfcn.h>
#include <time.h>

#include "render/gl/window_events.hpp"
#include "tests/gl/x_server.hpp"

namespace surefoot {
namespace {

/// Presents pixmaps as a driver does.
class Presenter {
public:
    Presenter() {
        void* const xcb = ::dlopen("libxcb.so.1", RTLD_NOW | RTLD_LOCAL);
        void* const present = ::dlopen("libxcb-present.so.0", RTLD_NOW | RTLD_LOCAL);
        const auto get = [](void* library, auto& function, const char* name) {
            function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(library, name));
        };
        get(xcb, connect_, "xcb_connect");
        get(xcb, disconnect_, "xcb_disconnect");
        get(xcb, generate_id_, "xcb_generate_id");
        get(xcb, create_pixmap_, "xcb_create_pixmap");
        get(xcb, flush_, "xcb_flush");
        get(present, present_pixmap_, "xcb_present_pixmap");
        connection_ = connect_(nullptr, nullptr);
    }
    ~Presenter() { disconnect_(connection_); }
    Presenter(const Presenter&) = delete;
    Presenter& operator=(const Presenter&) = delete;

    void present(gl::x11::Id window, std::uint32_t number) {
        const auto drawable = static_cast<std::uint32_t>(window);
        const std::uint32_t pixmap = generate_id_(connection_);
        create_pixmap_(connection_, 24, pixmap, drawable, 64, 64);
        present_pixmap_(connection_, drawable, pixmap, number, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, nullptr);
        flush_(connection_);
    }

private:
    void* connection_ = nullptr;
    void* (*connect_)(const char*, int*) = nullptr;
    void (*disconnect_)(void*) = nullptr;
    std::uint32_t (*generate_id_)(void*) = nullptr;
    unsigned (*create_pixmap_)(void*, std::uint8_t, std::uint32_t, std::uint32_t, std::uint16_t, std::uint16_t) = nullptr;
    int (*flush_)(void*) = nullptr;
    unsigned (*present_pixmap_)(void*, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, std::int16_t,
                                std::int16_t, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, std::uint64_t,
                                std::uint64_t, std::uint64_t, std::uint32_t, const void*) = nullptr;
};

std::int64_t now_ns() {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * std::int64_t{1'000'000'000} + t.tv_nsec;
}

TEST(PresentTimes, AreThoseAtWhichTheServerShowedEachPicture) {
    auto server = test::XServer::start();
    if (!server) GTEST_SKIP() << server.error().text();
    auto window = gl::WindowEvents::open({64, 64}, "test", false);
    if (!window) GTEST_SKIP() << window.error().text();
    gl::PresentTimes* const times = (*window)->present_times();
    if (times == nullptr) GTEST_SKIP() << "the server has no Present extension, or libxcb-present0 is not there";
    Presenter driver;
    gl::PresentedPicture picture;
    for (std::uint32_t number = 1; number <= 3; ++number) {
        const std::int64_t before_ns = now_ns();
        times->handed();
        driver.present((*window)->id(), number);
        int waited = 0;
        while (!times->next(picture) && ++waited < 400) test::wait_ms(5);
        ASSERT_LT(waited, 400) << "picture " << number << " was not reported";
        EXPECT_GE(picture.handed_ns, before_ns);
        EXPECT_GT(picture.shown_ns, picture.handed_ns - 1'000'000) << "to the server's microsecond";
        EXPECT_LE(picture.shown_ns, now_ns() + 1'000'000) << "of the same clock";
    }
    driver.present((*window)->id(), 77);  // nobody handed such a picture over
    for (int i = 0; i < 100 && times->passed_over() == 0; ++i) {
        EXPECT_FALSE(times->next(picture));
        test::wait_ms(5);
    }
    EXPECT_EQ(times->passed_over(), 1U);
}

}  // namespace
}  // namespace surefoot
