// Pictures of forms: each form of a node is drawn and measured beside full detail, and the page holds all of it.
#include "tools/accuracy/form_pictures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <string>

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
