// Recorded paths as CSV: strict about rows, forgiving about the last column; and poses in between.
#include "rt/base/path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>
#include <variant>

#include "rt/base/file.hpp"
#include "rt/base/text.hpp"

namespace surefoot {

namespace {

constexpr double radians_per_degree = 0.017453292519943295;
constexpr std::string_view columns = "time_s,x,y,z,qx,qy,qz,qw,fov_y_deg";
constexpr std::size_t pose_columns = 8;

std::vector<std::string_view> fields_of(std::string_view line) {
    std::vector<std::string_view> fields;
    for (;;) {
        const auto comma = line.find(',');
        fields.push_back(trimmed(line.substr(0, comma)));
        if (comma == std::string_view::npos) return fields;
        line.remove_prefix(comma + 1);
    }
}

/// A number too large for a double reads as infinity, one too small as zero.
std::optional<double> saturated_number(std::string_view field) {
    double value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    const bool overflow = error == std::errc::result_out_of_range;
    if (overflow)
        value = field.find("e-") != std::string_view::npos || field.find("E-") != std::string_view::npos ? 0.0 : HUGE_VAL;
    if ((error != std::errc{} && !overflow) || end != field.data() + field.size()) return std::nullopt;
    return value;
}

bool is_header(const std::vector<std::string_view>& fields) { return fields.front() == "time_s"; }

/// Of a column's number, either side of zero.
double limit_of(std::size_t column) {
    if (column == 0) return path_time_limit_s;
    if (column <= 3) return path_coordinate_limit_m;
    return column < pose_columns ? path_quaternion_limit : HUGE_VAL;  // the field of view has limits of its own
}

/// One row to a sample, or what is wrong with it.
struct RowProblem {
    std::string what;
};
std::variant<PathSample, RowProblem> read_row(const std::vector<std::string_view>& fields, bool last_is_fov) {
    if (fields.size() != pose_columns && fields.size() != pose_columns + 1)
        return RowProblem{
            fmt::format("The row has {} columns instead of {} or {}", fields.size(), pose_columns, pose_columns + 1)};
    std::array<double, pose_columns + 1> v{};
    for (std::size_t i = 0; i < fields.size(); ++i) {
        if (i == pose_columns && !last_is_fov) break;
        const auto value = saturated_number(fields[i]);
        if (!value) return RowProblem{fmt::format("Column {} holds '{}', which is not a number", i + 1, fields[i])};
        if (!std::isfinite(*value)) return RowProblem{fmt::format("Column {} holds '{}', which is not finite", i + 1, fields[i])};
        if (std::abs(*value) > limit_of(i))
            return RowProblem{fmt::format("Column {} holds {}, which is beyond {}", i + 1, fields[i], limit_of(i))};
        v[i] = *value;
    }
    PathSample sample;
    sample.time_s = v[0];
    sample.pose.position = {v[1], v[2], v[3]};
    const double length = std::sqrt(v[4] * v[4] + v[5] * v[5] + v[6] * v[6] + v[7] * v[7]);
    if (!(length > 1e-9) || !std::isfinite(length)) return RowProblem{"The quaternion qx,qy,qz,qw has no length"};
    sample.pose.orientation = dquat(v[7] / length, v[4] / length, v[5] / length, v[6] / length);
    if (last_is_fov && fields.size() == pose_columns + 1) {
        if (v[8] < 1.0 || v[8] > 179.0)
            return RowProblem{fmt::format("The field of view fov_y_deg is {}, not within 1 to 179", v[8])};
        sample.pose.fov_y_rad = v[8] * radians_per_degree;
    }
    return sample;
}

}  // namespace

Result<Path> read_path(const std::string& file) {
    const auto text = read_text(file);
    if (!text) return text.error();
    std::string_view rest = *text;
    if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);

    Path path;
    bool last_is_fov = false;
    for (int line_number = 1; !rest.empty(); ++line_number) {
        const auto newline = rest.find('\n');
        const std::string_view line = trimmed(rest.substr(0, newline));
        rest.remove_prefix(newline == std::string_view::npos ? rest.size() : newline + 1);
        if (line.empty()) continue;
        if (line.front() == '#') {
            if (path.samples.empty() && line.find("fov_y_deg") != std::string_view::npos) last_is_fov = true;
            continue;
        }
        const auto fields = fields_of(line);
        if (path.samples.empty() && is_header(fields)) {
            last_is_fov = fields.size() == pose_columns + 1 && fields.back() == "fov_y_deg";
            continue;
        }
        const auto place = fmt::format("{}:{}", file, line_number);
        const auto remedy = fmt::format("Write rows of {}", columns);
        auto row = read_row(fields, last_is_fov);
        if (const auto* problem = std::get_if<RowProblem>(&row)) return Error{place, problem->what, remedy, ErrorKind::damaged};
        const auto& sample = std::get<PathSample>(row);
        if (!path.samples.empty() && !(sample.time_s > path.samples.back().time_s))
            return Error{place, fmt::format("Time {} does not come after {}", sample.time_s, path.samples.back().time_s),
                         "Put the rows in order of time", ErrorKind::damaged};
        path.samples.push_back(sample);
    }
    if (path.samples.empty())
        return Error{file, "The file holds no poses", fmt::format("Write rows of {}", columns), ErrorKind::damaged};
    return path;
}

Result<void> write_path(const std::string& file, const Path& path) {
    std::string text(columns);
    text += '\n';
    for (const PathSample& s : path.samples) {
        const dvec3& p = s.pose.position;
        const dquat& q = s.pose.orientation;
        fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{}\n", s.time_s, p.x, p.y, p.z, q.x, q.y, q.z, q.w,
                       s.pose.fov_y_rad / radians_per_degree);
    }
    return write_text(file, text);
}

Pose sample_path(const Path& path, double time_s) {
    if (path.samples.empty()) return {};
    const auto& samples = path.samples;
    const double wanted_s = samples.front().time_s + time_s;
    const auto after =
        std::upper_bound(samples.begin(), samples.end(), wanted_s, [](double t, const PathSample& s) { return t < s.time_s; });
    if (after == samples.begin()) return samples.front().pose;
    if (after == samples.end()) return std::isfinite(time_s) || time_s > 0 ? samples.back().pose : samples.front().pose;
    const PathSample& a = *(after - 1);
    const PathSample& b = *after;
    const double t = (wanted_s - a.time_s) / (b.time_s - a.time_s);
    Pose pose;
    pose.position = glm::mix(a.pose.position, b.pose.position, t);
    pose.orientation = glm::normalize(glm::slerp(a.pose.orientation, b.pose.orientation, t));
    pose.fov_y_rad = a.pose.fov_y_rad + (b.pose.fov_y_rad - a.pose.fov_y_rad) * t;
    return pose;
}

}  // namespace surefoot
