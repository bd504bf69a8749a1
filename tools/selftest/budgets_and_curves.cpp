// Rows: budgets, costs and corrections at their ends; pictures without contrast; clocks that step.
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "input/motion/motion.hpp"
#include "render/measure/image_metrics.hpp"
#include "rt/base/random.hpp"
#include "rt/clock/grid.hpp"
#include "rt/frame/controller.hpp"
#include "tools/selftest/cut_fixture.hpp"
#include "tools/selftest/families.hpp"

namespace surefoot::selftest {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
const double nan = std::nan("");

Pose over_the_row() {
    Pose pose;
    pose.position = {0, 2, 12};
    return pose;
}

bool is_search(std::string_view selector) { return (*select::selector_named(selector))->goes_by == select::GoesBy::budget; }

void odd_budgets(const Effort&, Outcome& out) {
    std::uint64_t cuts = 0, over = 0, made = 0;
    for (const std::uint32_t leaves : {1U, 2U, 300U}) {
        for (const bool free : {false, true}) {
            CutFixture fixture(star(leaves, 3));
            if (free) {
                for (model::CostGrid& grid : fixture.costs().grids)
                    std::fill(grid.cells.begin(), grid.cells.end(), model::ItemCost{});
                fixture.costs().combine = {0, 0, 0, 0};
                fixture.costs().slice_us = 0;
            }
            const prepare::PreparedFrame& frame = fixture.prepare({over_the_row(), 0, 0});
            cuts += frame.candidates.empty() ? 1 : unsound(frame, fixture.costs());
            for (const std::string_view selector : select::selector_names()) {
                for (const double budget_us : {0.0, -1.0, 1e-300, 700.0, 1e300, nan, infinity, -infinity}) {
                    for (const double correction : {1.0, 0.0, -3.0, nan, infinity, 1e300}) {
                        fixture.forget();
                        const select::Cut& cut = fixture.select(selector, budget_us, correction);
                        ++made;
                        if (correction != 1e300) cuts += illegal(frame, cut);
                        const bool search = is_search(selector);
                        const double allowed = std::max(budget_us > 0 ? budget_us : 0.0, static_cast<double>(cut.floor_us));
                        over += search && !(static_cast<double>(cut.predicted_us) <= allowed) ? 1 : 0;
                        if (correction == 1.0) out.digest_of(cut.hash);
                    }
                }
            }
        }
    }
    out.none_of("cuts that are illegal or not finite", cuts);
    out.none_of("searches over budget and floor", over);
    out.at_least("cuts", static_cast<double>(made), 2000);
    out.cut_hash = out.digest;
}

void many_children(const Effort& effort, Outcome& out) {
    const auto count = static_cast<std::uint32_t>(effort.count(1'000'000, 20'000));
    prepare::PrepareOptions options;
    options.max_candidates = count + 1;
    options.max_choices = 2 * count + 1;
    options.full_depth = true;
    CutFixture fixture(star(count, 2), options);
    Pose pose;
    pose.position = {1500, 4000, 10};  // above the middle of the square, looking down on all of it
    pose.orientation = glm::angleAxis(-1.2, dvec3(1, 0, 0));
    pose.fov_y_rad = 2.5;
    const prepare::PreparedFrame& frame = fixture.prepare({pose, 0, 0}, {1280, 720});
    std::uint64_t bad = unsound(frame, fixture.costs());
    std::size_t max_items = 0;
    for (const double budget_us : {0.0, 20000.0, infinity}) {
        const select::Cut& cut = fixture.select(select::usual_selector, budget_us);
        bad += illegal(frame, cut);
        max_items = std::max(max_items, cut.items.size());
        out.digest_of(cut.hash);
    }
    out.none_of("numbers and cuts that are not finite, out of order or illegal", bad);
    out.at_least("items of the largest cut", static_cast<double>(max_items), 0.3 * count);
    if (count < 1'000'000) out.scaled = std::to_string(count) + " children of 1000000";
}

void deep_chain(const Effort&, Outcome& out) {
    constexpr std::uint32_t depth = 10'000;
    prepare::PrepareOptions options;
    options.full_depth = true;
    CutFixture fixture(chain(depth), options);
    const prepare::PreparedFrame& frame = fixture.prepare({{}, 0, 0});
    std::uint64_t bad = unsound(frame, fixture.costs());
    for (const std::string_view selector : select::selector_names()) {
        const select::Cut& cut = fixture.select(selector, infinity);
        bad += illegal(frame, cut) + (cut.items.size() == 1 ? 0 : 1);
        out.digest_of(cut.hash);
    }
    out.none_of("numbers and cuts that are not finite, out of order or illegal", bad);
    out.exactly("candidates of the chain", static_cast<double>(frame.candidates.size()), depth);
}

/// All alike: what is refined may follow no chance, and may not change from frame to frame.
void equal_benefits(const Effort&, Outcome& out) {
    CutFixture fixture(star(1000, 3));
    Pose pose;
    pose.position = {48, 0.5, 1e6};  // so far away that every box looks the same
    pose.fov_y_rad = 1e-3;
    const prepare::PreparedFrame& frame = fixture.prepare({pose, 0, 0});
    const double budget_us = 0.75 * static_cast<double>(fixture.select(select::full_detail_selector, infinity).predicted_us);
    std::uint64_t flicker = 0, bad = frame.candidates.empty() ? 1 : 0;
    std::size_t fewest = 1000;
    model::Index coarsest = 99, finest = 0;  // forms that the default shows
    for (const std::string_view selector : select::selector_names()) {
        fixture.forget();
        const select::Cut& first = fixture.select(selector, budget_us);
        const std::uint64_t hash = first.hash;
        fewest = std::min(fewest, is_search(selector) ? first.items.size() : fewest);
        if (selector == select::usual_selector) {
            for (const select::CutItem& item : first.items) {
                const model::Index form = item.rep - fixture.model().nodes[item.node].first_rep;
                coarsest = std::min(coarsest, form);
                finest = std::max(finest, form);
            }
        }
        for (int i = 0; i < 20; ++i) {
            const select::Cut& cut = fixture.select(selector, budget_us);
            flicker += cut.hash != hash || cut.switches != 0 ? 1 : 0;
            bad += illegal(frame, cut);
        }
        out.digest_of(hash);
    }
    out.none_of("frames that differ from the first", flicker);
    out.none_of("cuts that are illegal or not finite", bad);
    out.at_least("items of the smallest cut", static_cast<double>(fewest), 1000);
    out.at_least("forms between the default's coarsest and finest", static_cast<double>(finest) - static_cast<double>(coarsest),
                 1);
}

void odd_costs(const Effort&, Outcome& out) {
    rt::CostController controller;
    std::uint64_t bad = 0;
    const double max_counter = 18446744073709551615.0;  // a 64-bit counter that went below zero
    for (const double actual : {0.0, -1.0, nan, infinity, -infinity, max_counter * 1e9, 1e-300, -max_counter}) {
        for (const double predicted : {0.0, -1.0, nan, infinity, 1000.0, 1e-300}) {
            controller.update(predicted, actual);
            const double f = controller.factor(), u = controller.headroom(1.5);
            bad += f >= rt::CostController::lowest && f <= rt::CostController::highest && u >= 1 && u <= 1.5 ? 0 : 1;
        }
    }
    out.none_of("factors out of their bounds after a query that is 0, negative, wraps or is no number", bad);
    rt::CostController steady;
    for (int i = 0; i < 200; ++i) steady.update(1000, 1000);
    double moved = 0;
    for (int i = 0; i < 150; ++i) {
        steady.update(1000, i % 15 < 7 ? 10000 : 1000);  // seven outliers of ten times in fifteen frames
        moved = std::max(moved, std::abs(steady.factor() - 1));
    }
    out.at_most("factor moved by seven tenfold outliers in fifteen frames", moved, 1e-12);
    for (int i = 0; i < 20; ++i) steady.update(1000, 2000);
    out.at_least("factor 20 frames after true costs doubled", steady.factor(), 1.99);
}

/// The wall clock never comes in; the monotonic one must not leap the eye, whatever it does.
void odd_clocks(const Effort&, Outcome& out) {
    input::MotionState state;
    input::MotionLimits limits;
    input::Command command;
    command.request.forward = 1;
    command.request.turn = 0.5;
    std::int64_t now = 1'000'000'000;
    for (int i = 0; i < 300; ++i) (void)input::step(state, limits, command, now += 16'666'667);
    double leap = 0;
    std::uint64_t bad = 0;
    // A step back, a suspend of a year, a frame of 10 s, the same time twice, and both ends of the counter.
    const std::int64_t year = 31'557'600'000'000'000;
    for (const std::int64_t to : {now - 5'000'000'000, now + year, now + year + 10'000'000'000, now + year + 10'000'000'000,
                                  std::numeric_limits<std::int64_t>::max(), std::int64_t{0}}) {
        const dvec3 before = state.position;
        const input::NavigationSample sample = input::step(state, limits, command, to);
        leap = std::max(leap, glm::length(state.position - before));
        bad += std::isfinite(glm::length(sample.pose.position)) && std::abs(glm::length(sample.pose.orientation) - 1) < 1e-12 ? 0
                                                                                                                              : 1;
    }
    out.at_most("way in one step over any gap", leap, limits.max_m_s * input::longest_step_s, "m");
    out.none_of("poses that are not finite", bad);
    // The grid: one late frame of each length, and the books must balance.
    std::uint64_t wrong = 0;
    const rt::Grid grid{1'000'000, 16'666'667};
    for (const rt::LatePolicy late : {rt::LatePolicy::lock, rt::LatePolicy::floating}) {
        for (const std::int64_t length :
             {std::int64_t{0}, grid.period_ns, grid.period_ns + 1, std::int64_t{10'000'000'000}, year}) {
            for (const std::uint64_t slot : {std::uint64_t{0}, std::uint64_t{1'000'000'000}}) {
                const std::int64_t finished = grid.due_ns(slot) + length;
                const rt::NextSlot next = rt::next_slot(grid, late, slot, finished);
                wrong += 1 + std::uint64_t{next.skipped} == next.slot - slot ? 0 : 1;
                wrong += next.missed == (length > grid.period_ns) ? 0 : 1;
                wrong += next.start_ns >= finished || !next.missed ? 0 : 1;
                wrong += grid.deadline_ns(next.slot) > finished ? 0 : 1;
            }
        }
    }
    out.none_of("slots that run + skipped = elapsed does not hold for", wrong);
}

std::vector<std::uint8_t> filled(std::size_t pixels, std::uint8_t value) { return std::vector<std::uint8_t>(4 * pixels, value); }

void flat_pictures(const Effort&, Outcome& out) {
    std::uint64_t wrong = 0;
    const auto want = [&](bool holds) { wrong += holds ? 0 : 1; };
    const auto black = filled(4096, 0), white = filled(4096, 255), grey = filled(4096, 127);
    auto nearly = black;
    nearly[4000] = 1;
    want(measure::snr(black, black).db == infinity && measure::snr(black, black).defined);
    want(!measure::snr(white, grey).defined && std::isfinite(measure::snr(white, grey).mse));
    const measure::Snr one = measure::snr(nearly, black);
    want(one.defined && std::isfinite(one.db) && one.mse > 0);
    want(!measure::snr({}, {}).defined && !measure::snr(black, filled(16, 0)).defined);
    std::uint64_t out_of_range = 0;
    const std::array<const std::vector<std::uint8_t>*, 4> pictures = {&black, &white, &grey, &nearly};
    for (const auto* a : pictures) {
        for (const auto* b : pictures) {
            const double s = measure::ssim(*a, *b, 64, 64);
            out_of_range += s >= -1 && s <= 1 ? 0 : 1;
            want(a != b || s == 1.0);
            for (const auto& [w, h] : {std::pair{1U, 4096U}, {4096U, 1U}, {2U, 2048U}}) {
                const double thin = measure::ssim(*a, *b, w, h);
                out_of_range += thin >= -1 && thin <= 1 ? 0 : 1;
            }
            out.digest_of(std::bit_cast<std::uint64_t>(std::round(s * 1e6)));
        }
    }
    want(measure::ssim(black, white, 64, 64) < 0.01);
    want(measure::ssim({}, {}, 0, 0) == 0);
    out.none_of("figures other than worked out by hand", wrong);
    out.none_of("SSIM not within -1 to 1", out_of_range);
}

}  // namespace

std::span<const Row> budgets_and_curves_rows() {
    static constexpr std::array<Row, 7> table = {{
        {"N13a", "budgets_and_curves",
         "budgets 0, negative, not a number, infinite; corrections of the same kinds; costs and zero costs; 1, 2 and 300 leaves",
         "legal finite cuts, no search over its budget or the floor", odd_budgets},
        {"N13b", "budgets_and_curves", "a node with a million children", "finite numbers in order, legal cuts", many_children},
        {"N13c", "budgets_and_curves", "a chain of ten thousand nodes, each the only child",
         "no recursion ends it, legal cuts of one item", deep_chain},
        {"N13d", "budgets_and_curves", "a thousand objects of equal benefit and cost, budget for some",
         "the same cut in every frame, no switches", equal_benefits},
        {"N23a", "budgets_and_curves", "cost queries 0, negative, wrapped, not a number; outliers; true costs doubled",
         "the correction stays in its bounds, is deaf to outliers and follows what is true", odd_costs},
        {"N23b", "budgets_and_curves",
         "clock back 5 s, suspended for a year, a frame of 10 s, the same time twice, the counter's end",
         "the eye does not leap; run + skipped = elapsed", odd_clocks},
        {"N20", "budgets_and_curves", "SNR and SSIM of black, equal, constant pictures, one byte apart, one pixel wide",
         "the documented values", flat_pictures},
    }};
    return table;
}

}  // namespace surefoot::selftest
