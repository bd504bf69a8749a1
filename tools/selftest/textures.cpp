// Rows: textures by their sizes: none, one texel, odd ones, the largest, one beyond it, promised but not there, without colour.
#include <algorithm>
#include <array>
#include <fstream>
#include <limits>

#include <png.h>

#include "render/import/scene.hpp"
#include "tools/selftest/families.hpp"
#include "tools/selftest/fixtures.hpp"

namespace surefoot::selftest {

namespace {

constexpr std::uint32_t largest_side = 16384;

struct Tried {
    bool taken = false;
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgba;
    std::string what;
};

Tried tried(const Bytes& bytes) {
    auto image = image::decode_image(bytes, "fixture");
    if (!image) return {false, 0, 0, {}, image.error().what};
    return {true, image->width, image->height, std::move(image->rgba), {}};
}

/// The largest that this process's memory was since the last call of `forget_peak`, MiB; what came before, where that is refused.
void forget_peak() { std::ofstream("/proc/self/clear_refs") << 5; }
double peak_mib() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024;
    return std::numeric_limits<double>::quiet_NaN();
}

void put_big_endian(Bytes& bytes, std::size_t at, std::uint32_t value, int count) {
    for (int i = 0; i < count; ++i)
        bytes[at + static_cast<std::size_t>(i)] = static_cast<std::byte>(value >> (8 * (count - 1 - i)));
}

/// CRC 32 of PNG's chunks (ISO 3309), so that a changed size is not refused for its checksum.
std::uint32_t crc_of(std::span<const std::byte> bytes) {
    std::uint32_t crc = 0xffffffffU;
    for (const std::byte b : bytes) {
        crc ^= std::to_integer<std::uint32_t>(b);
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
    }
    return ~crc;
}

/// The same file, said to be of another size.
Bytes png_that_promises(std::uint32_t width, std::uint32_t height) {
    Bytes png = png_fixture(2, 2);
    put_big_endian(png, 16, width, 4);
    put_big_endian(png, 20, height, 4);
    put_big_endian(png, 29, crc_of(std::span(png).subspan(12, 17)), 4);
    return png;
}

Bytes jpeg_that_promises(std::uint32_t width, std::uint32_t height) {
    Bytes jpeg = jpeg_fixture(2, 2, false);
    const std::array frame = {std::byte{0xff}, std::byte{0xc0}};
    const auto at = static_cast<std::size_t>(std::search(jpeg.begin(), jpeg.end(), frame.begin(), frame.end()) - jpeg.begin());
    put_big_endian(jpeg, at + 5, height, 2);
    put_big_endian(jpeg, at + 7, width, 2);
    return jpeg;
}

/// Brightness and opacity only, which is how masks are kept.
Bytes grey_and_alpha(std::span<const std::uint8_t> pairs, std::uint32_t width, std::uint32_t height) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = width;
    png.height = height;
    png.format = PNG_FORMAT_GA;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
    Bytes bytes(size);
    if (png_image_write_to_memory(&png, bytes.data(), &size, 0, pairs.data(), 0, nullptr) == 0) size = 0;
    bytes.resize(size);
    return bytes;
}

void sizes(const Effort&, Outcome& out) {
    std::uint64_t wrong = 0;
    constexpr std::array<std::array<std::uint32_t, 2>, 6> good = {
        {{1, 1}, {3, 5}, {1, 7}, {255, 257}, {largest_side, 1}, {1, largest_side}}};
    for (const auto& [width, height] : good) {
        for (const Bytes& bytes :
             {png_fixture(width, height), jpeg_fixture(width, height, false), jpeg_fixture(width, height, true)}) {
            const Tried t = tried(bytes);
            wrong += t.taken && t.width == width && t.height == height && t.rgba.size() == 4ULL * width * height ? 0 : 1;
        }
    }
    out.none_of("pictures of 1x1, 3x5, 1x7, 255x257, 16384x1, 1x16384 that are not read whole", wrong);

    forget_peak();
    const double before = peak_mib();
    std::uint64_t taken = 0, other = 0;
    const auto refused = [&](const Bytes& bytes, std::string_view word) {
        const Tried t = tried(bytes);
        taken += t.taken ? 1 : 0;
        other += t.what.find(word) == std::string::npos ? 1 : 0;
        out.digest_of(t.what);
    };
    refused(png_that_promises(largest_side + 1, 1), "larger than 16384");
    refused(jpeg_that_promises(largest_side + 1, 1), "larger than 16384");
    refused(jpeg_that_promises(1, 65000), "larger than 16384");
    refused(png_that_promises(largest_side, largest_side), "truncated");
    refused(jpeg_that_promises(largest_side, largest_side), "truncated");
    refused(png_that_promises(0, 0), "PNG");
    refused(png_that_promises(0x80000000U, 1), "PNG");
    refused(jpeg_that_promises(0, 2), "JPEG");
    out.none_of("pictures of 0x0, 16385x1, and of 16384x16384 in some hundred bytes, that are taken", taken);
    out.none_of("of these, refused for another reason than their size", other);
    out.at_most("memory that refusing them took", peak_mib() - before, 64, "MiB");

    constexpr std::array<std::uint8_t, 8> pairs = {0, 255, 10, 0, 200, 128, 255, 1};
    const Tried mask = tried(grey_and_alpha(pairs, 2, 2));
    std::uint64_t off = mask.rgba.size() == 16 ? 0 : 1;
    for (std::size_t i = 0; off == 0 && i < 4; ++i) {
        for (std::size_t c = 0; c < 3; ++c) off += mask.rgba[4 * i + c] != pairs[2 * i] ? 1 : 0;
        off += mask.rgba[4 * i + 3] != pairs[2 * i + 1] ? 1 : 0;
    }
    out.none_of("channels off in a picture of brightness and opacity", off);
}

}  // namespace

std::span<const Row> texture_rows() {
    static constexpr std::array<Row, 1> table = {{
        {"N21c", "textures", "PNG and JPEG of no, odd, largest and larger sizes; sizes promised and not there; no colour",
         "read whole, or refused by its size before memory is taken for it", sizes},
    }};
    return table;
}

}  // namespace surefoot::selftest
