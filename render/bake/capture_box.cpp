// A texel is the mean of the samples in it, and as opaque as many of them are covered.
#include "render/bake/capture_box.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <functional>

namespace surefoot::bake {

namespace {

/// The samples of a row or column of texels: from `first` on, at least one.
struct Span {
    std::uint32_t first = 0, count = 1;
};

/// Texels of one axis of a face, over the samples of a picture. low_px: where the face begins, in samples. reversed: its samples
/// run against its texels.
std::vector<Span> spans_of(double low_px, double texel_px, std::uint32_t pixels, std::uint32_t samples, bool reversed) {
    std::vector<Span> spans(pixels);
    for (std::uint32_t i = 0; i < pixels; ++i) {
        const double from = low_px + i * texel_px, to = from + texel_px, last = std::max(1U, samples) - 1.0;
        double first = std::ceil(from), end = std::ceil(to);
        if (end <= first) first = std::round(0.5 * (from + to)), end = first + 1;  // texels that are smaller than samples
        first = std::clamp(first, 0.0, last);
        end = std::clamp(end, first + 1, last + 1);
        spans[reversed ? pixels - 1 - i : i] = {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end - first)};
    }
    return spans;
}

/// What is added up over samples.
struct Sums {
    std::array<std::uint64_t, 3> rgb{};
    std::uint64_t covered = 0;
    void add(const FormSample& sample) {
        ++covered;
        for (std::size_t k = 0; k < 3; ++k) rgb[k] += sample.rgb[1][k];
    }
    void add(const Sums& more) {
        covered += more.covered;
        for (std::size_t k = 0; k < 3; ++k) rgb[k] += more.rgb[k];
    }
    void mean(std::uint8_t* to) const {
        for (std::size_t k = 0; k < 3; ++k) to[k] = static_cast<std::uint8_t>(covered == 0 ? 0 : rgb[k] / covered);
    }
};

/// Scales the alphas of texels so that this share of them is opaque: thin things stay as wide as they are. False: none is.
bool keep_share(std::vector<std::uint8_t>& rgba, double share) {
    std::vector<std::uint8_t> alphas;
    for (std::size_t at = 3; at < rgba.size(); at += 4) alphas.push_back(rgba[at]);
    // Texels have one to four samples, so a sharp edge may leave fewer texels with any than the samples' share says.
    const std::size_t shown = alphas.size() - static_cast<std::size_t>(std::count(alphas.begin(), alphas.end(), 0));
    const auto opaque = std::min(shown, static_cast<std::size_t>(std::llround(share * static_cast<double>(alphas.size()))));
    if (opaque == 0) return false;
    const auto last = alphas.begin() + static_cast<std::ptrdiff_t>(opaque - 1);
    std::nth_element(alphas.begin(), last, alphas.end(), std::greater<>());
    for (std::size_t at = 3; at < rgba.size(); at += 4)
        rgba[at] = static_cast<std::uint8_t>(std::min(255U, (rgba[at] * std::uint32_t{opaque_alpha} + *last - 1U) / *last));
    return true;
}

}  // namespace

Direction direction_of_face(std::uint32_t face) {
    const int axis = static_cast<int>(face / 2), u = (axis + 1) % 3, v = (axis + 2) % 3;
    const bool high = face % 2 == 1;
    Direction from{vec3(0), vec3(0), vec3(0)};
    from.towards[axis] = high ? 1.0F : -1.0F;
    from.right[u] = high ? 1.0F : -1.0F;  // right-handed: seen from the low side, the first axis runs to the left
    from.up[v] = 1.0F;
    return from;
}

std::array<std::uint32_t, 4> shown_texels(const FaceCapture& face, std::uint32_t pixels) {
    std::array<std::uint32_t, 4> range{pixels, pixels, 0, 0};
    for (std::uint32_t y = 0; y < pixels; ++y) {
        for (std::uint32_t x = 0; x < pixels; ++x) {
            if (face.rgba[std::size_t{4} * (static_cast<std::size_t>(y) * pixels + x) + 3] < opaque_alpha) continue;
            range = {std::min(range[0], x), std::min(range[1], y), std::max(range[2], x + 1), std::max(range[3], y + 1)};
        }
    }
    return range;
}

FaceCapture capture_face(const FormPicture& seen, const Box& box, std::uint32_t face, std::uint32_t pixels,
                         std::vector<FaceSample>* shown) {
    FaceCapture out;
    if (shown != nullptr) shown->clear();
    out.rgba.assign(std::size_t{4} * pixels * pixels, 0);
    const FormView& view = seen.view;
    if (seen.samples.empty()) return out;
    const Direction& from = view.direction;
    const double pixel_m = std::ldexp(1.0, view.exponent);
    const dvec3 half = glm::max(box.half(), dvec3(1e-9)), centre = box.centre() - view.middle;
    const int axis = static_cast<int>(face / 2), u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto low_px = [&](const vec3& along, int in_plane, std::int64_t first) {
        return (glm::dot(centre, dvec3(along)) - half[in_plane]) / pixel_m - static_cast<double>(first);
    };
    const std::vector<Span> columns =
        spans_of(low_px(from.right, u, view.left), 2 * half[u] / pixel_m / pixels, pixels, view.width, face % 2 == 0);
    const std::vector<Span> rows =
        spans_of(low_px(from.up, v, view.low), 2 * half[v] / pixel_m / pixels, pixels, view.height, false);
    const auto ends = [&](double low, int in_plane) { return low + 2 * half[in_plane] / pixel_m; };
    out.whole = ends(low_px(from.right, u, view.left), u) <= view.width + 1.0 &&
                ends(low_px(from.up, v, view.low), v) <= view.height + 1.0;
    if (!out.whole) return out;
    const double front = glm::dot(centre, dvec3(from.towards)) + half[axis];
    // A depth is a float, in metres from the middle of the model.
    const double near_half_m = 1.001 * half[axis] + 4.0 * FLT_EPSILON * (std::abs(front) + 2 * half[axis]);
    Sums all;
    std::uint64_t samples = 0;
    for (std::uint32_t y = 0; y < pixels; ++y) {
        for (std::uint32_t x = 0; x < pixels; ++x) {
            Sums texel;
            const Span &row = rows[y], &column = columns[x];
            for (std::uint32_t sy = row.first; sy < row.first + row.count; ++sy) {
                for (std::uint32_t sx = column.first; sx < column.first + column.count; ++sx) {
                    const std::uint32_t at = sy * view.width + sx;
                    const FormSample& sample = seen.samples[at];
                    const double depth = front - static_cast<double>(sample.depth);
                    if (!sample.covered() || depth > near_half_m) continue;
                    out.depth_m = std::max(out.depth_m, static_cast<float>(depth));
                    texel.add(sample);
                    if (shown != nullptr) shown->push_back({at, y * pixels + x});
                }
            }
            const std::uint64_t count = std::uint64_t{row.count} * column.count;
            std::uint8_t* rgba = &out.rgba[std::size_t{4} * (static_cast<std::size_t>(y) * pixels + x)];
            texel.mean(rgba);
            rgba[3] = static_cast<std::uint8_t>((255 * texel.covered + count / 2) / count);
            all.add(texel);
            samples += count;
        }
    }
    all.mean(out.mean.data());
    out.mean[3] = all.covered == 0 ? 0 : 255;
    const double share = static_cast<double>(all.covered) / static_cast<double>(std::max<std::uint64_t>(samples, 1));
    out.covered = keep_share(out.rgba, share) ? static_cast<float>(share) : 0.0F;
    return out;
}

}  // namespace surefoot::bake
