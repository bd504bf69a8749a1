// Differences of pictures, summed up.
#include "tools/accuracy/picture_difference.hpp"

#include <algorithm>

#include "render/measure/flip.hpp"
#include "render/measure/image_metrics.hpp"
#include "tools/report/page_parts.hpp"
#include "tools/report/report.hpp"

namespace surefoot::accuracy {

namespace {
constexpr int picture_quality = 85;
}

void DifferenceSum::add(const gl::PixelImage& with, const gl::PixelImage& without) {
    const double mse = measure::snr(without.rgba, with.rgba).mse;
    const std::uint32_t place = places_++;
    mse_ += mse;
    if (mse > 0) flip_ += measure::flip(without.rgba, with.rgba, with.width, with.height);
    if (!(mse > max_mse_)) return;
    max_mse_ = mse;
    out_.max_at = place;
    out_.with = report::jpeg_data_uri(with.rgba, with.width, with.height, picture_quality);
    out_.without = report::jpeg_data_uri(without.rgba, without.width, without.height, picture_quality);
}

PictureDifference DifferenceSum::found() const {
    PictureDifference out = out_;
    const double n = std::max(1U, places_);
    out.psnr_db = report::psnr_db(mse_ / n);
    out.flip = flip_ / n;
    return out;
}

}  // namespace surefoot::accuracy
