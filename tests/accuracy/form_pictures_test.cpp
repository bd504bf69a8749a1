// Pictures of forms: each form of a node is drawn and measured beside full detail, and the page holds all of it.
#include "tools/accuracy/form_pictures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <string>

#include "render/image/image.hpp"
#include "rt/base/file.hpp"
#include "tests/text_pieces.hpp"
#include "tests/walk/walk_fixture.hpp"

namespace surefoot::accuracy {
namespace {

FormPicturesRequest forms_request(std::uint32_t max_nodes) {
    FormPicturesRequest request;
    request.model_file = test::Forest::get().model_file;
    request.state_dir = test::Forest::get().dir;  // no table there
    request.max_nodes = max_nodes;
    return request;
}

/// The picture of a data URI; an empty one, and a failure, where it is none.
image::Image picture_in(std::string_view uri) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<std::byte> bytes;
    std::uint32_t bits = 0, count = 0;
    for (const char c : uri.substr(std::min(uri.find(',') + 1, uri.size()))) {
        const auto digit = digits.find(c);
        if (digit == std::string_view::npos) break;
        bits = bits << 6U | static_cast<std::uint32_t>(digit);
        count += 6;
        if (count < 8) continue;
        count -= 8;
        bytes.push_back(static_cast<std::byte>(bits >> count & 255U));
    }
    auto image = image::decode_image(bytes, "data URI");
    EXPECT_TRUE(image.ok()) << (image.ok() ? "" : image.error().text());
    return image.ok() ? std::move(*image) : image::Image{};
}

/// More than a JPEG makes of equal colours.
constexpr int clearly_other = 40;

/// Pixels in which two pictures of one size differ clearly.
std::size_t different_pixels(const image::Image& a, const image::Image& b) {
    EXPECT_EQ(a.rgba.size(), b.rgba.size());
    std::size_t count = 0;
    for (std::size_t i = 0; i + 3 < std::min(a.rgba.size(), b.rgba.size()); i += 4) {
        int off = 0;
        for (std::size_t k = 0; k < 3; ++k) off = std::max(off, std::abs(a.rgba[i + k] - b.rgba[i + k]));
        count += off > clearly_other ? 1 : 0;
    }
    return count;
}

/// Pixels that show something before the sky.
std::size_t object_pixels(const image::Image& image) {
    image::Image sky = image;
    for (std::size_t i = 0; i < sky.rgba.size(); ++i) sky.rgba[i] = i % 4 == 3 ? 255 : image::to_byte(model::usual_sky[i % 4]);
    return different_pixels(image, sky);
}

double psnr_of(const image::Image& a, const image::Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < std::min(a.rgba.size(), b.rgba.size()); ++i)
        if (i % 4 != 3) sum += (a.rgba[i] - b.rgba[i]) * (a.rgba[i] - b.rgba[i]);
    return 10 *
           std::log10(255.0 * 255.0 * 0.75 * static_cast<double>(std::max<std::size_t>(a.rgba.size(), 1)) / std::max(sum, 1e-9));
}

TEST(FormPictures, ShowTheObjectAndWhereACoarseFormIsOff) {
    const auto drawn = draw_forms(forms_request(12), {});
    ASSERT_TRUE(drawn.ok()) << drawn.error().text();
    std::size_t coarse = 0, off = 0, alike = 0, far = 0, far_shown = 0;
    for (const DrawnNode& node : drawn->drawn) {
        const image::Image full = picture_in(node.full);
        ASSERT_EQ(full.width, form_picture_px);
        ASSERT_EQ(full.height, form_picture_px);
        const std::size_t there = object_pixels(full);
        EXPECT_GT(there, 400U) << node.name << " fills the picture";
        EXPECT_LT(there, 0.9 * form_picture_px * form_picture_px) << "and leaves some sky";
        for (const DrawnForm& form : node.forms) {
            const image::Image close = picture_in(form.close);
            const std::size_t shown = object_pixels(close);
            EXPECT_GT(shown, 0U) << node.name << ", " << form.triangles << " triangles";
            if (form.loss.coverage < 0.5F) {  // as measured at bake, from all round
                ++alike;
                EXPECT_GT(shown, there / 4) << node.name << ", " << form.triangles << " triangles";
                EXPECT_LT(shown, 4 * there) << node.name << ", " << form.triangles << " triangles";
            }
            if (form.full_detail) {
                EXPECT_LE(different_pixels(close, full), there / 100) << node.name;
            } else {
                ++coarse;
                off += different_pixels(close, full) > there / 50 ? 1 : 0;
                // What the page says is what its pictures show, but for the JPEG's own part.
                if (form.close_psnr_db < 28) {
                    EXPECT_NEAR(psnr_of(close, full), form.close_psnr_db, 1) << node.name;
                }
            }
            if (form.served.empty()) continue;
            ++far;
            const image::Image served = picture_in(form.served), full_there = picture_in(form.full);
            EXPECT_EQ(served.width, form.served_px);
            EXPECT_GT(object_pixels(full_there), 0U) << node.name;
            far_shown += object_pixels(served) > 0 ? 1 : 0;
        }
    }
    EXPECT_GT(alike, 6U);
    EXPECT_GT(coarse, 6U);
    EXPECT_GT(off, coarse / 2) << "most coarse forms are told from full detail near by";
    EXPECT_GT(far, 0U);
    EXPECT_GE(10 * far_shown, 8 * far) << "a coarse fern may vanish among a few pixels";
}

