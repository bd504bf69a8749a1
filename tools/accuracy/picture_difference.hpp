// How far two ways to draw the same places are apart.
#pragma once

#include <cstdint>
#include <string>

#include "render/gl/device.hpp"

namespace surefoot::accuracy {

/// Pictures with and without something, over all places.
struct PictureDifference {
    double psnr_db = 0;         ///< of the pictures without; report::max_psnr_db: they are equal
    double flip = 0;            ///< mean
    std::string with, without;  ///< pictures of the place where they differ most, as data URIs; empty: they are equal
    std::uint32_t max_at = 0;   ///< number of that place
};

/// Sums the differences of places, in their order.
class DifferenceSum {
public:
    void add(const gl::PixelImage& with, const gl::PixelImage& without);
    [[nodiscard]] PictureDifference found() const;

private:
    PictureDifference out_;
    std::uint32_t places_ = 0;
    double mse_ = 0, flip_ = 0, max_mse_ = 0;
};

}  // namespace surefoot::accuracy
