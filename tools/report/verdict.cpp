// The verdict in words. Says what was measured, claims no more.
#include "tools/report/verdict.hpp"

#include <fmt/format.h>

#include <cmath>

#include "tools/report/svg.hpp"

namespace surefoot::report {

namespace {

constexpr double own_misses_allowed_per_frame = 2.0 / 1800.0;

std::string counted(std::uint64_t count, std::string_view one, std::string_view many) {
    return fmt::format("{} {}", grouped(static_cast<double>(count)), count == 1 ? one : many);
}

}  // namespace

Verdict verdict_of(const WalkSummary& s) {
    if (s.frames == 0) return Verdict::bad;
    if (s.misses == 0 && s.skipped == 0) return Verdict::good;
    const bool own = static_cast<double>(s.own_misses) > own_misses_allowed_per_frame * static_cast<double>(s.frames);
    return own || rule_broken(s.control) ? Verdict::bad : Verdict::warn;
}

bool rule_broken(const ControlSummary& c) { return c.ran && !(c.verdict.own_holds && c.verdict.control_holds); }

std::string headline(const WalkSummary& s) {
    if (s.frames == 0) return "No frame was drawn.";
    const double period_ms = s.rate_hz > 0 ? 1000.0 / s.rate_hz : 0;
    std::string text = fmt::format("{}, {} missed", counted(s.frames, "frame", "frames"), grouped(static_cast<double>(s.misses)));
    if (s.misses > 0 && s.own_misses == 0) text += ", none of them by its own doing";
    if (s.misses > 0 && s.own_misses > 0)
        text += fmt::format(", {} by its own doing", grouped(static_cast<double>(s.own_misses)));
    text += s.frame_ms.max > period_ms
                ? fmt::format(": the slowest took {:.1f} ms where {:.1f} were allowed", s.frame_ms.max, period_ms)
                : fmt::format(": the slowest took {:.1f} of {:.1f} ms", s.frame_ms.max, period_ms);
    if (s.skipped > 0) text += fmt::format("; {} skipped", counted(s.skipped, "slot was", "slots were"));
    return text + ".";
}

std::string control_words(const ControlSummary& c) {
    if (!c.ran) return {};
    const rt::DeadlineVerdict& v = c.verdict;
    std::string text = fmt::format(
        "Over {} pairs of blocks the walk missed {} of {} frames, {} by its own doing. A bare loop of the same cost missed {}",
        v.pairs, v.walk_misses, v.walk_frames, v.own_misses, v.control_misses);
    text += v.control_holds ? fmt::format(": no more than the machine itself (p = {:.2f}).", v.p_value)
                            : fmt::format(": the walk misses more (p = {:.2g}).", v.p_value);
    if (c.other_miss_share >= 0)
        text += fmt::format(" Without real-time scheduling the bare loop missed {}{}.", percent(c.other_miss_share),
                            v.load_counts ? ": the load counts" : "; below a fifth, so the load was too light to judge");
    if (rule_broken(c)) return text + " The deadline rule is broken.";
    if (v.holds) return text + " The deadline rule holds.";
    return text + (v.enough_pairs ? " The deadline rule is not judged." : " Too few pairs to judge the deadline rule.");
}

std::string off_axis_words(const WalkSummary& s) {
    if (s.shift_x == 0 && s.shift_y == 0) return {};
    return fmt::format(", off axis by {:.4g} halves right, {:.4g} up,", s.shift_x, s.shift_y);
}

std::string seat_words(const WalkSummary& s) {
    std::string text;
    if (s.seat.given)
        text = fmt::format("{:g} cm wide at {:g} cm: {:.1f} x {:.1f} degrees", s.seat.screen_width_cm, s.seat.eye_distance_cm,
                           s.seat.fov_x_deg, s.seat.fov_y_deg);
    if (s.acuity_arcmin > 0) text += fmt::format("{}acuity {:.3g} arcmin", text.empty() ? "" : "; ", s.acuity_arcmin);
    return text;
}

std::string input_words(const InputSummary& in) {
    if (!in.given) return {};
    std::string text = counted(in.reports, "report", "reports");
    for (const rt::SteeringDevice& d : in.devices)
        text += fmt::format(" of {} ({})", d.name.empty() ? "a " + d.device_class + " device" : d.name, d.mapping);
    if (in.refused > 0) text += fmt::format(", {} refused", grouped(static_cast<double>(in.refused)));
    text += fmt::format("; from report to submitted frame {:.1f} ms (p50), {:.1f} (p99), {:.1f} at most", in.age_ms.p50,
                        in.age_ms.p99, in.age_ms.max);
    if (in.to_shown_ms.max > 0)
        text += fmt::format(", to the picture shown {:.1f} (p50), {:.1f} (p99)", in.to_shown_ms.p50, in.to_shown_ms.p99);
    if (in.stops > 0) text += fmt::format("; {}", counted(in.stops, "emergency stop", "emergency stops"));
    if (in.stopped_frames > 0)
        text += fmt::format("; the walk stood still for {}", counted(in.stopped_frames, "frame", "frames"));
    if (in.stop_latched) text += ", and until the end: the stop is latched";
    return text + ".";
}

std::string threads_words(std::span<const rt::CensusRow> threads) {
    std::string text;
    for (const rt::CensusRow& t : threads) {
        text += text.empty() ? "" : "; ";
        if (t.count > 1) text += fmt::format("{} ", t.count);
        text += fmt::format("{} {}", t.name, rt::policy_name(t.policy));
        if (t.priority > 0) text += fmt::format(" {}", t.priority);
        text += " on " + t.cpus.text();
    }
    return text;
}

std::string accuracy_words(double accuracy) {
    if (std::isinf(accuracy)) return "exact";
    if (!(accuracy > 0)) return "unknown";
    const double degrees = 57.29577951308232 / accuracy;
    if (degrees > 180) return "over 180°";  // an error larger than its distance: the eye is inside it
    return degrees >= 0.1 ? fmt::format("{:.2g}°", degrees) : fmt::format("{:.2g}′", degrees * 60);
}

std::string picture_words(const PictureSummary& picture) {
    return fmt::format("PSNR {:.1f} dB (worst {:.1f}, frame {}), SSIM {:.3f}, FLIP {:.3f}; {} frames against full detail",
                       picture.psnr_db, picture.worst_psnr_db, picture.worst_frame, picture.ssim, picture.flip, picture.frames);
}

std::string decibels(double db) {
    if (std::isfinite(db)) return fmt::format("{:.1f} dB", db);
    return db > 0 ? "∞ dB" : "undefined";
}

std::string percent(double share) {
    const double value = share * 100;
    return std::abs(value) < 10 && value != 0 ? fmt::format("{:.1f} %", value) : fmt::format("{:.0f} %", value);
}

}  // namespace surefoot::report
