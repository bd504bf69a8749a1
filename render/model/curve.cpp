// Curves, their sums and minima, interval by interval, and how neighbouring parts are merged.
#include "render/model/curve.hpp"

#include <algorithm>
#include <cmath>

#include "rt/base/check.hpp"

namespace surefoot::model {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr std::array axes = {&Resources::submit_us, &Resources::raster_us, &Resources::triangles, &Resources::texels};

Resources operator+(const Resources& a, const Resources& b) {
    return {a.submit_us + b.submit_us, a.raster_us + b.raster_us, a.triangles + b.triangles, a.texels + b.texels};
}

bool is_amount(const Resources& r) {
    return std::all_of(axes.begin(), axes.end(), [&](auto axis) { return std::isfinite(r.*axis) && r.*axis >= 0; });
}

/// What a part takes at an accuracy. A part without slope may have an infinite one.
Resources value(const CurvePart& part, double accuracy) {
    Resources r = part.base;
    for (const auto axis : axes)
        if (part.slope.*axis != 0) r.*axis += part.slope.*axis * accuracy;
    return r;
}

CurvePart constant(double from, const Resources& takes) { return {from, takes, {}}; }

double after(double accuracy) { return std::nextafter(accuracy, infinite); }

bool same_line(const CurvePart& a, const CurvePart& b) {
    return std::all_of(axes.begin(), axes.end(),
                       [&](auto axis) { return a.base.*axis == b.base.*axis && a.slope.*axis == b.slope.*axis; });
}

/// The line that a curve follows from `from` on, its ends extended to both sides.
CurvePart line_at(const Curve& curve, double from) {
    const auto parts = curve.parts();
    if (from > curve.end()) return constant(from, value(parts.back(), curve.end()));
    if (from < parts[0].from) return constant(from, value(parts[0], parts[0].from));
    const auto next = std::upper_bound(parts.begin(), parts.end(), from,
                                       [](double accuracy, const CurvePart& part) { return accuracy < part.from; });
    return {from, (next - 1)->base, (next - 1)->slope};
}

/// Where the lines of either curve begin or end, ascending, each once.
class Breaks {
public:
    Breaks(const Curve& a, const Curve& b) {
        for (const Curve* curve : {&a, &b}) {
            for (const CurvePart& part : curve->parts()) add(part.from);
            if (curve->end() < std::max(a.end(), b.end())) add(after(curve->end()));
        }
        std::sort(at_.begin(), at_.begin() + static_cast<std::ptrdiff_t>(count_));
        count_ =
            static_cast<std::size_t>(std::unique(at_.begin(), at_.begin() + static_cast<std::ptrdiff_t>(count_)) - at_.begin());
    }
    [[nodiscard]] std::span<const double> all() const { return std::span(at_).first(count_); }

private:
    void add(double accuracy) { at_[count_++] = accuracy; }
    std::array<double, 2 * Curve::max_parts + 4> at_{};
    std::size_t count_ = 0;
};

/// The part that takes no less than two neighbours on [first.from, to]: it ends where the second does. As little more as a line
/// can: in each resource, from the hull of the two parts' ends.
CurvePart merged(const CurvePart& first, const CurvePart& second, double to) {
    CurvePart part;
    part.from = first.from;
    const double x0 = first.from, x1 = second.from;
    const Resources begins = value(first, x0), before = value(first, x1), joint = value(second, x1);
    const Resources ends = value(second, to);
    for (const auto axis : axes) {
        const double y0 = begins.*axis, y1 = std::max(before.*axis, joint.*axis), y2 = ends.*axis;
        if (!std::isfinite(to) || !(to > x1)) {
            part.base.*axis = std::max({y0, y1, y2});
            continue;
        }
        const double chord = (y2 - y0) / (to - x0), late = (y2 - y1) / (to - x1);
        const double slope = y0 + chord * (x1 - x0) >= y1 ? chord : late;
        part.slope.*axis = slope;
        part.base.*axis = y2 - slope * to;
    }
    return part;
}

/// How many times as much a merged part takes at the worse end of its range. Infinite: it may not replace the two.
double growth(const CurvePart& part, const CurvePart& first, const CurvePart& second, double to, bool last,
              const Resources& weights) {
    if (!last && weighed(part.slope, weights) < 0) return infinite;
    double most = 1;
    for (const auto& [accuracy, whole] : {std::pair{first.from, &first}, std::pair{second.from, &second}}) {
        const double was = weighed(value(*whole, accuracy), weights), is = weighed(value(part, accuracy), weights);
        most = std::max(most, is / std::max(was, std::numeric_limits<double>::min()));
    }
    const double was = weighed(value(second, to), weights), is = weighed(value(part, to), weights);
    return std::max(most, is / std::max(was, std::numeric_limits<double>::min()));
}

}  // namespace

Curve Curve::of_form(double accuracy, const Resources& takes) {
    Curve curve;
    if (!(accuracy > 0) || !is_amount(takes)) return curve;
    curve.parts_[0] = constant(std::min(accuracy, std::numeric_limits<double>::max()), takes);
    curve.count_ = 1;
    curve.end_ = accuracy;
    return curve;
}

Curve Curve::of_line(double from, double to, const Resources& base, const Resources& slope) {
    Curve curve;
    const CurvePart part{from, base, slope};
    if (!(from > 0) || !(to >= from) || !std::isfinite(to) || !is_amount(slope) || !is_amount(value(part, from)) ||
        !is_amount(value(part, to)))
        return curve;
    curve.parts_[0] = part;
    curve.count_ = 1;
    curve.end_ = to;
    return curve;
}

Resources Curve::at(double accuracy) const {
    return known() ? value(line_at(*this, accuracy), std::clamp(accuracy, begin(), std::max(begin(), end_))) : Resources{};
}

