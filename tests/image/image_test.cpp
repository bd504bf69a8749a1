// Pictures: PNG there and back, JPEG, truncation at every length, sizes refused before they are allocated.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <jpeglib.h>

#include "render/image/image.hpp"
#include "tests/temporary_folder.hpp"

namespace surefoot::image {
namespace {

std::vector<std::uint8_t> gradient(std::uint32_t width, std::uint32_t height, bool opaque) {
    std::vector<std::uint8_t> out;
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            out.insert(out.end(), {static_cast<std::uint8_t>(x * 9), static_cast<std::uint8_t>(y * 7),
                                   static_cast<std::uint8_t>(x * y), static_cast<std::uint8_t>(opaque ? 255 : x * 11)});
        }
    }
    return out;
}

std::vector<unsigned char> jpeg(int width, int height, int components) {
    jpeg_compress_struct c{};
    jpeg_error_mgr errors{};
    c.err = jpeg_std_error(&errors);
    jpeg_create_compress(&c);
    unsigned char* data = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&c, &data, &size);
    c.image_width = static_cast<JDIMENSION>(width);
    c.image_height = static_cast<JDIMENSION>(height);
    c.input_components = components;
    c.in_color_space = components == 1 ? JCS_GRAYSCALE : components == 3 ? JCS_RGB : JCS_CMYK;
    jpeg_set_defaults(&c);
    jpeg_set_quality(&c, 95, TRUE);
    jpeg_start_compress(&c, TRUE);
    std::vector<unsigned char> row(static_cast<std::size_t>(width * components), 200);
    while (c.next_scanline < c.image_height) {
        JSAMPROW r = row.data();
        jpeg_write_scanlines(&c, &r, 1);
    }
    jpeg_finish_compress(&c);
    jpeg_destroy_compress(&c);
    std::vector<unsigned char> out(data, data + size);
    std::free(data);
    return out;
}

Result<Image> decode(std::span<const unsigned char> bytes) { return decode_image(std::as_bytes(bytes), "test picture"); }

TEST(Picture, PngThereAndBack) {
    for (const bool opaque : {true, false}) {
        const auto texels = gradient(23, 17, opaque);
        const auto image = decode(encode_png(23, 17, texels));
        ASSERT_TRUE(image.ok()) << image.error().text();
        EXPECT_EQ(image->width, 23U);
        EXPECT_EQ(image->height, 17U);
        EXPECT_EQ(image->rgba, texels);
    }
}

TEST(Picture, EncodingTheWrongNumberOfTexelsIsRefused) {
    EXPECT_TRUE(encode_png(4, 4, gradient(4, 3, true)).empty());
    const test::TemporaryFolder folder;
    EXPECT_FALSE(write_png(folder / "a.png", 4, 4, gradient(4, 3, true)).ok());
}

TEST(Picture, JpegOfEveryKind) {
    for (const int components : {1, 3, 4}) {
        const auto image = decode(jpeg(20, 10, components));
        ASSERT_TRUE(image.ok()) << components << ": " << image.error().text();
        EXPECT_EQ(image->rgba.size(), 800U);
        EXPECT_EQ(image->rgba[3], 255);
        EXPECT_NEAR(image->rgba[0], components == 4 ? 200 * 200 / 255 : 200, 4);
    }
}

TEST(Picture, TruncatedPngsAreErrors) {
    const auto whole = encode_png(64, 64, gradient(64, 64, false));
    for (std::size_t length = 0; length + 12 < whole.size();
         length += length < 100 ? 1 : 37) {  // the last 12 bytes only say "end"
        EXPECT_FALSE(decode(std::span(whole).first(length)).ok()) << length;
    }
}

TEST(Picture, TruncatedJpegsAreErrors) {
    const auto whole = jpeg(64, 64, 3);
    for (std::size_t length = 0; length + 2 < whole.size(); length += 5)
        EXPECT_FALSE(decode(std::span(whole).first(length)).ok()) << length;
}

TEST(Picture, SizesAreRefusedBeforeAllocation) {
    auto png = encode_png(8, 8, gradient(8, 8, true));
    // Width and height stand at bytes 16 to 23; without a matching checksum libpng refuses as well.
    png[16] = 0x7f;
    EXPECT_FALSE(decode(png).ok());
    const std::vector<std::uint8_t> wide = encode_png(16385, 1, std::vector<std::uint8_t>(16385 * 4, 255));
    const auto refused = decode(wide);
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.error().text().find("larger than 16384"), std::string::npos);
    EXPECT_TRUE(decode(encode_png(16384, 1, std::vector<std::uint8_t>(16384 * 4, 255))).ok());
}

TEST(Picture, OtherFormatsAndNothingAreNamed) {
    EXPECT_NE(decode(std::vector<std::uint8_t>{'G', 'I', 'F', '8'}).error().text().find("neither PNG nor JPEG"),
              std::string::npos);
    EXPECT_NE(decode({}).error().text().find("empty"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::image
