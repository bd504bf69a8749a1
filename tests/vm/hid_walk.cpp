// The walk itself: follows a real device, stops when it is pulled, resumes after neutral, and leaves a picture.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <thread>

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

void hold(UhidDevice& device, int y, int ms) {
    for (const std::int64_t from = now_ns(); ms_since(from) < ms; sleep_ms(4)) device.send(pad_at(128, y));
}

constexpr std::int64_t ms = 1'000'000;

/// Moves, pulls, replugs deflected, releases, moves: and what the ledger says of it.
void walk_with(Checks& checks, const Guest& guest, const std::string& name, const std::string& backend, const std::string& more) {
    const std::string file = guest.keep + "/" + name + ".csv", said_file = guest.keep + "/" + name + ".txt";
    const auto pad = like(guest, "f310-like");
    auto device = std::make_unique<UhidDevice>(pad, "walk");
    (void)device->node();
    std::string said;
    int status = -1;
    std::thread walk([&] {
        said = output_of(
            fmt::format("timeout 100 {} walk {} --input devices --backend {} --rate 10 --size 320x240 --seconds 14 --no-fifo "
                        "--state {} --ledger {} --json {}",
                        guest.tool, guest.model, backend, guest.keep, file, more),
            &status);
    });
    // It looks for devices when the model is loaded; the pad is at rest meanwhile. The ledger's clock is ours.
    for (const std::int64_t from = now_ns(); ms_since(from) < 3000; sleep_ms(4)) device->send(pad_at(128, 128));
    const std::int64_t pushed = now_ns();
    hold(*device, 0, 2000);
    const std::int64_t pulled = now_ns();
    device->unplug();
    sleep_ms(1500);
    const std::int64_t back = now_ns();
    device = std::make_unique<UhidDevice>(pad, "walk");
    (void)device->node();
    hold(*device, 0, 1500);  // deflected since it came
    const std::int64_t neutral = now_ns();
    hold(*device, 128, 500);
    const std::int64_t again = now_ns();
    hold(*device, 0, 2000);
    const std::int64_t released = now_ns();
    hold(*device, 128, 500);
    walk.join();
    std::ofstream(said_file) << said;
    const auto rows = ledger(file);
    const double follows = gone(rows, pushed + 500 * ms, pulled), stops = gone(rows, pulled + 300 * ms, back),
                 waits = gone(rows, back, neutral), resumes = gone(rows, again + 500 * ms, released);
    checks.check(
        name, status == 0 && follows > 0.5 && stops >= 0 && stops < 1e-9 && waits >= 0 && waits < 1e-9 && resumes > 0.5,
        fmt::format(
            "{}: followed {:.2f} m, pulled {:.3f} m, replugged deflected {:.3f} m, after neutral {:.2f} m; {} frames, status {}",
            backend, follows, stops, waits, resumes, rows.size(), status));
}

}  // namespace

void check_walk(Checks& checks, const Guest& guest) {
    if (output_of(guest.tool + " walk --help").find("--steering") == std::string::npos ||
        output_of(guest.tool + " walk --help").find("`devices`") == std::string::npos)
        return checks.not_run("walk", "this build has no live input");
    if (!std::filesystem::exists(guest.model)) return checks.not_run("walk", "no model came with it");
    walk_with(checks, guest, "walk", "null", "");
    const std::string pictures = guest.keep + "/pictures";
    walk_with(checks, guest, "walk.drawn", "egl", "--snap " + pictures + " --every 20");
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