Curve Curve::scaled(double factor) const {
    Curve curve = *this;
    for (CurvePart& part : std::span(curve.parts_).first(count_)) {
        part.from *= factor;
        for (const auto axis : axes) part.slope.*axis /= factor;
    }
    curve.end_ *= factor;
    return curve;
}

void CurveParts::add(const CurvePart& part) {
    if (count_ > 0 && same_line(parts_[count_ - 1], part)) return;
    CHECK(count_ < capacity, "The parts of two curves fit");
    parts_[count_++] = part;
}

CurveParts CurveParts::sum(const Curve& a, const Curve& b) {
    CurveParts out;
    if (!a.known() || !b.known()) return out;
    out.end_ = std::max(a.end(), b.end());
    const Breaks breaks(a, b);
    for (const double from : breaks.all()) {
        const CurvePart one = line_at(a, from), other = line_at(b, from);
        out.add({from, one.base + other.base, one.slope + other.slope});
    }
    return out;
}

CurveParts CurveParts::cheaper(const Curve& a, const Curve& b, const Resources& weights) {
    CurveParts out;
    if (!a.known() || !b.known()) {
        const Curve& known = a.known() ? a : b;
        for (const CurvePart& part : known.parts()) out.add(part);
        out.end_ = known.end();
        return out;
    }
    out.end_ = std::max(a.end(), b.end());
    const Breaks breaks(a, b);
    const auto all = breaks.all();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const double from = all[i], to = i + 1 < all.size() ? all[i + 1] : out.end_;
        const CurvePart one = line_at(a, from), other = line_at(b, from);
        if (from > a.end() || from > b.end()) {
            out.add(from > a.end() ? other : one);
            continue;
        }
        const double difference = weighed(value(one, from), weights) - weighed(value(other, from), weights);
        const double steepness = weighed(one.slope, weights) - weighed(other.slope, weights);
        const bool one_first = difference < 0 || (difference == 0 && steepness <= 0);
        out.add(one_first ? one : other);
        const double crossing = from - difference / steepness;  // no number where they run side by side
        if (!(steepness != 0 && (steepness > 0) == one_first && crossing > from && crossing < to)) continue;
        CurvePart then = one_first ? other : one;
        then.from = crossing;
        out.add(then);
    }
    return out;
}

Curve CurveParts::compacted(const Resources& weights) const {
    std::array<CurvePart, capacity> parts = parts_;
    std::size_t count = count_;
    const auto to_of = [&](std::size_t i) { return i + 1 < count ? parts[i + 1].from : end_; };
    while (count > Curve::max_parts) {
        std::size_t best = count - 2;
        CurvePart best_part{};
        double best_growth = infinite;
        for (std::size_t i = 0; i + 1 < count; ++i) {
            const bool last = i + 2 == count;
            const double to = to_of(i + 1);
            CurvePart part = merged(parts[i], parts[i + 1], to);
            if (last && weighed(part.slope, weights) < 0) part = merged(parts[i], parts[i + 1], infinite);
            const double grows = growth(part, parts[i], parts[i + 1], to, last, weights);
            if (grows < best_growth || (last && !std::isfinite(best_growth))) {
                best = i;
                best_part = part;
                best_growth = grows;
            }
        }
        parts[best] = best_part;
        std::copy(parts.begin() + static_cast<std::ptrdiff_t>(best) + 2, parts.begin() + static_cast<std::ptrdiff_t>(count),
                  parts.begin() + static_cast<std::ptrdiff_t>(best) + 1);
        --count;
    }
    Curve curve;
    std::copy_n(parts.begin(), count, curve.parts_.begin());
    curve.count_ = count;
    curve.end_ = end_;
    return curve;
}

Curve sum_of(const Curve& a, const Curve& b, const Resources& weights) { return CurveParts::sum(a, b).compacted(weights); }
Curve cheaper_of(const Curve& a, const Curve& b, const Resources& weights) {
    return CurveParts::cheaper(a, b, weights).compacted(weights);
}

double accuracy_within(const Curve& curve, const Resources& weights, const Resources& other_weights, double room) {
    const auto parts = curve.parts();
    for (std::size_t i = parts.size(); i-- > 0;) {
        const double from = parts[i].from;
        double to = i + 1 < parts.size() ? std::nextafter(parts[i + 1].from, 0.0) : curve.end();
        bool fits = true;
        for (const Resources* w : {&weights, &other_weights}) {
            const double at_from = weighed(value(parts[i], from), *w), slope = weighed(parts[i].slope, *w);
            fits = fits && at_from <= room;
            if (slope > 0) to = std::min(to, from + (room - at_from) / slope);
        }
        if (fits) return std::max(from, to);
    }
    return 0;
}

FittedLine fit_line(std::span<const double> accuracy, std::span<const double> takes) {
    double n = 0, mean_a = 0, mean_r = 0;
    for (std::size_t i = 0; i < accuracy.size(); ++i) {
        if (!std::isfinite(accuracy[i])) continue;
        n += 1;
        mean_a += accuracy[i];
        mean_r += takes[i];
    }
    if (n < 2) return {};
    mean_a /= n;
    mean_r /= n;
    double aa = 0, ar = 0, rr = 0;
    for (std::size_t i = 0; i < accuracy.size(); ++i) {
        if (!std::isfinite(accuracy[i])) continue;
        const double a = accuracy[i] - mean_a, r = takes[i] - mean_r;
        aa += a * a;
        ar += a * r;
        rr += r * r;
    }
    if (!(aa > 0)) return {mean_r, 0, 0};
    const double slope = ar / aa;
    return {mean_r - slope * mean_a, slope, rr > 0 ? ar * ar / (aa * rr) : 1};
}

}  // namespace surefoot::model
