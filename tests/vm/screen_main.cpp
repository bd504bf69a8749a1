// What a guest needs to judge a screen: compares a dump with a picture, and holds a card as another program would.
#include <fcntl.h>
#include <linux/kd.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "render/gl/device.hpp"
#include "render/image/image.hpp"
#include "rt/base/file.hpp"

namespace {

using namespace surefoot;

/// A binary PPM of 8 bits, as QEMU writes it.
Result<image::Image> read_ppm(const std::string& file) {
    const auto bytes = read_file(file);
    if (!bytes) return bytes.error();
    const std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    unsigned width = 0, height = 0, max = 0;
    int header = 0;
    if (std::sscanf(text.c_str(), "P6 %u %u %u%n", &width, &height, &max, &header) != 3 || max != 255 ||
        text.size() != static_cast<std::size_t>(header) + 1 + 3ULL * width * height)
        return Error{file, "This is no binary PPM of 8 bits", ""};
    image::Image picture;
    picture.width = width;
    picture.height = height;
    const auto* rgb = reinterpret_cast<const std::uint8_t*>(text.data()) + header + 1;
    for (std::size_t i = 0; i < std::size_t{width} * height; ++i)
        picture.rgba.insert(picture.rgba.end(), {rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2], 255});
    return picture;
}

/// half_turn: the dump stands on its head.
int compare(const std::string& png, const std::string& ppm, bool half_turn) {
    const auto bytes = read_file(png);
    const auto wanted = bytes ? image::decode_image(*bytes, png) : Result<image::Image>(bytes.error());
    const auto shown = read_ppm(ppm);
    if (!wanted || !shown) {
        std::printf("%s\n", (wanted ? shown.error() : wanted.error()).text().c_str());
        return 1;
    }
    if (wanted->width != shown->width || wanted->height != shown->height) {
        std::printf("%ux%u on the screen, %ux%u in the picture\n", shown->width, shown->height, wanted->width, wanted->height);
        return 1;
    }
    const std::size_t pixels = std::size_t{wanted->width} * wanted->height;
    std::size_t differing = 0, bright = 0;
    int max = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        const std::size_t at = half_turn ? pixels - 1 - i : i;
        int differs = 0;
        for (std::size_t c = 0; c < 3; ++c)
            differs = std::max(differs, std::abs(wanted->rgba[4 * i + c] - shown->rgba[4 * at + c]));
        differing += differs > 0 ? 1 : 0;
        max = std::max(max, differs);
        bright += wanted->rgba[4 * i] + wanted->rgba[4 * i + 1] + wanted->rgba[4 * i + 2] > 60 ? 1 : 0;
    }
    std::printf("%zu of %zu pixels differ, by up to %d; %zu are not black\n", differing, pixels, max, bright);
    return differing == 0 && bright > pixels / 10 ? 0 : 1;
}

/// Prints the checksum that vkms gives a picture: of 16 bits a channel in the order alpha, red, green, blue; begun with 0, not
/// inverted.
int checksum(const std::string& png) {
    const auto bytes = read_file(png);
    const auto picture = bytes ? image::decode_image(*bytes, png) : Result<image::Image>(bytes.error());
    if (!picture) {
        std::printf("%s\n", picture.error().text().c_str());
        return 1;
    }
    std::vector<std::uint16_t> channels;
    for (std::size_t i = 0; i < picture->rgba.size(); i += 4) {
        channels.push_back(0xffff);
        for (std::size_t c = 0; c < 3; ++c) channels.push_back(static_cast<std::uint16_t>(picture->rgba[i + c] * 257));
    }
    // zlib inverts before and after.
    const auto* const from = reinterpret_cast<const Bytef*>(channels.data());
    const uLong inverted = ::crc32(0xffffffffUL, from, static_cast<uInt>(2 * channels.size()));
    std::printf("0x%08lx\n", ~inverted & 0xffffffffUL);
    return 0;
}

