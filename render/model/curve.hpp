// Accuracy curves: the least that an accuracy takes, part by part linear. Sums make the curve of a group, minima that of an
// object with several forms. Page: curve.md. Source: Pasman & Jansen 2002, 3.1, 3.2 and 3.4.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace surefoot::model {

/// What is spent on a picture, kept apart; or the weight of each in one number.
struct Resources {
    double submit_us = 0, raster_us = 0, triangles = 0, texels = 0;
};

/// From the accuracy `from` up to the next part: base + slope * accuracy. What merging has made of it is at most `raised` times
/// what is needed, by the weights.
struct CurvePart {
    double from = 0;
    Resources base, slope;
    double raised = 1;
};

/// The accuracies of a curve go from its first part's `from` to `end`, that included; infinite: exact. A smaller accuracy takes
/// what the first takes. By `weights` no curve falls as the accuracy rises; single resources may. Accuracies are of one kind,
/// relative or absolute, as the caller has it. A curve without parts is unknown: no form is known, or a figure was none.
class Curve {
public:
    static constexpr std::size_t max_parts = 16;

    Curve() = default;
    /// Of one form. Unknown unless accuracy > 0 and all figures are finite and >= 0.
    static Curve of_form(double accuracy, const Resources& takes);
    /// Of a form that is made at any accuracy between two. Unknown unless 0 < from <= to < infinity, and slope >= 0.
    static Curve of_line(double from, double to, const Resources& base, const Resources& slope);

    [[nodiscard]] bool known() const { return count_ > 0; }
    [[nodiscard]] std::span<const CurvePart> parts() const { return std::span(parts_).first(count_); }
    [[nodiscard]] double begin() const { return count_ > 0 ? parts_[0].from : 0; }
    [[nodiscard]] double end() const { return end_; }
    /// What an accuracy takes; above the end, what the end takes. Nothing, where the curve is unknown.
    [[nodiscard]] Resources at(double accuracy) const;
    /// The same curve with all accuracies times a factor > 0: another distance, or the size of another group.
    [[nodiscard]] Curve scaled(double factor) const;

private:
    friend class CurveParts;
    std::array<CurvePart, max_parts> parts_{};
    std::size_t count_ = 0;
    double end_ = 0;
};

/// A form of an object: what it takes for its accuracy.
struct CurvePoint {
    double accuracy = 0;  ///< infinite: exact
    Resources takes;
};

/// An operation's result before it is cut down to a Curve: exact, with more parts. On the stack; allocates nothing.
class CurveParts {
public:
    /// Of a group: each accuracy of both. Above its end, a child shows its best. Unknown where either is.
    static CurveParts sum(const Curve& a, const Curve& b);
    /// Of an object with two forms: what takes less, by `weights`. No form serves above its end. The other, where one is unknown.
    static CurveParts cheaper(const Curve& a, const Curve& b, const Resources& weights);

    /// Of at most `max_forms` forms, ascending by accuracy, each known.
    static CurveParts of_forms(std::span<const CurvePoint> forms, const Resources& weights);
    static constexpr std::size_t max_forms = 6 * Curve::max_parts;

    [[nodiscard]] std::span<const CurvePart> parts() const { return std::span(parts_).first(count_); }
    [[nodiscard]] double end() const { return end_; }
    /// At most Curve::max_parts parts. Neighbours are merged into one that takes no less anywhere: no promise grows. Those go
    /// first whose merged part is raised least, with what earlier merging has raised.
    [[nodiscard]] Curve compacted(const Resources& weights) const;

private:
    static constexpr std::size_t capacity = 8 * Curve::max_parts;
    void add(const CurvePart& part);

    std::array<CurvePart, capacity> parts_{};
    std::size_t count_ = 0;
    double end_ = 0;
};

/// Of an object with these forms, in any order; unknown ones are left out. Nearer to them than cheaper_of() one by one, which
/// merges without knowing the next.
Curve curve_of_forms(std::span<const CurvePoint> forms, const Resources& weights);

/// sum() and cheaper(), compacted.
Curve sum_of(const Curve& a, const Curve& b, const Resources& weights);
Curve cheaper_of(const Curve& a, const Curve& b, const Resources& weights);

/// One number of resources: each times its weight.
inline double weighed(const Resources& r, const Resources& weights) {
    return r.submit_us * weights.submit_us + r.raster_us * weights.raster_us + r.triangles * weights.triangles +
           r.texels * weights.texels;
}

/// The greatest accuracy of the curve that takes at most `room` by both weights; the larger of two sums is two such limits.
/// 0: its first part takes more, or the curve is unknown.
double accuracy_within(const Curve& curve, const Resources& weights, const Resources& other_weights, double room);

/// The least-squares line through points, r = base + slope * accuracy, and the share of r's variance that it explains (R^2).
struct FittedLine {
    double base = 0, slope = 0, r_squared = 0;
};
/// Points with an infinite accuracy are left out. Below two points all is 0.
FittedLine fit_line(std::span<const double> accuracy, std::span<const double> takes);

}  // namespace surefoot::model
