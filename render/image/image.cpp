// Pictures in and out of memory: PNG through libpng's simplified interface, JPEG through libjpeg.
#include <png.h>

#include <array>
#include <csetjmp>
#include <cstdio>
#include <cstring>

#include <jerror.h>
#include <jpeglib.h>

#include <fmt/format.h>

#include "render/image/image.hpp"
#include "rt/base/file.hpp"

namespace surefoot::image {
namespace {

constexpr std::uint32_t largest_side = 16384;
/// No deflate stream unpacks to more than this many times its size: a smaller file cannot hold the picture it promises.
constexpr std::uint64_t max_unpacked = 1040;
/// Nor does a JPEG of 1 bit for 8 x 8 texels of brightness hold more than these texels a byte. (Arithmetic coding could, of
/// one colour throughout.)
constexpr std::uint64_t max_jpeg_texels_a_byte = 8 * 64;
/// Of a progressive JPEG: each goes over the whole picture, and a file of some kilobytes could ask for thousands.
constexpr int max_jpeg_scans = 200;

Error bad_image(const std::string& place, std::string what) {
    return Error{place, std::move(what), "Export the picture again as PNG or JPEG", ErrorKind::damaged};
}

/// Before any allocation. `packed` is how many bytes hold it.
Result<void> check_size(const std::string& place, std::uint64_t width, std::uint64_t height) {
    if (width == 0 || height == 0) return bad_image(place, "The picture has no pixels");
    if (width > largest_side || height > largest_side) {
        return Error{place, fmt::format("The picture of {} x {} texels is larger than {}", width, height, largest_side),
                     "Scale it down", ErrorKind::out_of_limits};
    }
    return {};
}

Result<Image> decode_png(std::span<const std::byte> bytes, const std::string& place) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) == 0)
        return bad_image(place, fmt::format("The PNG is damaged: {}", png.message));
    if (auto fits = check_size(place, png.width, png.height); !fits) {
        png_image_free(&png);
        return fits.error();
    }
    const std::uint64_t min_unpacked = std::uint64_t{png.width} * png.height / 8;  // 1 bit a texel at least
    if (min_unpacked > max_unpacked * bytes.size()) {
        png_image_free(&png);
        return bad_image(place, "The PNG is truncated");
    }
    Image image;
    image.width = png.width;
    image.height = png.height;
    png.format = PNG_FORMAT_RGBA;
    image.rgba.resize(PNG_IMAGE_SIZE(png));
    if (png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr) == 0) {
        return bad_image(place, fmt::format("The PNG is damaged or truncated: {}", png.message));
    }
    return image;
}

/// libjpeg reports fatal errors by a call that must not return: it jumps back to decode_jpeg.
struct JpegErrors {
    jpeg_error_mgr base;
    std::jmp_buf jump;
    bool truncated;
    jpeg_progress_mgr progress;
    std::array<char, JMSG_LENGTH_MAX> message;
};

void jpeg_fatal(j_common_ptr state) {
    auto* errors = reinterpret_cast<JpegErrors*>(state->err);
    errors->base.format_message(state, errors->message.data());
    std::longjmp(errors->jump, 1);
}

/// libjpeg pads a truncated file with grey and only warns: here that is an error.
void jpeg_message(j_common_ptr state, int level) {
    auto* errors = reinterpret_cast<JpegErrors*>(state->err);
    if (level < 0) ++errors->base.num_warnings;
    if (level < 0 && (errors->base.msg_code == JWRN_JPEG_EOF || errors->base.msg_code == JWRN_HIT_MARKER))
        errors->truncated = true;
}

void jpeg_scanned(j_common_ptr state) {
    auto* errors = reinterpret_cast<JpegErrors*>(state->err);
    if (reinterpret_cast<j_decompress_ptr>(state)->input_scan_number <= max_jpeg_scans) return;
    *fmt::format_to_n(errors->message.begin(), errors->message.size() - 1, "more than {} scans", max_jpeg_scans).out = '\0';
    std::longjmp(errors->jump, 1);
}

/// Reads the header; false on error. No object with a destructor may live in a function that setjmp returns to twice.
bool jpeg_begin(jpeg_decompress_struct& jpeg, JpegErrors& errors, std::span<const std::byte> bytes) {
    if (setjmp(errors.jump) != 0) return false;
    jpeg_create_decompress(&jpeg);
    errors.progress.progress_monitor = jpeg_scanned;
    jpeg.progress = &errors.progress;
    jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_read_header(&jpeg, TRUE);
    const bool inks = jpeg.jpeg_color_space == JCS_CMYK || jpeg.jpeg_color_space == JCS_YCCK;
    jpeg.out_color_space = inks ? JCS_CMYK : JCS_EXT_RGBA;
    return true;
}

