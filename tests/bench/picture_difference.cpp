// Bench tool: pictures in one folder against those of the same names in another.
// bench_picture_difference PICTURES REFERENCE -> one JSON object: pooled PSNR, the worst picture, means of SSIM and
// FLIP, and the share of pixels of which no channel differs by more than 1.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "render/image/image.hpp"
#include "render/measure/flip.hpp"
#include "render/measure/image_metrics.hpp"
#include "rt/base/file.hpp"
#include "tools/report/report.hpp"

namespace {

using namespace surefoot;

int fail(const std::string& what) {
    fmt::print(stderr, "bench_picture_difference: {}\n", what);
    return 1;
}

Result<image::Image> read_picture(const std::filesystem::path& file) {
    const auto text = read_text(file.string());
    if (!text) return text.error();
    return image::decode_image(std::as_bytes(std::span(*text)), file.string());
}

/// Pixels, in per cent, of which each channel is within 1 of the other picture's.
double within_1_percent(const image::Image& a, const image::Image& b) {
    const std::size_t pixels = a.rgba.size() / 4;
    std::size_t alike = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        bool same = true;
        for (std::size_t c = 4 * i; c < 4 * i + 3; ++c) same = same && std::abs(int{a.rgba[c]} - int{b.rgba[c]}) <= 1;
        alike += same ? 1 : 0;
    }
    return pixels > 0 ? 100.0 * static_cast<double>(alike) / static_cast<double>(pixels) : 0.0;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) return fail("usage: bench_picture_difference PICTURES REFERENCE");
    const std::filesystem::path pictures = argv[1], references = argv[2];
    std::vector<std::string> names;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(pictures, error))
        if (entry.path().extension() == ".png") names.push_back(entry.path().filename().string());
    if (names.empty()) return fail(fmt::format("{}: no picture is there", argv[1]));
    std::sort(names.begin(), names.end());
    std::vector<report::ReportSnapshot> compared;
    std::vector<double> alike;
    for (const std::string& name : names) {
        auto picture = read_picture(pictures / name), reference = read_picture(references / name);
        if (!picture) return fail(picture.error().text());
        if (!reference) return fail(reference.error().text());
        if (picture->width != reference->width || picture->height != reference->height)
            return fail(fmt::format("{}: two sizes", name));
        alike.push_back(within_1_percent(*picture, *reference));
        report::ReportSnapshot& c = compared.emplace_back();
        c.frame = compared.size() - 1;
        c.mse = measure::snr(picture->rgba, reference->rgba).mse;
        c.ssim = measure::ssim(picture->rgba, reference->rgba, picture->width, picture->height);
        c.flip = measure::flip(picture->rgba, reference->rgba, picture->width, picture->height);
        c.walk.resize(1);  // compare_pictures() passes over those without a picture; the pixels are not needed again
    }
    const report::PictureSummary p = report::compare_pictures(compared);
    const auto min_alike = std::min_element(alike.begin(), alike.end());
    fmt::print(
        "{{\"pictures\": {}, \"psnr_db\": {:.3f}, \"worst_psnr_db\": {:.3f}, \"worst\": \"{}\", \"ssim\": {:.4f}, \"flip\": "
        "{:.4f}, \"within_1_percent\": {:.5f}, \"worst_within_1_percent\": {:.5f}, \"least_alike\": \"{}\"}}\n",
        p.frames, p.psnr_db, p.worst_psnr_db, names[p.worst_frame], p.ssim, p.flip,
        std::accumulate(alike.begin(), alike.end(), 0.0) / static_cast<double>(alike.size()), *min_alike,
        names[static_cast<std::size_t>(min_alike - alike.begin())]);
    return 0;
}
