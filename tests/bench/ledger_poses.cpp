// Bench tool: the poses of a walk's pictures, as a path that stands at each, so that another selector can draw them.
// A ledger counts frames, not slots: after a miss, picture N is not of the path's N-th place. Its slots say where each was, and
// the path itself gives the exact pose. The ledger's rounded pose must agree. bench_ledger_poses PATH.csv LIFT_M RATE_HZ
// LEDGER.csv EVERY OUT.csv -> one JSON object. Walk OUT.csv at 30 Hz with `--every 4`.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/file.hpp"
#include "rt/clock/grid.hpp"
#include "tools/walk/pose_source.hpp"

namespace {

using namespace surefoot;

constexpr int stand_frames = 4;  // the region has settled on the pose before its picture is taken
constexpr double stand_rate_hz = 30;
constexpr double rounding_m = 2e-4, rounding_part = 2e-6;  // of a ledger

int fail(const std::string& what) {
    fmt::print(stderr, "bench_ledger_poses: {}\n", what);
    return 1;
}

std::vector<std::string_view> split(std::string_view text, char at) {
    std::vector<std::string_view> parts;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(at, begin), text.size());
        parts.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

/// A row of a ledger, by column.
using Row = std::map<std::string_view, double, std::less<>>;

std::vector<Row> rows_of(std::string_view ledger) {
    std::vector<Row> rows;
    std::vector<std::string_view> names;
    for (const std::string_view line : split(ledger, '\n')) {
        if (line.empty()) continue;
        const auto cells = split(line, ',');
        if (names.empty()) {
            names = cells;
            continue;
        }
        Row& row = rows.emplace_back();
        for (std::size_t i = 0; i < std::min(names.size(), cells.size()); ++i) {
            double value = 0;
            if (std::from_chars(cells[i].data(), cells[i].data() + cells[i].size(), value).ec == std::errc{})
                row[names[i]] = value;
        }
    }
    return rows;
}

/// How far a pose is off the ledger's: metres, and parts of the quaternion.
struct Off {
    double metres = 0, part = 0;
};
Off off(const Pose& pose, const Row& row) {
    const dvec3 eye(row.at("x"), row.at("y"), row.at("z"));
    const dquat reported(row.at("qw"), row.at("qx"), row.at("qy"), row.at("qz"));
    const double sign = glm::dot(reported, pose.orientation) < 0 ? -1 : 1;
    Off o{glm::length(eye - pose.position), 0};
    for (int i = 0; i < 4; ++i) o.part = std::max(o.part, std::abs(sign * reported[i] - pose.orientation[i]));
    return o;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 7) return fail("usage: bench_ledger_poses PATH.csv LIFT_M RATE_HZ LEDGER.csv EVERY OUT.csv");
    auto path = read_path(argv[1]);
    if (!path) return fail(path.error().text());
    for (PathSample& sample : path->samples) sample.pose.position.y += std::atof(argv[2]);
    const auto period_ns = rt::period_of_rate_ns(std::atof(argv[3]));
    if (!period_ns) return fail(period_ns.error().text());
    const auto text = read_text(argv[4]);
    if (!text) return fail(text.error().text());
    const auto every = static_cast<std::uint64_t>(std::max(1, std::atoi(argv[5])));
    walk::PathPoses poses(*path, *period_ns);
    Path held;
    Off most;
    int frame = 0, pictures = 0;
    for (const Row& row : rows_of(*text)) {
        for (const auto* column : {"frame", "slot", "x", "y", "z", "qx", "qy", "qz", "qw"})
            if (!row.contains(column)) return fail(fmt::format("{}: no number in column {}", argv[4], column));
        if (static_cast<std::uint64_t>(row.at("frame")) % every != 0) continue;
        const Pose pose = poses.sample({.path_slot = static_cast<std::uint64_t>(row.at("slot")), .due_ns = 0, .now_ns = 0}).pose;
        const Off o = off(pose, row);
        most = {std::max(most.metres, o.metres), std::max(most.part, o.part)};
        // The first stands from half way, so that frame 4 N is well within the stand at pose N.
        for (const int end = stand_frames * pictures + stand_frames / 2; frame < end; ++frame)
            held.samples.push_back({frame / stand_rate_hz, pose});
        ++pictures;
    }
    if (pictures == 0) return fail(fmt::format("{}: no frame of a picture", argv[4]));
    if (most.metres > rounding_m || most.part > rounding_part)
        return fail(fmt::format("{}: its poses are {} m and {} off those of {}", argv[4], most.metres, most.part, argv[1]));
    if (auto written = write_path(argv[6], held); !written) return fail(written.error().text());
    fmt::print("{{\"pictures\": {}, \"frames\": {}, \"off_m\": {}, \"off_quaternion\": {}}}\n", pictures,
               stand_frames * (pictures - 1) + 1, most.metres, most.part);
    return 0;
}
