// Procedural pictures for generated scenes: all tile (but paintings), all are small, all come from a seed.
#include "tools/scenes/textures.hpp"

#include <algorithm>
#include <cmath>

#include "rt/base/random.hpp"
#include "tools/scenes/noise.hpp"

namespace surefoot::scenes {
namespace {

/// texel(u, v), u and v in 0..1 at texel middles, row 0 on top.
template <class Texel>
image::Image paint(const char* name, std::uint32_t width, std::uint32_t height, const Texel& texel) {
    image::Image image;
    image.name = name;
    image.width = width;
    image.height = height;
    image.rgba.reserve(std::size_t{width} * height * 4);
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const Colour c = texel((x + 0.5) / width, (y + 0.5) / height);
            image.rgba.insert(image.rgba.end(), c.begin(), c.end());
        }
    }
    return image;
}

double fraction(double v) { return v - std::floor(v); }

/// 0 in a joint, 1 on the stone; `at` runs 0..1 across the stone, joints are `width` wide.
double off_joint(double at, double width) { return std::clamp((std::min(at, 1 - at) - width) / width, 0.0, 1.0); }

/// Rows of stones, each row shifted by half: bricks, tiles, slabs. Number of stone by row and column, each repeats.
image::Image courses(const char* name, std::uint64_t seed, const Colour& colour, const Colour& joint, int columns, int rows,
                     double spread) {
    return paint(name, 256, 256, [&](double u, double v) {
        const auto row = static_cast<std::int64_t>(v * rows);
        const double along = u * columns + (row % 2 == 0 ? 0.0 : 0.5);
        const auto column = static_cast<std::int64_t>(std::floor(along)) % columns;
        const double tone =
            1 + spread * (lattice(column, row, seed) - 0.5) + 0.16 * (rough_noise(u * 24, v * 24, seed + 1, 24) - 0.5);
        const double solid = off_joint(fraction(along), 0.03 * columns / 4.0) * off_joint(fraction(v * rows), 0.03 * rows / 8.0);
        return mix(joint, shade(colour, tone), 0.15 + 0.85 * solid);
    });
}

}  // namespace

image::Image brick(std::uint64_t seed, const Colour& colour) {
    return courses("brick", seed, colour, rgb(176, 168, 156), 4, 12, 0.5);
}

image::Image paving(std::uint64_t seed, const Colour& colour) {
    return courses("paving", seed, colour, shade(colour, 0.62), 4, 4, 0.16);
}

image::Image cobbles(std::uint64_t seed, const Colour& colour) {
    return courses("cobbles", seed, colour, shade(colour, 0.5), 12, 12, 0.35);
}

image::Image plaster(std::uint64_t seed, const Colour& colour) {
    return paint("plaster", 128, 128, [&](double u, double v) {
        return shade(colour, 0.94 + 0.09 * rough_noise(u * 8, v * 8, seed, 8) + 0.05 * noise(u * 64, v * 64, seed + 9, 64));
    });
}

image::Image roof_tiles(std::uint64_t seed, const Colour& colour) {
    return paint("roof tiles", 256, 256, [&](double u, double v) {
        constexpr int columns = 10, rows = 8;
        const auto row = static_cast<std::int64_t>(v * rows);
        const double along = u * columns + (row % 2 == 0 ? 0.0 : 0.5), down = fraction(v * rows);
        const double hollow = fraction(along) - 0.5;
        const double rounded = 0.72 + 0.4 * std::sqrt(std::max(0.0, 1 - 3.6 * hollow * hollow));
        const double lip = down > 0.88 ? 0.55 : 0.85 + 0.2 * down;
        const double tone = 1 + 0.3 * (lattice(static_cast<std::int64_t>(std::floor(along)) % columns, row, seed) - 0.5);
        return shade(colour, tone * rounded * lip + 0.06 * noise(u * 60, v * 60, seed + 3, 60));
    });
}

