// Curves, their sums and minima, interval by interval, and how neighbouring parts are merged.
#include "render/model/curve.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

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

CurvePart constant(double from, const Resources& takes, double raised = 1) { return {from, takes, {}, raised}; }

double after(double accuracy) { return std::nextafter(accuracy, infinite); }

bool same_line(const CurvePart& a, const CurvePart& b) {
    return std::all_of(axes.begin(), axes.end(),
                       [&](auto axis) { return a.base.*axis == b.base.*axis && a.slope.*axis == b.slope.*axis; });
}

/// The line that a curve follows from `from` on, its ends extended to both sides.
CurvePart line_at(const Curve& curve, double from) {
    const auto parts = curve.parts();
    if (from > curve.end()) return constant(from, value(parts.back(), curve.end()), parts.back().raised);
    if (from < parts[0].from) return constant(from, value(parts[0], parts[0].from), parts[0].raised);
    const auto next = std::upper_bound(parts.begin(), parts.end(), from,
                                       [](double accuracy, const CurvePart& part) { return accuracy < part.from; });
    return {from, (next - 1)->base, (next - 1)->slope, (next - 1)->raised};
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

/// Two neighbours that may become one: from first.from to `to`, where the next part begins or the curve ends.
struct Pair {
    const CurvePart &first, &second;
    double to;
    const CurvePart* next;  ///< null: the second ends the curve
};

/// A part that takes no less than either on its range. In each resource the line goes along the chord of both, or through the
/// higher of the two where they meet: `early` as steep there as the next part's beginning and the first one's allow, `late` as
/// the second ends. `flat`: what the most of both takes.
enum class Slope : std::uint8_t { late, early, flat };

CurvePart merged(const Pair& pair, Slope how) {
    CurvePart part = constant(pair.first.from, {});
    const double x0 = pair.first.from, x1 = pair.second.from, x2 = pair.to;
    const Resources begins = value(pair.first, x0), before = value(pair.first, x1), joint = value(pair.second, x1);
    const Resources ends = value(pair.second, x2), after = pair.next != nullptr ? value(*pair.next, x2) : ends;
    for (const auto axis : axes) {
        const double y0 = begins.*axis, y1 = std::max(before.*axis, joint.*axis), y2 = ends.*axis;
        if (how == Slope::flat || !std::isfinite(x2) || !(x2 > x1)) {
            part.base.*axis = std::max({y0, y1, y2});
            continue;
        }
        const double low = (y2 - y1) / (x2 - x1), high = (y1 - y0) / (x1 - x0);
        if (low > high) {
            const double chord = (y2 - y0) / (x2 - x0);
            part.slope.*axis = chord;
            part.base.*axis = y2 - chord * x2;
            continue;
        }
        const double slope = how == Slope::early ? std::clamp((after.*axis - y1) / (x2 - x1), low, high) : low;
        part.slope.*axis = slope;
        part.base.*axis = y1 - slope * x1;
    }
    return part;
}

/// CurvePart::raised of a merged part. Infinite: it may not replace the two, because the curve would fall.
double raised_by(const CurvePart& part, const Pair& pair, const Resources& weights) {
    if (weighed(part.slope, weights) < 0) return infinite;
    const double ends = weighed(value(part, pair.to), weights);
    if (pair.next != nullptr && ends > weighed(value(*pair.next, pair.to), weights) * (1 + 1e-13)) return infinite;
    constexpr double nothing = 1e-200;  // what takes nothing counts as this: any more is a great deal, and a number
    double max_raised = std::max(pair.first.raised, pair.second.raised);
    const auto compare = [&](const CurvePart& whole, double accuracy) {
        const double was = weighed(value(whole, accuracy), weights), is = weighed(value(part, accuracy), weights);
        max_raised = std::max(max_raised, whole.raised * is / std::max(was, nothing));
    };
    compare(pair.first, pair.first.from);
    compare(pair.first, pair.second.from);
    compare(pair.second, pair.second.from);
    compare(pair.second, pair.to);
    return max_raised;
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
    const CurvePart part{from, base, slope, 1};
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
        out.add({from, one.base + other.base, one.slope + other.slope, std::max(one.raised, other.raised)});
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
    while (count > Curve::max_parts) {
        std::size_t at = 0;
        CurvePart best;
        double min_key = infinite;
        const auto offer = [&](std::size_t i, CurvePart part, const Pair& pair, double preference) {
            part.raised = raised_by(part, pair, weights);
            if (!(part.raised * preference < min_key)) return;
            at = i;
            best = part;
            min_key = part.raised * preference;
        };
        constexpr double sloped = 0.97;  // a line joins the next part with less loss than a step
        for (std::size_t i = 0; i + 1 < count; ++i) {
            const bool last = i + 2 == count;
            const Pair pair{parts[i], parts[i + 1], last ? end_ : parts[i + 2].from, last ? nullptr : &parts[i + 2]};
            offer(i, merged(pair, Slope::late), pair, 1);
            offer(i, merged(pair, Slope::early), pair, sloped);
            if (last) offer(i, merged(pair, Slope::flat), pair, 1);  // always allowed, and seldom good
        }
        CHECK(std::isfinite(min_key), "The last two parts of a curve may always be merged");
        parts[at] = best;
        std::copy(parts.begin() + static_cast<std::ptrdiff_t>(at) + 2, parts.begin() + static_cast<std::ptrdiff_t>(count),
                  parts.begin() + static_cast<std::ptrdiff_t>(at) + 1);
        --count;
    }
    Curve curve;
    std::copy_n(parts.begin(), count, curve.parts_.begin());
    curve.count_ = count;
    curve.end_ = end_;
    return curve;
}

CurveParts CurveParts::of_forms(std::span<const CurvePoint> forms, const Resources& weights) {
    std::array<const CurvePoint*, max_forms> used{};  // from the finest: those that take less than all finer ones
    std::size_t count = 0;
    for (std::size_t i = forms.size(); i-- > 0;) {
        if (count > 0 && !(weighed(forms[i].takes, weights) < weighed(used[count - 1]->takes, weights))) continue;
        if (count > 0 && used[count - 1]->accuracy == forms[i].accuracy) --count;  // the same, and cheaper
        used[count++] = &forms[i];
    }
    CurveParts out;
    double from = count > 0 ? Curve::of_form(used[count - 1]->accuracy, {}).begin() : 0;
    for (std::size_t i = count; i-- > 0;) {
        out.add(constant(from, used[i]->takes));
        from = after(used[i]->accuracy);
        out.end_ = used[i]->accuracy;
    }
    return out;
}

Curve curve_of_forms(std::span<const CurvePoint> forms, const Resources& weights) {
    std::vector<CurvePoint> known;
    for (const CurvePoint& form : forms)
        if (Curve::of_form(form.accuracy, form.takes).known()) known.push_back(form);
    std::stable_sort(known.begin(), known.end(),
                     [](const CurvePoint& a, const CurvePoint& b) { return a.accuracy < b.accuracy; });
    Curve curve;
    const std::span all(known);
    for (std::size_t first = 0; first < all.size(); first += CurveParts::max_forms) {
        const auto some = all.subspan(first, std::min(CurveParts::max_forms, all.size() - first));
        curve = cheaper_of(curve, CurveParts::of_forms(some, weights).compacted(weights), weights);
    }
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