/// Until it is killed, or stdin ends.
int hold(const char* card) {
    const int file = ::open(card, O_RDWR | O_CLOEXEC);
    constexpr unsigned long set_master = _IO('d', 0x1e);
    if (file < 0 || ::ioctl(file, set_master) != 0) {
        std::printf("%s: %s\n", card, std::strerror(errno));
        return 1;
    }
    std::printf("holds %s\n", card);
    std::fflush(stdout);
    char byte = 0;
    while (::read(STDIN_FILENO, &byte, 1) > 0) {
    }
    return 0;
}

/// Buffers of GBM under a software renderer, until stdin ends.
int show_sky(const char* screen, const char* mode) {
    gl::DeviceOptions options;
    options.kind = gl::BackendKind::kms;
    options.viewport = {640, 480};
    options.screen.name = screen;
    options.screen.mode = mode;
    options.screen.software_by_gbm = true;
    options.sky = {32 / 255.0F, 160 / 255.0F, 224 / 255.0F};
    const auto device = gl::open_device(options);
    if (!device) {
        std::printf("%s\n", device.error().text().c_str());
        return 1;
    }
    (*device)->draws.plays();
    int shown = 0;
    for (int i = 0; i < 8; ++i) shown += (*device)->present().by != rt::ShownBy::nothing ? 1 : 0;
    std::printf("shows %d of 8 pictures, %s\n", shown, (*device)->renderer().c_str());
    std::fflush(stdout);
    char byte = 0;
    while (::read(STDIN_FILENO, &byte, 1) > 0) {
    }
    return shown == 8 ? 0 : 1;
}

int uniform(const std::string& ppm, int red, int green, int blue) {
    const auto shown = read_ppm(ppm);
    if (!shown) {
        std::printf("%s\n", shown.error().text().c_str());
        return 1;
    }
    std::size_t others = 0;
    for (std::size_t i = 0; i < shown->rgba.size(); i += 4)
        others += shown->rgba[i] != red || shown->rgba[i + 1] != green || shown->rgba[i + 2] != blue ? 1 : 0;
    std::printf("%zu of %zu pixels have another colour", others, shown->rgba.size() / 4);
    return others == 0 ? 0 : 1;
}

/// Whether a console draws text or leaves the screen to others, and whether it takes keys.
int console(const char* tty) {
    const int file = ::open(tty, O_RDWR | O_CLOEXEC | O_NOCTTY);
    int mode = -1, keyboard = -1;
    if (file < 0 || ::ioctl(file, KDGETMODE, &mode) != 0 || ::ioctl(file, KDGKBMODE, &keyboard) != 0) {
        std::printf("%s: %s\n", tty, std::strerror(errno));
        return 1;
    }
    std::printf("%s, keyboard %s\n", mode == KD_GRAPHICS ? "graphics" : "text", keyboard == K_OFF ? "off" : "on");
    return 0;
}

}  // namespace

int main(int count, char** arguments) {
    const std::string command = count > 1 ? arguments[1] : "";
    if (command == "hold" && count == 3) return hold(arguments[2]);
    if (command == "same" && (count == 4 || count == 5)) return compare(arguments[2], arguments[3], count == 5);
    if (command == "checksum" && count == 3) return checksum(arguments[2]);
    if (command == "console" && count == 3) return console(arguments[2]);
    if (command == "sky" && count == 4) return show_sky(arguments[2], arguments[3]);
    if (command == "uniform" && count == 6)
        return uniform(arguments[2], std::atoi(arguments[3]), std::atoi(arguments[4]), std::atoi(arguments[5]));
    std::fprintf(
        stderr,
        "usage: vm_screen same PICTURE.png DUMP.ppm [half-turn] | uniform DUMP.ppm RED GREEN BLUE | hold /dev/dri/cardN | "
        "sky SCREEN MODE | console /dev/ttyN | checksum PICTURE.png\n");
    return 2;
}