image::Image planks(std::uint64_t seed, const Colour& colour) {
    return paint("planks", 256, 256, [&](double u, double v) {
        constexpr int rows = 6;
        const auto row = static_cast<std::int64_t>(v * rows);
        const double shift = lattice(row, 7, seed), along = fraction(u + shift);
        const double grain = noise(u * 6, v * 96, seed + 2, 6) * 0.5 + noise(u * 3, v * 30, seed + 3, 3) * 0.5;
        const double tone = 0.86 + 0.24 * lattice(row, along > 0.5 ? 1 : 2, seed) + 0.22 * (grain - 0.5);
        const double joint = off_joint(fraction(v * rows), 0.018) * off_joint(fraction(along * 2), 0.004);
        return shade(colour, tone * (0.55 + 0.45 * joint));
    });
}

image::Image wood_grain(std::uint64_t seed, const Colour& colour) {
    return paint("wood", 128, 128, [&](double u, double v) {
        const double wander = 0.05 * noise(u * 4, v * 4, seed, 4);
        const double rings = 0.5 + 0.5 * std::sin(2 * pi * (7 * (v + wander) + 0.8 * noise(u * 3, v * 6, seed + 1, 3)));
        return shade(colour, 0.84 + 0.1 * rings + 0.1 * noise(u * 8, v * 64, seed + 2, 8));
    });
}

image::Image speckle(std::uint64_t seed, const Colour& a, const Colour& b, const char* name) {
    return paint(name, 128, 128, [&](double u, double v) {
        return mix(a, b, 0.55 * rough_noise(u * 8, v * 8, seed, 8) + 0.45 * noise(u * 64, v * 64, seed + 5, 64));
    });
}

image::Image rug(std::uint64_t seed, const Colour& a, const Colour& b) {
    return paint("rug", 256, 256, [&](double u, double v) {
        const double edge = std::min(std::min(u, 1 - u), std::min(v, 1 - v));
        const double weave = 0.92 + 0.1 * noise(u * 128, v * 128, seed, 128);
        if (edge < 0.03) return shade(b, weave);
        if (edge < 0.09) return shade(fraction((u + v) * 24) < 0.5 ? a : rgb(214, 196, 150), weave);
        if (edge < 0.11) return shade(b, 0.8 * weave);
        const double x = std::abs(fraction(u * 5) - 0.5), y = std::abs(fraction(v * 5) - 0.5);
        const double diamond = x + y, centre = std::hypot((u - 0.5) * 1.6, v - 0.5);
        if (centre < 0.12) return shade(rgb(214, 196, 150), weave);
        if (centre < 0.2 || diamond < 0.14) return shade(b, weave);
        return shade(diamond < 0.22 ? rgb(196, 168, 116) : a, weave);
    });
}

image::Image wallpaper(std::uint64_t seed, const Colour& a, const Colour& b) {
    return paint("wallpaper", 128, 128, [&](double u, double v) {
        const double stripe = fraction(u * 8) < 0.5 ? 0.0 : 0.35;
        const double x = fraction(u * 4) - 0.5, y = fraction(v * 4 + (static_cast<int>(u * 4) % 2) * 0.5) - 0.5;
        const double flower = std::hypot(x, y) < 0.13 + 0.05 * std::cos(5 * std::atan2(y, x)) ? 0.8 : 0.0;
        return shade(mix(a, b, std::max(stripe, flower)), 0.97 + 0.05 * noise(u * 40, v * 40, seed, 40));
    });
}

