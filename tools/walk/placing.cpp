// Which thread runs where, at which priority.
#include "tools/walk/placing.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "input/devices/discoverer.hpp"
#include "input/gpio/line_opener.hpp"
#include "render/gl/device.hpp"
#include "rt/threads/capability.hpp"

namespace surefoot::walk {

namespace {

constexpr const char* worker_name = "sf-worker";

/// As much as the kernel keeps.
std::string kept_name(const std::string& program_name) { return program_name.substr(0, 15); }

}  // namespace

Result<PlacingPlan> plan_placing(const WalkRequest& request, bool fifo_granted) {
    PlacingPlan plan;
    plan.all = rt::allowed_cpus();
    const rt::CpuMask isolated = rt::isolated_cpus(plan.all);
    plan.frame_core = rt::default_frame_core(plan.all, isolated);
    if (plan.all.empty())
        return Error{"cores", "This process may use no core", "Check its affinity (taskset -p)", ErrorKind::no_real_time};
    if (const int wanted = request.frame_core; wanted >= 0)
        (plan.all.has(wanted) || isolated.has(wanted) ? plan.frame_core : plan.absent_core) = wanted;
    plan.fifo = request.fifo && fifo_granted;
    plan.frame_priority = request.frame_priority;
    plan.raster_priority = request.raster_priority;
    plan.worker_priority = request.worker_priority;
    // The driver's caches ("<program>:…") lower themselves; only what rasterises is ours to place.
    for (const std::string& prefix : gl::driver_thread_prefixes()) {
        if (prefix.find(':') == std::string::npos) plan.driver_prefixes.push_back(prefix);
    }
    return plan;
}

Result<std::vector<pid_t>> place_rasterisers(PlacingPlan& plan) {
    std::vector<pid_t> tids;
    for (const std::string& prefix : plan.driver_prefixes) {
        rt::Placement placement;
        placement.policy = plan.fifo ? rt::Policy::fifo : rt::Policy::other;
        placement.priority = plan.fifo ? plan.raster_priority : 0;
        placement.cpus = plan.all;
        auto placed = rt::place_by_prefix(prefix, placement);
        if (!placed) return placed.error();
        tids.insert(tids.end(), placed->begin(), placed->end());
    }
    plan.rasterisers = static_cast<int>(tids.size());
    return tids;
}

std::vector<pid_t> on_frame_core(const PlacingPlan& plan, const std::vector<pid_t>& rasterisers) {
    // They move: on average one core's part of their work is done on the frame core, and that is what one of them does.
    std::vector<pid_t> sharing;
    if (plan.all.has(plan.frame_core) && !rasterisers.empty() && plan.all.count() <= static_cast<int>(rasterisers.size()))
        sharing.push_back(rasterisers.back());
    return sharing;
}

rt::Placement prepare_placement(const PlacingPlan& plan) {
    rt::Placement placement;
    placement.policy = plan.fifo ? rt::Policy::fifo : rt::Policy::other;
    placement.priority = plan.fifo ? plan.worker_priority : 0;
    placement.cpus = plan.all;
    placement.name = "sf-prepare";
    return placement;
}

rt::Placement worker_placement(const PlacingPlan& plan, int number) {
    rt::Placement placement = prepare_placement(plan);
    placement.name = fmt::format("{}-{}", worker_name, number);
    return placement;
}

int count_unnamed(const std::string& program_name) {
    const auto threads = rt::read_threads();
    if (!threads) return 1;
    const std::string kept = kept_name(program_name);
    return static_cast<int>(std::ranges::count_if(*threads, [&](const rt::ThreadInfo& t) { return t.name == kept; }));
}

rt::Placement frame_placement(const PlacingPlan& plan) {
    rt::Placement placement;
    placement.policy = plan.fifo ? rt::Policy::fifo : rt::Policy::other;
    placement.priority = plan.fifo ? plan.frame_priority : 0;
    placement.cpus = rt::CpuMask{plan.frame_core};
    placement.name = "sf-frame";
    return placement;
}

rt::Placement input_placement(const PlacingPlan& plan) {
    rt::Placement placement;
    placement.policy = plan.fifo ? rt::Policy::fifo : rt::Policy::other;
    placement.priority = plan.fifo ? (plan.frame_priority + plan.raster_priority) / 2 : 0;
    placement.cpus = plan.all;
    placement.name = "sf-input";
    return placement;
}

rt::Placement window_placement(const PlacingPlan& plan) {
    rt::Placement placement = input_placement(plan);
    placement.name = "sf-window";
    return placement;
}

std::vector<rt::DeclaredThread> worker_rows(const PlacingPlan& plan) {
    if (plan.workers <= 1) return {};
    const rt::Placement worker = worker_placement(plan, 1);
    return {{.name = worker_name,
             .policy = worker.policy,
             .priority = worker.priority,
             .cpus = worker.cpus,
             .min_count = plan.workers - 1,
             .max_count = plan.workers - 1}};
}

std::vector<rt::DeclaredThread> thread_table(const PlacingPlan& plan, bool real_clock, const std::string& program_name) {
    const rt::Policy real_time = plan.fifo ? rt::Policy::fifo : rt::Policy::other;
    const auto priority = [&](int p) { return plan.fifo ? p : 0; };
    std::vector<rt::DeclaredThread> table;
    // The main thread and what the driver makes for itself (its shader and disk caches lower themselves to BATCH): no more than
    // were there when ours had their names, so that none of ours hides among them.
    table.push_back({.name = kept_name(program_name),
                     .whole_name = true,
                     .policy = rt::Policy::other,
                     .cpus = plan.all,
                     .min_count = 1,
                     .max_count = plan.unnamed});
    table.push_back(
        {.name = program_name.substr(0, 7) + ":disk", .policy = rt::Policy::batch, .cpus = {}, .min_count = 0, .max_count = 16});
    table.push_back(
        {.name = program_name.substr(0, 7) + ":sh", .policy = rt::Policy::other, .cpus = {}, .min_count = 0, .max_count = 16});
    table.push_back({.name = "sf-frame",
                     .policy = real_time,
                     .priority = priority(plan.frame_priority),
                     .cpus = rt::CpuMask{plan.frame_core}});
    table.push_back({.name = "sf-monitor", .policy = rt::Policy::other, .cpus = plan.all});
    table.push_back({.name = "sf-service", .policy = rt::Policy::other, .cpus = plan.all, .min_count = 0});  // the daemon's
    // Whoever watches the walk serves readers and writes incidents beside it.
    for (const char* name : {"sf-console", "sf-incidents"})
        table.push_back({.name = name, .policy = rt::Policy::other, .cpus = {}, .min_count = 0});
    if (real_clock && plan.input) {
        const rt::Placement input = input_placement(plan);
        table.push_back({.name = input.name, .policy = input.policy, .priority = input.priority, .cpus = input.cpus});
    }
    if (real_clock && plan.window) {
        const rt::Placement window = window_placement(plan);
        table.push_back({.name = window.name, .policy = window.policy, .priority = window.priority, .cpus = window.cpus});
    }
    if (real_clock && plan.devices) {
        table.push_back({.name = input::devices_thread_name, .policy = rt::Policy::other, .cpus = plan.all});
        table.push_back({.name = input::lines_thread_name, .policy = rt::Policy::other, .cpus = plan.all, .min_count = 0});
    }
    if (real_clock) {
        const rt::Placement prepare = prepare_placement(plan);
        table.push_back({.name = prepare.name, .policy = prepare.policy, .priority = prepare.priority, .cpus = prepare.cpus});
    }
    for (rt::DeclaredThread& row : worker_rows(plan)) table.push_back(std::move(row));
    for (const std::string& prefix : plan.driver_prefixes) {
        table.push_back({.name = prefix,
                         .policy = real_time,
                         .priority = priority(plan.raster_priority),
                         .cpus = plan.all,
                         .min_count = plan.driver_prefixes.size() == 1 ? plan.rasterisers : 0,
                         .max_count = 64});
    }
    return table;
}

}  // namespace surefoot::walk
