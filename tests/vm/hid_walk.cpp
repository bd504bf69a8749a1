// The walk itself: follows a real device, stops when it is pulled, resumes after neutral, is held by a wall, and leaves a
// picture.
#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <string_view>
#include <thread>

#include "tests/time_units.hpp"
#include "tests/vm/hid_checks.hpp"
#include "tests/vm/uhid.hpp"

namespace surefoot::vm {

namespace {

struct Row {
    std::int64_t due_ns = 0;
    double x = 0, y = 0, z = 0;
};

std::vector<std::string> cells(const std::string& row) {
    std::vector<std::string> out;
    std::istringstream s(row);
    for (std::string cell; std::getline(s, cell, ',');) out.push_back(cell);
    return out;
}

/// The ledger's poses; none where it has not the columns.
std::vector<Row> ledger(const std::string& file) {
    std::ifstream in(file);
    std::string text;
    std::getline(in, text);
    std::map<std::string, std::size_t> at;
    for (const std::string& name : cells(text)) at.emplace(name, at.size());
    std::vector<Row> rows;
    if (!at.contains("due_ns") || !at.contains("x") || !at.contains("y") || !at.contains("z")) return rows;
    while (std::getline(in, text)) {
        const auto v = cells(text);
        if (v.size() >= at.size())
            rows.push_back({std::stoll(v[at["due_ns"]]), std::stod(v[at["x"]]), std::stod(v[at["y"]]), std::stod(v[at["z"]])});
    }
    return rows;
}

/// Metres gone between the frames that were due in between; -1: fewer than two frames.
double gone(const std::vector<Row>& rows, std::int64_t from_ns, std::int64_t to_ns) {
    const Row *first = nullptr, *last = nullptr;
    for (const Row& r : rows)
        if (r.due_ns >= from_ns && r.due_ns <= to_ns) {
            if (first == nullptr) first = &r;
            last = &r;
        }
    return first == last ? -1 : std::hypot(last->x - first->x, last->y - first->y, last->z - first->z);
}

void hold(UhidDevice& device, int y, int ms, int x = 128) {
    for (const std::int64_t from = now_ns(); ms_since(from) < ms; sleep_ms(4)) device.send(pad_at(x, y));
}

/// `surefoot walk` in a child; what it says is read as it comes.
class WalkingTool {
public:
    explicit WalkingTool(const std::string& command) : pipe_(popen((command + " 2>&1").c_str(), "re")) {
        reader_ = std::thread([this] {
            std::array<char, 4096> line{};
            while (pipe_ != nullptr && std::fgets(line.data(), static_cast<int>(line.size()), pipe_) != nullptr) {
                output_ += line.data();
                if (std::string_view(line.data()).find("The device steers by the mapping") != std::string_view::npos) ++steers_;
            }
            ended_ = true;
        });
    }
    ~WalkingTool() { end(); }
    WalkingTool(const WalkingTool&) = delete;
    WalkingTool& operator=(const WalkingTool&) = delete;
    /// How often a device has begun to steer.
    [[nodiscard]] int steers() const { return steers_; }
    [[nodiscard]] bool ended() const { return ended_; }
    /// Waits for its end; its exit status as of wait().
    int end() {
        if (reader_.joinable()) reader_.join();
        if (pipe_ != nullptr) status_ = pclose(pipe_);
        pipe_ = nullptr;
        return status_;
    }
    [[nodiscard]] const std::string& output() const { return output_; }  ///< after end()

private:
    std::FILE* pipe_;
    std::string output_;
    std::atomic<int> steers_ = 0;
    std::atomic<bool> ended_ = false;
    int status_ = -1;
    std::thread reader_;
};

struct WalkKind {
    std::string name, backend, more;
    int limit_s = 0;
    int longer = 1;  ///< times as long at rest, where frames take their time; pushed no longer, or it would walk out of the room
};

/// Moves, pulls, replugs deflected, releases, moves: and what the ledger says of it. The ledger's clock is ours.
void walk_with(Checks& checks, const Guest& guest, const WalkKind& kind) {
    const std::string file = guest.keep + "/" + kind.name + ".csv";
    const auto pad = like(guest, "f310-like");
    auto device = std::make_unique<UhidDevice>(pad, "walk");
    (void)device->node();
    // Emulated on a busy host, FIFO threads would leave nothing to the hand that moves the pad.
    WalkingTool walk(fmt::format("timeout {} {} walk {} --input devices --backend {} --no-fifo --state {} --ledger {} --json {}",
                                 kind.limit_s, guest.tool, guest.model, kind.backend, guest.keep, file, kind.more));
    const auto until_steers = [&](int times) {
        while (walk.steers() < times && !walk.ended()) hold(*device, times == 1 ? 128 : 0, 20);
    };
    until_steers(1);
    hold(*device, 128, 1000);
    const std::int64_t pushed = now_ns();
    hold(*device, 0, 2500);
    const std::int64_t pulled = now_ns();
    device->unplug();
    sleep_ms(2000 * kind.longer);
    const std::int64_t back = now_ns();
    device = std::make_unique<UhidDevice>(pad, "walk");
    until_steers(2);
    hold(*device, 0, 1500 * kind.longer);  // deflected since it came
    const std::int64_t neutral = now_ns();
    hold(*device, 128, 500);
    const std::int64_t again = now_ns();
    hold(*device, 0, 2500);
    const std::int64_t released = now_ns();
    hold(*device, 128, 500);
    const int status = walk.end();
    std::ofstream(guest.keep + "/" + kind.name + ".txt") << walk.output();
    const auto rows = ledger(file);
    const double follows = gone(rows, pushed + 500 * ms, pulled), stops = gone(rows, pulled + 500 * ms, back),
                 waits = gone(rows, back, neutral), resumes = gone(rows, again + 500 * ms, released);
    checks.check(kind.name,
                 status == 0 && follows > 0.3 && stops >= 0 && stops < 1e-9 && waits >= 0 && waits < 1e-9 && resumes > 0.3,
                 fmt::format("{}: followed {:.2f} m, pulled {:.3f} m, replugged deflected {:.3f} m, after neutral {:.2f} m; {} "
                             "frames, status {}",
                             kind.backend, follows, stops, waits, resumes, rows.size(), status));
}

/// Straight on until a wall holds the visitor, then to the side: it goes along the wall, and no nearer to it.
void walk_against_a_wall(Checks& checks, const Guest& guest) {
    const std::string file = guest.keep + "/walk.wall.csv";
    UhidDevice device(like(guest, "f310-like"), "wall");
    (void)device.node();
    WalkingTool walk(
        fmt::format("timeout 120 {} walk {} --input devices --backend null --rate 10 --seconds 32 --no-fifo --state {} "
                    "--ledger {} --json",
                    guest.tool, guest.model, guest.keep, file));
    while (walk.steers() < 1 && !walk.ended()) hold(device, 128, 20);
    hold(device, 128, 1000);
    const std::int64_t pushed = now_ns();
    hold(device, 0, 15'000);
    const std::int64_t aside = now_ns();
    hold(device, 128, 2000, 255);
    const std::int64_t released = now_ns();
    hold(device, 128, 500);
    const int status = walk.end();
    std::ofstream(guest.keep + "/walk.wall.txt") << walk.output();
    const auto rows = ledger(file);
    const double came = gone(rows, pushed, aside), held = gone(rows, aside - 2000 * ms, aside),
                 along = gone(rows, aside, released);
    double nearer = 0;  // to the wall, while it went along it
    const Row *first = nullptr, *at_wall = nullptr;
    for (const Row& r : rows) {
        if (r.due_ns < aside) at_wall = &r;
        if (first == nullptr && r.due_ns >= pushed) first = &r;
        if (r.due_ns < aside || r.due_ns > released || first == nullptr || at_wall == nullptr || !(came > 0)) continue;
        const double on_x = (at_wall->x - first->x) / came, on_z = (at_wall->z - first->z) / came;
        nearer = std::max(nearer, (r.x - at_wall->x) * on_x + (r.z - at_wall->z) * on_z);
    }
    const bool walked = walk.output().find("\"walked\": true") != std::string::npos;
    checks.check(
        "walk.wall", status == 0 && walked && came > 2 && held >= 0 && held < 0.01 && along > 0.3 && nearer < 0.01,
        fmt::format("came {:.2f} m, then the wall held it ({:.4f} m in two seconds), went {:.2f} m along it and {:.4f} m "
                    "nearer; {} frames, status {}",
                    came, held, along, nearer, rows.size(), status));
}

}  // namespace

void check_walk(Checks& checks, const Guest& guest) {
    if (output_of(guest.tool + " walk --help").find("--steering") == std::string::npos ||
        output_of(guest.tool + " walk --help").find("`devices`") == std::string::npos)
        return checks.not_run("walk", "this build has no live input");
    if (!std::filesystem::exists(guest.model)) return checks.not_run("walk", "no model came with it");
    walk_with(checks, guest, {"walk", "null", "--rate 10 --seconds 25", 120});
    walk_against_a_wall(checks, guest);
    const std::string pictures = guest.keep + "/pictures";
    // Emulated, a frame of this size takes up to half a second, and one of what the built-in cost table would allow ten.
    walk_with(checks, guest,
              {"walk.drawn", "egl", "--rate 3 --size 160x120 --cost-scale 100 --seconds 30 --snap " + pictures + " --every 10",
               200, 2});
    std::size_t count = 0, least = SIZE_MAX;
    std::error_code problem;
    for (const auto& entry : std::filesystem::directory_iterator(pictures, problem))
        if (entry.path().extension() == ".png") {
            ++count;
            least = std::min<std::size_t>(least, entry.file_size());
        }
    checks.check("walk.picture", count >= 2 && least > 2000,
                 fmt::format("{} pictures kept, the smallest of {} bytes", count, count > 0 ? least : 0));
}

}  // namespace surefoot::vm