image::Image painting(std::uint64_t seed, int kind) {
    Random random(seed);
    const double hills = random.range(0.45, 0.62), sun_x = random.range(0.2, 0.8);
    const std::uint64_t s = seed;
    return paint("painting", 256, 192, [=](double u, double v) {
        const double stroke = 0.9 + 0.2 * noise(u * 40 + v * 6, v * 26, s + 1);
        if (kind % 4 == 0) {  // hills under an evening sky
            Colour c = mix(rgb(96, 140, 196), rgb(250, 206, 140), v * 1.5);
            if (std::hypot((u - sun_x) * 1.3, v - 0.3) < 0.07) c = rgb(255, 240, 190);
            for (int k = 0; k < 3; ++k) {
                if (v > hills + 0.12 * k - 0.16 * noise(u * (3 + k) + k * 7, 0.5, s + 2))
                    c = mix(rgb(120, 140, 130), rgb(48, 92, 44), 0.35 * (k + 1));
            }
            return shade(c, stroke);
        }
        if (kind % 4 == 1) {  // patches of colour
            const double n = rough_noise(u * 4, v * 3, s + 4), m = rough_noise(u * 3 + 9, v * 4, s + 5);
            const Colour c = n > 0.55  ? rgb(196, 62, 44)
                             : m > 0.5 ? rgb(236, 190, 72)
                             : n < 0.4 ? rgb(38, 70, 120)
                                       : rgb(232, 226, 208);
            return shade(c, stroke);
        }
        if (kind % 4 == 2) {  // a bowl of fruit
            Colour c = v > 0.68 ? rgb(120, 78, 46) : rgb(64, 72, 62);
            if (std::hypot(u - 0.5, (v - 0.66) * 1.8) < 0.3 && v > 0.6) c = rgb(180, 190, 204);
            for (int k = 0; k < 5; ++k) {
                const double d = std::hypot((u - 0.3 - 0.1 * k) * 1.33, v - 0.54 - 0.03 * (k % 2));
                if (d < 0.09) c = shade(k % 2 == 0 ? rgb(206, 70, 40) : rgb(222, 176, 58), 1.25 - 5 * d);
            }
            return shade(c, stroke);
        }
        Colour c = mix(rgb(150, 190, 226), rgb(220, 230, 236), v);  // a house by a tree
        if (v > 0.66 + 0.04 * noise(u * 5, 0.3, s)) c = rgb(112, 146, 70);
        if (u > 0.42 && u < 0.78 && v > 0.42 && v < 0.74)
            c = fraction(u * 14) < 0.3 && v > 0.5 && v < 0.6 ? rgb(70, 80, 96) : rgb(232, 214, 178);
        if (v > 0.24 && v < 0.42 && std::abs(u - 0.6) < (v - 0.2)) c = rgb(168, 74, 52);
        if (std::hypot((u - 0.2) * 1.2, v - 0.4) < 0.17 * (0.8 + 0.4 * noise(u * 12, v * 12, s))) c = rgb(64, 106, 46);
        if (std::abs(u - 0.2) < 0.015 && v > 0.5 && v < 0.72) c = rgb(88, 64, 46);
        return shade(c, stroke);
    });
}

image::Image glass() {
    return paint("window glass", 64, 64, [](double u, double v) {
        const double streak = std::max(0.0, 1 - 6 * std::abs(fraction(u + 0.6 * v) - 0.4));
        Colour c = mix(rgb(150, 180, 200), rgb(230, 240, 248), streak);
        c[3] = static_cast<std::uint8_t>(50 + 90 * streak);
        return c;
    });
}

image::Image leaves(std::uint64_t seed, const Colour& dark, const Colour& light) {
    struct Leaf {
        double x, y, angle, length, tone;
    };
    Random random(seed);
    std::vector<Leaf> spray;
    for (int i = 0; i < 46; ++i) {
        const double r = 0.38 * std::sqrt(random.unit()), a = random.range(0, 2 * pi);
        spray.push_back(
            {0.5 + r * std::cos(a), 0.5 + r * std::sin(a), a + random.range(-0.9, 0.9), random.range(0.07, 0.12), random.unit()});
    }
    return paint("leaves", 128, 128, [&](double u, double v) {
        Colour c = shade(light, 0.8);
        c[3] = 0;
        for (const Leaf& leaf : spray) {
            const double dx = u - leaf.x, dy = v - leaf.y;
            const double along = dx * std::cos(leaf.angle) + dy * std::sin(leaf.angle),
                         across = -dx * std::sin(leaf.angle) + dy * std::cos(leaf.angle);
            const double f = along / leaf.length;
            if (std::abs(f) > 1 || std::abs(across) > 0.42 * leaf.length * (1 - f * f)) continue;
            c = shade(mix(dark, light, leaf.tone), std::abs(across) < 0.006 ? 0.8 : 1.0);
        }
        return c;
    });
}