TEST(FormPictures, ShowEachFormBesideFullDetail) {
    const auto drawn = draw_forms(forms_request(12), {});
    ASSERT_TRUE(drawn.ok()) << drawn.error().text();
    ASSERT_EQ(drawn->drawn.size(), 12U);
    EXPECT_FALSE(drawn->uncalibrated.empty());
    EXPECT_LT(drawn->distinct, drawn->nodes) << "trees of one kind are instances";
    std::set<std::uint32_t> levels;
    bool alike = false, far = false;
    for (const DrawnNode& node : drawn->drawn) {
        levels.insert(node.level);
        alike = alike || node.same > 1;
        ASSERT_FALSE(node.forms.empty());
        EXPECT_TRUE(node.full.starts_with("data:image/jpeg;base64,"));
        for (const DrawnForm& form : node.forms) {
            EXPECT_TRUE(form.close.starts_with("data:image/jpeg;base64,")) << node.name;
            EXPECT_GT(form.close_us, 0) << node.name;
            EXPECT_GT(form.bytes, 0U) << node.name;
            EXPECT_EQ(form.served.empty(), form.full.empty());
            EXPECT_EQ(form.served.empty(), form.served_us == 0);
            far = far || !form.served.empty();
        }
        const DrawnForm& finest = node.forms.back();
        if (finest.full_detail) {
            EXPECT_TRUE(std::isinf(finest.close_psnr_db)) << "full detail is equal to itself: " << node.name;
            EXPECT_EQ(finest.error_m, 0);
        }
        EXPECT_LE(node.forms.front().triangles, finest.triangles);
    }
    EXPECT_GT(levels.size(), 2U) << "nodes come from all levels";
    EXPECT_TRUE(alike);
    EXPECT_TRUE(far);
}

TEST(FormPictures, MakeAPageThatNeedsNothingElse) {
    const auto drawn = draw_forms(forms_request(4), {});
    ASSERT_TRUE(drawn.ok()) << drawn.error().text();
    const std::string& dir = test::Forest::get().dir;
    ASSERT_TRUE(write_forms_page(dir + "/forms", *drawn).ok());
    const std::string page = *read_text(dir + "/forms/index.html");
    EXPECT_EQ(page.find("http"), std::string::npos);
    std::size_t forms = 0, pictures = 0;
    for (const DrawnNode& node : drawn->drawn) {
        forms += node.forms.size();
        pictures += node.forms.back().full_detail ? 0 : 1;
        for (const DrawnForm& form : node.forms) pictures += form.served.empty() ? 1 : 3;
    }
    EXPECT_EQ(test::count_of(page, "<img "), pictures);
    EXPECT_EQ(test::split(*read_text(dir + "/forms/forms.csv"), '\n').size(), forms + 1);
}

TEST(FormPictures, RefuseWhatCannotBeDrawn) {
    FormPicturesRequest request = forms_request(4);
    request.name = "no such name";
    const auto nothing = draw_forms(request, {});
    ASSERT_FALSE(nothing.ok());
    EXPECT_EQ(nothing.error().kind, ErrorKind::misuse);
    request.name.clear();
    request.backend = "null";
    const auto blind = draw_forms(request, {});
    ASSERT_FALSE(blind.ok());
    EXPECT_EQ(blind.error().place, "--backend null");
}

TEST(FormPictures, StopWhenTheUserAsks) {
    const std::atomic<bool> stop = true;
    Progress progress;
    progress.stop = &stop;
    const auto drawn = draw_forms(forms_request(4), progress);
    ASSERT_FALSE(drawn.ok());
    EXPECT_EQ(drawn.error().kind, ErrorKind::stopped);
}

}  // namespace
}  // namespace surefoot::accuracy
