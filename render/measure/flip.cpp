// FLIP (Andersson et al. 2020): both pictures are blurred as the eye blurs them (section 4.1), their colours compared in Lab
// (4.1.2), and the difference is raised where edges or points differ (4.2, 4.3). Names of the constants are the paper's.
#include "render/measure/flip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/glm.hpp>

namespace surefoot::measure {

namespace {

using Plane = std::vector<float>;
constexpr std::size_t bytes_per_pixel = 4;  // RGBA8

struct Size {
    std::uint32_t width, height;
    [[nodiscard]] std::size_t pixels() const { return static_cast<std::size_t>(width) * height; }
};

// ---- colours ----

const glm::dvec3 white_xyz{0.950428545, 1.0, 1.088900371};  // D65, of linear RGB (1, 1, 1)

glm::dvec3 linear_of(const std::uint8_t* rgb) {
    static const std::array<double, 256> table = [] {
        std::array<double, 256> all{};
        for (std::size_t i = 0; i < all.size(); ++i) {
            const double s = static_cast<double>(i) / 255;
            all[i] = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
        }
        return all;
    }();
    return {table[rgb[0]], table[rgb[1]], table[rgb[2]]};
}

/// Relative to white.
glm::dvec3 xyz_of(const glm::dvec3& linear) {
    const glm::dvec3 xyz{0.4123907993 * linear.r + 0.3575843394 * linear.g + 0.1804807884 * linear.b,
                         0.2126390059 * linear.r + 0.7151686788 * linear.g + 0.0721923154 * linear.b,
                         0.0193308187 * linear.r + 0.1191947798 * linear.g + 0.9505321522 * linear.b};
    return xyz / white_xyz;
}

glm::dvec3 linear_from_xyz(const glm::dvec3& relative) {
    const glm::dvec3 xyz = relative * white_xyz;
    return {3.2409699419 * xyz.x - 1.5373831776 * xyz.y - 0.4986107603 * xyz.z,
            -0.9692436363 * xyz.x + 1.8759675015 * xyz.y + 0.0415550574 * xyz.z,
            0.0556300797 * xyz.x - 0.2039769589 * xyz.y + 1.0569715142 * xyz.z};
}

/// The opponent space in which the eye's blur is known: Y, red-green, blue-yellow.
glm::dvec3 ycxcz_of(const glm::dvec3& xyz) { return {116 * xyz.y - 16, 500 * (xyz.x - xyz.y), 200 * (xyz.y - xyz.z)}; }

glm::dvec3 xyz_from_ycxcz(const glm::dvec3& c) {
    const double y = (c.x + 16) / 116;
    return {y + c.y / 500, y, y - c.z / 200};
}

/// CIE Lab; a and b shrink with the lightness, since dark colours look alike (Hunt).
glm::dvec3 hunt_lab_of(const glm::dvec3& linear) {
    constexpr double delta = 6.0 / 29;
    const auto f = [](double t) { return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29; };
    const glm::dvec3 xyz = xyz_of(linear);
    const double lightness = 116 * f(xyz.y) - 16;
    return {lightness, 0.01 * lightness * 500 * (f(xyz.x) - f(xyz.y)), 0.01 * lightness * 200 * (f(xyz.y) - f(xyz.z))};
}

double hyab(const glm::dvec3& a, const glm::dvec3& b) { return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

constexpr double qc = 0.7, pc = 0.4, pt = 0.95, qf = 0.5;

/// The largest colour difference: of green and blue.
double max_colour_difference() { return std::pow(hyab(hunt_lab_of({0, 1, 0}), hunt_lab_of({0, 0, 1})), qc); }

/// 0..1: small differences take most of the range.
double colour_difference(const glm::dvec3& a, const glm::dvec3& b, double cmax) {
    const double power = std::pow(hyab(a, b), qc);
    if (power < pc * cmax) return pt / (pc * cmax) * power;
    return std::min(1.0, pt + (power - pc * cmax) / (cmax - pc * cmax) * (1 - pt));
}

// ---- filters: each is a row and a column of weights, applied one after the other ----

struct Filter {
    std::vector<float> row, column;  ///< odd lengths; the middle is the pixel itself
};

/// exp(-x² / (2 sigma²)) at whole pixels; not scaled.
std::vector<double> gaussian(double sigma, int radius) {
    std::vector<double> weights;
    for (int x = -radius; x <= radius; ++x) weights.push_back(std::exp(-x * x / (2 * sigma * sigma)));
    return weights;
}

double sum_of(const std::vector<double>& weights) {
    double sum = 0;
    for (const double w : weights) sum += w;
    return sum;
}

std::vector<float> scaled(const std::vector<double>& weights, double factor) {
    std::vector<float> out;
    out.reserve(weights.size());
    for (const double w : weights) out.push_back(static_cast<float>(w * factor));
    return out;
}

/// Adds the filtered plane to `out`.
void add_filtered(const Plane& in, const Size& size, const Filter& filter, Plane& out) {
    const int radius = static_cast<int>(filter.row.size() / 2);
    const int width = static_cast<int>(size.width), height = static_cast<int>(size.height);
    Plane rows(in.size());
    std::vector<float> padded(size.width + 2 * static_cast<std::size_t>(radius));
    for (int y = 0; y < height; ++y) {
        const float* line = in.data() + static_cast<std::size_t>(y) * size.width;
        for (int x = -radius; x < width + radius; ++x)
            padded[static_cast<std::size_t>(x) + static_cast<std::size_t>(radius)] = line[std::clamp(x, 0, width - 1)];
        float* to = rows.data() + static_cast<std::size_t>(y) * size.width;
        for (std::size_t k = 0; k < filter.row.size(); ++k)
            for (int x = 0; x < width; ++x) to[x] += filter.row[k] * padded[static_cast<std::size_t>(x) + k];
    }
    for (int y = 0; y < height; ++y) {
        float* to = out.data() + static_cast<std::size_t>(y) * size.width;
        for (int k = -radius; k <= radius; ++k) {
            const float weight = filter.column[static_cast<std::size_t>(k) + static_cast<std::size_t>(radius)];
            const float* from = rows.data() + static_cast<std::size_t>(std::clamp(y + k, 0, height - 1)) * size.width;
            for (int x = 0; x < width; ++x) to[x] += weight * from[x];
        }
    }
}

Plane filtered(const Plane& in, const Size& size, const std::vector<Filter>& sum) {
    Plane out(in.size());
    for (const Filter& filter : sum) add_filtered(in, size, filter, out);
    return out;
}

/// A Gaussian of the eye's contrast sensitivity: a sqrt(pi/b) exp(-pi² d² / b), d in degrees.
struct Sensitivity {
    double a, b;
};

/// The sum of two Gaussians, with a total weight of 1.
std::vector<Filter> eye_filter(const std::array<Sensitivity, 2>& parts, double pixels_per_degree, int radius) {
    std::vector<Filter> all;
    double total = 0;
    for (const Sensitivity& part : parts) {
        if (part.a == 0) continue;
        const double sigma = std::sqrt(part.b / (2 * std::numbers::pi * std::numbers::pi)) * pixels_per_degree;
        const std::vector<double> weights = gaussian(sigma, radius);
        const double height = part.a * std::sqrt(std::numbers::pi / part.b);
        total += height * sum_of(weights) * sum_of(weights);
        all.push_back({scaled(weights, height), scaled(weights, 1)});
    }
    for (Filter& filter : all)
        for (float& w : filter.row) w = static_cast<float>(w / total);
    return all;
}

/// The first (order 1: edges) or second (points) derivative of a Gaussian; weights of each sign sum to 1. And the Gaussian.
struct Detector {
    std::vector<float> derivative, smooth;
};

Detector detector(int order, double pixels_per_degree) {
    const double sigma = 0.5 * 0.082 * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3 * sigma));
    const std::vector<double> smooth = gaussian(sigma, radius);
    std::vector<double> derivative;
    double above = 0, below = 0;
    for (int x = -radius; x <= radius; ++x) {
        const double factor = order == 1 ? -x : x * x / (sigma * sigma) - 1;
        derivative.push_back(factor * smooth[static_cast<std::size_t>(x) + static_cast<std::size_t>(radius)]);
        (derivative.back() > 0 ? above : below) += std::abs(derivative.back());
    }
    for (double& w : derivative) w /= w > 0 ? above : below;
    return {scaled(derivative, 1), scaled(smooth, 1 / sum_of(smooth))};
}

/// The strength of an edge or a point at each pixel.
Plane strength(const Plane& lightness, const Size& size, const Detector& d) {
    Plane x = filtered(lightness, size, {{d.derivative, d.smooth}});
    const Plane y = filtered(lightness, size, {{d.smooth, d.derivative}});
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::hypot(x[i], y[i]);
    return x;
}

// ---- a picture, prepared ----

struct Picture {
    std::vector<glm::dvec3> seen;  ///< Hunt-adjusted Lab, after the eye's blur
    Plane edges, points;
};

Picture prepare(std::span<const std::uint8_t> rgba, const Size& size, double pixels_per_degree) {
    std::array<Plane, 3> planes;
    for (Plane& plane : planes) plane.resize(size.pixels());
    Plane lightness(size.pixels());
    for (std::size_t i = 0; i < size.pixels(); ++i) {
        const glm::dvec3 c = ycxcz_of(xyz_of(linear_of(rgba.data() + i * bytes_per_pixel)));
        for (int k = 0; k < 3; ++k) planes[static_cast<std::size_t>(k)][i] = static_cast<float>(c[k]);
        lightness[i] = static_cast<float>((c.x + 16) / 116);
    }
    Picture picture;
    picture.edges = strength(lightness, size, detector(1, pixels_per_degree));
    picture.points = strength(lightness, size, detector(2, pixels_per_degree));
    constexpr std::array<std::array<Sensitivity, 2>, 3> eye = {{{{{1, 0.0047}, {0, 1e-5}}},         // Y
                                                                {{{1, 0.0053}, {0, 1e-5}}},         // red-green
                                                                {{{34.1, 0.04}, {13.5, 0.025}}}}};  // blue-yellow
    const int radius =
        static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * std::numbers::pi * std::numbers::pi)) * pixels_per_degree));
    for (std::size_t k = 0; k < 3; ++k) planes[k] = filtered(planes[k], size, eye_filter(eye[k], pixels_per_degree, radius));
    picture.seen.resize(size.pixels());
    for (std::size_t i = 0; i < size.pixels(); ++i) {
        const glm::dvec3 linear = linear_from_xyz(xyz_from_ycxcz({planes[0][i], planes[1][i], planes[2][i]}));
        picture.seen[i] = hunt_lab_of(glm::clamp(linear, 0.0, 1.0));
    }
    return picture;
}

}  // namespace

double flip(std::span<const std::uint8_t> test, std::span<const std::uint8_t> reference, std::uint32_t width,
            std::uint32_t height, double pixels_per_degree) {
    const Size size{width, height};
    if (size.pixels() == 0 || test.size() != size.pixels() * bytes_per_pixel || reference.size() != test.size()) return 0;
    const Picture a = prepare(test, size, pixels_per_degree), b = prepare(reference, size, pixels_per_degree);
    const double cmax = max_colour_difference();
    double sum = 0;
    for (std::size_t i = 0; i < size.pixels(); ++i) {
        const double colour = colour_difference(a.seen[i], b.seen[i], cmax);
        const double feature = std::max(std::abs(a.edges[i] - b.edges[i]), std::abs(a.points[i] - b.points[i]));
        sum += std::pow(colour, 1 - std::pow(feature * std::numbers::sqrt2 / 2, qf));
    }
    return sum / static_cast<double>(size.pixels());
}

}  // namespace surefoot::measure
