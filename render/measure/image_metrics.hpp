// Image quality against full detail: SNR (Pasman and Jansen 2002, section 4.2) with its zero cases defined, and SSIM.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace surefoot::measure {

/// SNR = 10 log10(VAR / MSE) over the image's R, G, B bytes (Pasman & Jansen 2002, 4.2). VAR is of the simplified image s
/// as published; `var_reference_db` uses the reference's instead.
struct Snr {
    double db = 0;  ///< +inf where MSE = 0 (even if VAR = 0)
    double var_reference_db = 0;
    double mse = 0;
    bool defined = true;  ///< false where VAR = 0 and MSE > 0: excluded from means and counted
};
/// Both RGBA8 of the same size; alpha ignored. Sizes differ: not defined.
Snr snr(std::span<const std::uint8_t> simplified, std::span<const std::uint8_t> reference);

/// Mean SSIM of luma (Rec. 601 on the sRGB bytes), 8x8 windows at stride 4, K1 0.01, K2 0.03, L 255; 1 for equal images.
double ssim(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b, std::uint32_t width, std::uint32_t height);

/// Share of pixels whose R, G and B all differ by at most `steps`/255; 0..1.
double share_within(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b, int steps);

/// Absolute difference, amplified (x4, clamped), opaque: for reports.
std::vector<std::uint8_t> difference_image(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b);

}  // namespace surefoot::measure
