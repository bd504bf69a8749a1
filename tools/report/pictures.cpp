// JPEG by libjpeg, in memory: a page of pictures stays a few megabytes.
#include "tools/report/page_parts.hpp"

#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

namespace surefoot::report {

namespace {

/// libjpeg's own handler ends the process; this one comes back here.
struct ErrorReturn {
    jpeg_error_mgr manager;
    std::jmp_buf back;
};

void return_from_error(j_common_ptr info) { std::longjmp(reinterpret_cast<ErrorReturn*>(info->err)->back, 1); }
void ignore_message(j_common_ptr) {}

/// Only plain data between setjmp and longjmp. `row` has room for width * 3 bytes; *out is malloc'ed by libjpeg.
bool compress(const std::uint8_t* rgba, std::uint32_t width, std::uint32_t height, int quality, JSAMPLE* row, unsigned char** out,
              unsigned long* size) {
    jpeg_compress_struct info;
    ErrorReturn errors;
    info.err = jpeg_std_error(&errors.manager);
    errors.manager.error_exit = return_from_error;
    errors.manager.output_message = ignore_message;
    if (setjmp(errors.back) != 0) {
        jpeg_destroy_compress(&info);
        return false;
    }
    jpeg_create_compress(&info);
    jpeg_mem_dest(&info, out, size);
    info.image_width = width;
    info.image_height = height;
    info.input_components = 3;
    info.in_color_space = JCS_RGB;
    jpeg_set_defaults(&info);
    jpeg_set_quality(&info, quality, TRUE);
    info.optimize_coding = TRUE;
    jpeg_start_compress(&info, TRUE);
    while (info.next_scanline < height) {
        const std::uint8_t* from = rgba + static_cast<std::size_t>(info.next_scanline) * width * 4;
        for (std::uint32_t x = 0; x < width; ++x)
            for (std::uint32_t c = 0; c < 3; ++c) row[x * 3 + c] = from[x * 4 + c];
        jpeg_write_scanlines(&info, &row, 1);
    }
    jpeg_finish_compress(&info);
    jpeg_destroy_compress(&info);
    return true;
}

}  // namespace

std::string base64(std::span<const std::uint8_t> bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = bytes.size() - i;
        const std::uint32_t word = std::uint32_t{bytes[i]} << 16U | (left > 1 ? std::uint32_t{bytes[i + 1]} << 8U : 0U) |
                                   (left > 2 ? std::uint32_t{bytes[i + 2]} : 0U);
        out += digits[word >> 18U];
        out += digits[word >> 12U & 63U];
        out += left > 1 ? digits[word >> 6U & 63U] : '=';
        out += left > 2 ? digits[word & 63U] : '=';
    }
    return out;
}

std::string jpeg_data_uri(std::span<const std::uint8_t> rgba, std::uint32_t width, std::uint32_t height, int quality) {
    constexpr std::uint32_t max_side = 16384;
    if (rgba.empty() || width > max_side || height > max_side || rgba.size() != static_cast<std::size_t>(width) * height * 4)
        return {};
    unsigned char* jpeg = nullptr;
    unsigned long size = 0;
    std::string row(static_cast<std::size_t>(width) * 3, '\0');
    const bool made = compress(rgba.data(), width, height, quality, reinterpret_cast<JSAMPLE*>(row.data()), &jpeg, &size);
    std::string uri = made ? "data:image/jpeg;base64," + base64({jpeg, size}) : std::string();
    std::free(jpeg);  // NOLINT(cppcoreguidelines-no-malloc): libjpeg's buffer
    return uri;
}

}  // namespace surefoot::report