bool jpeg_rows(jpeg_decompress_struct& jpeg, JpegErrors& errors, std::uint8_t* rgba) {
    if (setjmp(errors.jump) != 0) return false;
    jpeg_start_decompress(&jpeg);
    const std::size_t stride = std::size_t{jpeg.output_width} * 4;
    while (jpeg.output_scanline < jpeg.output_height) {
        JSAMPROW row = rgba + stride * jpeg.output_scanline;
        if (jpeg_read_scanlines(&jpeg, &row, 1) == 0) return false;
    }
    jpeg_finish_decompress(&jpeg);
    return true;
}

/// Four inks, inverted as Adobe writes them, to RGBA in place.
void inks_to_rgba(std::vector<std::uint8_t>& texels) {
    for (std::size_t i = 0; i + 4 <= texels.size(); i += 4) {
        for (std::size_t c = 0; c < 3; ++c) texels[i + c] = static_cast<std::uint8_t>(texels[i + c] * texels[i + 3] / 255);
        texels[i + 3] = 255;
    }
}

Result<Image> decode_jpeg(std::span<const std::byte> bytes, const std::string& place) {
    jpeg_decompress_struct jpeg{};
    JpegErrors errors{};
    jpeg.err = jpeg_std_error(&errors.base);
    errors.base.error_exit = jpeg_fatal;
    errors.base.emit_message = jpeg_message;
    Image image;
    bool good = jpeg_begin(jpeg, errors, bytes);
    if (good) {
        if (auto fits = check_size(place, jpeg.image_width, jpeg.image_height); !fits) {
            jpeg_destroy_decompress(&jpeg);
            return fits.error();
        }
        if (std::uint64_t{jpeg.image_width} * jpeg.image_height > max_jpeg_texels_a_byte * bytes.size()) {
            jpeg_destroy_decompress(&jpeg);
            return bad_image(place, "The JPEG is truncated");
        }
        image.width = jpeg.image_width;
        image.height = jpeg.image_height;
        image.rgba.resize(std::size_t{image.width} * image.height * 4);
        good = jpeg_rows(jpeg, errors, image.rgba.data());
    }
    const bool inks = jpeg.out_color_space == JCS_CMYK;
    jpeg_destroy_decompress(&jpeg);
    if (!good) return bad_image(place, fmt::format("The JPEG is damaged: {}", errors.message.data()));
    if (errors.truncated) return bad_image(place, "The JPEG is truncated");
    if (inks) inks_to_rgba(image.rgba);
    return image;
}

bool starts_with(std::span<const std::byte> bytes, std::initializer_list<unsigned> signature) {
    if (bytes.size() < signature.size()) return false;
    std::size_t i = 0;
    for (const unsigned s : signature) {
        if (std::to_integer<unsigned>(bytes[i++]) != s) return false;
    }
    return true;
}

}  // namespace

Result<Image> decode_image(std::span<const std::byte> bytes, const std::string& place) {
    if (bytes.empty()) return bad_image(place, "The picture is empty");
    if (starts_with(bytes, {0x89, 'P', 'N', 'G'})) return decode_png(bytes, place);
    if (starts_with(bytes, {0xff, 0xd8})) return decode_jpeg(bytes, place);
    return bad_image(place, "The picture is neither PNG nor JPEG");
}

std::vector<std::uint8_t> encode_png(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba) {
    const std::size_t texels = std::size_t{width} * height;
    if (texels == 0 || rgba.size() != texels * 4) return {};
    bool opaque = true;
    for (std::size_t i = 3; i < rgba.size() && opaque; i += 4) opaque = rgba[i] == 255;
    std::vector<std::uint8_t> rgb;
    if (opaque) {
        rgb.resize(texels * 3);
        for (std::size_t i = 0; i < texels; ++i) std::memcpy(&rgb[i * 3], &rgba[i * 4], 3);
    }
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = width;
    png.height = height;
    png.format = opaque ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
    png.flags = PNG_IMAGE_FLAG_FAST;
    std::vector<std::uint8_t> out(PNG_IMAGE_PNG_SIZE_MAX(png));
    png_alloc_size_t size = out.size();
    const void* texel_data = opaque ? rgb.data() : rgba.data();
    if (png_image_write_to_memory(&png, out.data(), &size, 0, texel_data, 0, nullptr) == 0) return {};
    out.resize(size);
    return out;
}

Result<void> write_png(const std::string& file, std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba) {
    const std::vector<std::uint8_t> png = encode_png(width, height, rgba);
    if (png.empty())
        return Error{
            file, fmt::format("The {} bytes cannot be encoded as a picture of {} x {} RGBA texels", rgba.size(), width, height),
            "Choose a smaller picture", ErrorKind::failed};
    return write_file(file, std::as_bytes(std::span(png)));
}

}  // namespace surefoot::image