image::Image frond(std::uint64_t seed, const Colour& dark, const Colour& light) {
    return paint("frond", 64, 256, [&](double u, double v) {
        const double x = 2 * std::abs(u - 0.5), y = 1 - v;  // from the rib, from the root
        const double half = 0.95 * std::sin(pi * std::pow(y, 0.7)) * (1 - 0.4 * y);
        const double leaflet = fraction(y * 22 - 0.8 * x);
        const bool shows = x < 0.06 || (x < half && leaflet < 0.72 - 0.3 * x / std::max(half, 0.01));
        Colour c = mix(dark, light, 0.3 + 0.5 * y + 0.2 * noise(u * 8, v * 32, seed));
        c[3] = shows ? 255 : 0;
        return c;
    });
}

image::Image blades(std::uint64_t seed, const Colour& dark, const Colour& light) {
    struct Blade {
        double root, tip, height, half, tone;
    };
    Random random(seed);
    std::vector<Blade> tuft;
    for (int i = 0; i < 26; ++i) {
        const double root = random.range(0.3, 0.7), tip = root + random.range(-0.3, 0.3);
        const double height = random.range(0.5, 0.98), half = random.range(0.01, 0.02);
        tuft.push_back({root, tip, height, half, random.unit()});
    }
    return paint("blades of grass", 128, 128, [&](double u, double v) {
        Colour c = mix(dark, light, 0.5);
        c[3] = 0;
        const double y = 1 - v;
        for (const Blade& blade : tuft) {
            const double f = y / blade.height;
            if (f > 1 || std::abs(u - glm::mix(blade.root, blade.tip, f * f)) > blade.half * (1.1 - f)) continue;
            c = mix(dark, light, 0.6 * blade.tone + 0.4 * f);
        }
        return c;
    });
}

image::Image petals(std::uint64_t seed, const Colour& dark, const Colour& light) {
    return paint("petals", 64, 64, [&](double u, double v) {
        const double x = u - 0.5, y = v - 0.5, r = 2 * std::hypot(x, y), angle = std::atan2(y, x);
        const double rim = 0.82 + 0.12 * std::cos(5 * angle + 2.2 * r);
        const double fold = 0.5 + 0.5 * std::cos(5 * angle + 9 * r);
        Colour c = r < 0.16 ? rgb(232, 190, 70) : mix(dark, light, 0.55 * r + 0.3 * fold + 0.1 * noise(u * 16, v * 16, seed));
        c[3] = r < rim ? 255 : 0;
        return c;
    });
}

image::Image wire_mesh(const Colour& wire) {
    return paint("wire mesh", 64, 64, [&](double u, double v) {
        const double x = std::abs(fraction(u * 4) - 0.5), y = std::abs(fraction(v * 4) - 0.5);
        Colour c = shade(wire, x < 0.07 && y < 0.07 ? 1.15 : 0.95);
        c[3] = x < 0.07 || y < 0.07 ? 255 : 0;
        return c;
    });
}

image::Image book_spines(std::uint64_t seed) {
    return paint("book spine", 32, 128, [&](double u, double v) {
        const double round = 0.75 + 0.3 * std::sin(u * pi);
        const bool band = std::abs(v - 0.12) < 0.012 || std::abs(v - 0.88) < 0.012 || std::abs(v - 0.2) < 0.006;
        const bool letter = v > 0.32 && v < 0.7 && u > 0.3 && u < 0.7 && noise(u * 10, v * 60, seed) > 0.55;
        return band || letter ? rgb(236, 206, 120) : shade(rgb(255, 255, 255), round);
    });
}

}  // namespace surefoot::scenes
