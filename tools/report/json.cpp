// `walk --json`: exactly the keys of the contract, figures rounded to what was measured.
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/report/report.hpp"
#include "tools/report/rounded.hpp"

namespace surefoot::report {

namespace {

using Json = nlohmann::ordered_json;

constexpr auto shown_missing = "no picture was presented: the virtual clock has no display, or the device was lost";

Json tail(const Quantiles& q) {
    return {{"p50", rounded(q.p50)}, {"p99", rounded(q.p99)}, {"p999", rounded(q.p999)}, {"max", rounded(q.max)}};
}

Json control_of(const ControlSummary& control) {
    Json blocks = Json::array();
    for (const ControlBlock& b : control.blocks)
        blocks.push_back({{"walk", b.walk},
                          {"frames", b.frames},
                          {"misses", b.misses},
                          {"own_misses", b.own_misses},
                          {"steal_ms", rounded(b.steal_ms)}});
    // A p-value keeps its digits: 0.0004 is not 0.
    const rt::DeadlineVerdict& v = control.verdict;
    Json json = {{"misses", v.control_misses}, {"p_value", control.ran ? Json(v.p_value) : Json(nullptr)}, {"blocks", blocks}};
    if (!control.ran) return json;
    json["walk_misses"] = v.walk_misses;
    json["walk_frames"] = v.walk_frames;
    json["own_misses"] = v.own_misses;
    json["pairs"] = v.pairs;
    json["burn_ms"] = rounded(control.burn_ms);
    json["other_miss_share"] = rounded(control.other_miss_share);
    json["rule"] = {{"holds", v.holds},
                    {"own_misses", v.own_holds},
                    {"not_above_control", v.control_holds},
                    {"enough_pairs", v.enough_pairs},
                    {"load_counts", v.load_counts}};
    return json;
}

Json threads_of(const std::vector<rt::CensusRow>& threads) {
    Json rows = Json::array();
    for (const rt::CensusRow& t : threads)
        rows.push_back({{"name", t.name},
                        {"count", t.count},
                        {"policy", std::string(rt::policy_name(t.policy))},
                        {"priority", t.priority},
                        {"cores", t.cpus.text()}});
    return rows;
}

/// Null where a path was followed.
Json input_of(const InputSummary& in) {
    if (!in.given) return nullptr;
    Json devices = Json::array();
    for (const rt::SteeringDevice& d : in.devices)
        devices.push_back({{"name", d.name}, {"class", d.device_class}, {"mapping", d.mapping}});
    return {
        {"source", in.source},
        {"devices", in.devices.size()},
        {"steered_by", devices},
        {"reports", in.reports},
        {"reports_shown", in.reports_shown},
        {"refused", in.refused},
        {"illegal_encoder_steps", in.illegal_encoder_steps},
        {"age_ms", {{"p50", rounded(in.age_ms.p50)}, {"p99", rounded(in.age_ms.p99)}, {"max", rounded(in.age_ms.max)}}},
        {"stops", in.stops},
        {"stopped_frames", in.stopped_frames},
        {"stop_latched", in.stop_latched},
        {"silences", in.timeouts},
        {"overflows", in.overflows},
        {"losses", in.losses},
        {"presses", {{"next_viewpoint", in.next_viewpoint}, {"reset", in.reset}, {"tour", in.tour}, {"pause", in.pause}}},
        {"jumps", in.jumps},
        {"walked", in.walked},
        {"returns", in.returns},
        {"freed", in.freed},
        {"put_aside", in.put_aside},
        {"passed_through", in.passed_through},
        {"filter_lag_ms", rounded(in.filter_lag_ms)},
        {"sunlight_presses", in.switches.sunlight},
        {"shadows_presses", in.switches.shadows},
        {"lamps_presses", in.switches.lamps},
        {"fog_presses", in.switches.fog},
        {"guard_violations", in.guard_violations},
        {"to_shown_ms", in.to_shown_ms.max > 0 ? Json({{"p50", rounded(in.to_shown_ms.p50)},
                                                       {"p99", rounded(in.to_shown_ms.p99)},
                                                       {"max", rounded(in.to_shown_ms.max)}})
                                               : Json(nullptr)},
    };
}

Json worst_forms_of(const std::vector<WorstForm>& forms) {
    Json list = Json::array();
    for (const WorstForm& f : forms)
        list.push_back({{"node", f.node},
                        {"name", f.name},
                        {"kind", f.node_kind},
                        {"form", f.form},
                        {"triangles", f.triangles},
                        {"error_share", rounded(f.error_share)},
                        {"pictures", f.pictures},
                        {"frame", f.frame}});
    return list;
}

Json dropped_of(const std::vector<DroppedSummary>& parts) {
    Json list = Json::array();
    for (const DroppedSummary& part : parts)
        list.push_back({{"part", part.part},
                        {"frames", part.frames},
                        {"times", part.falls},
                        {"first_frame", part.first_frame},
                        {"value_per_us", rounded(part.first_value_per_us)}});
    return list;
}

/// Null where no picture was compared.
Json picture_of(const PictureSummary& p) {
    if (p.frames == 0) return nullptr;
    // Shares of pixels keep their digits: a thousandth of a picture is seen.
    const Json popping = p.pop_frames == 0 ? Json(nullptr)
                                           : Json({{"frames", p.pop_frames},
                                                   {"pixels", p.popped_share},
                                                   {"worst_pixels", p.worst_popped_share},
                                                   {"psnr_db", rounded(p.pop_psnr_db)}});
    Json json = {{"frames", p.frames},
                 {"psnr_db", rounded(p.psnr_db)},
                 {"worst_psnr_db", rounded(p.worst_psnr_db)},
                 {"worst_frame", p.worst_frame},
                 {"ssim", rounded(p.ssim)},
                 {"flip", rounded(p.flip)},
                 {"popping", popping}};
    if (p.forms_compared) {
        json["worst_forms"] = worst_forms_of(p.worst_forms);
        json["resolution_error_share"] = rounded(p.resolution_error_share);
    }
    return json;
}

/// Null where it is not known; shown_missing says why.
void add_shown(const ShownSummary& s, Json& json) {
    const bool shown = s.by != rt::ShownBy::nothing, several = s.one_percent_low_hz > 0;
    json["shown_by"] = shown ? Json(rt::name_of(s.by)) : Json(nullptr);
    if (!shown) json["shown_missing"] = shown_missing;
    json["shown_interval_ms"] = several ? tail(s.interval_ms) : Json(nullptr);
    json["shown_error_us"] = s.on_grid ? tail(s.error_us) : Json(nullptr);
    json["animation_error_ms"] = several ? tail(s.animation_error_ms) : Json(nullptr);
    json["one_percent_low_hz"] = several ? Json(rounded(s.one_percent_low_hz)) : Json(nullptr);
}

/// Null where the display reports nothing.
Json display_of(const DisplaySummary& d) {
    if (d.pictures == 0) return nullptr;
    return {{"pictures", d.pictures},
            {"replaced", d.replaced},
            {"after_ms", {{"p50", rounded(d.after_ms.p50)}, {"p99", rounded(d.after_ms.p99)}, {"max", rounded(d.after_ms.max)}}}};
}

Json guarantee_of(const GuaranteeSummary& g) {
    Json broken = Json::object();
    for (const auto& [reason, frames] : g.broken) broken[reason] = frames;
    const bool binds = g.binding_node != rt::no_node;
    return {{"accuracy", rounded(g.accuracy)},
            {"kept_frames", g.kept},
            {"broken_frames", broken},
            {"reached_min", rounded(g.reached_min)},
            {"worst_frame", binds ? Json(g.worst_frame) : Json(nullptr)},
            {"binding_node", binds ? Json(g.binding_node) : Json(nullptr)},
            {"binding_name", binds ? Json(g.binding_name) : Json(nullptr)}};
}

/// Null where no seat is given.
Json seat_of(const SeatSummary& s) {
    if (!s.given) return nullptr;
    return {{"screen_width_cm", rounded(s.screen_width_cm)},
            {"eye_distance_cm", rounded(s.eye_distance_cm)},
            {"fov_x_deg", rounded(s.fov_x_deg)},
            {"fov_y_deg", rounded(s.fov_y_deg)}};
}

Json of_pictures(const PicturesSummary& p) {
    return {{"drawn_mean", rounded(p.drawn_mean)},
            {"reused_mean", rounded(p.reused_mean)},
            {"boxes_as_triangles_mean", rounded(p.as_triangles_mean)},
            {"made", p.made},
            {"max_bytes", p.max_bytes},
            {"draw_us", rounded(p.draw_us_mean)},
            {"make_us", {{"mean", rounded(p.make_us_mean)}, {"max", rounded(p.make_us_max)}}},
            {"uncovered_items", p.uncovered}};
}

}  // namespace

std::string to_json(const WalkSummary& s) {
    Json causes = Json::object();
    for (const auto& [cause, count] : s.miss_causes) causes[cause] = count;
    Json json = {
        {"frames", s.frames},
        {"slots", s.slots},
        {"skipped", s.skipped},
        {"misses", s.misses},
        {"own_misses", s.own_misses},
        {"miss_causes", causes},
        {"core_steal_misses", s.core_steal_known ? Json(s.core_steal_misses) : Json(nullptr)},
        {"frame_ms", tail(s.frame_ms)},
        {"wake_us", tail(s.wake_us)},
        {"select_us", tail(s.select_us)},
        {"prepare_cpu_us", tail(s.prepare_cpu_us)},
        {"prepared_age",
         {{"p50", rounded(s.prepared_age.p50)}, {"p99", rounded(s.prepared_age.p99)}, {"max", rounded(s.prepared_age.max)}}},
        {"budget_ms", rounded(s.budget_ms)},
        {"cost_scale", s.cost_scale},
        {"budget_used", {{"mean", rounded(s.budget_used_mean)}, {"p99", rounded(s.budget_used_p99)}}},
        {"cost_error",
         {{"p50", rounded(s.cost_error.p50)}, {"p90", rounded(s.cost_error.p90)}, {"p99", rounded(s.cost_error.p99)}}},
        {"accuracy", {{"min", rounded(s.accuracy_min)}, {"mean", rounded(s.accuracy_mean)}}},
        {"triangles", {{"mean", rounded(s.triangles_mean)}, {"max", s.triangles_max}}},
        {"resolution", {{"mean", rounded(s.resolution_mean)}, {"min", rounded(s.resolution_min)}}},
        {"samples", {{"drawn", s.samples}, {"as_requested", !s.other_samples}}},
        {"filter", rt::name_of(s.filter)},
        {"trilinear_frames", s.trilinear_frames},
        {"shadow_map", {{"refreshes", s.shadow_refreshes}, {"shown_frames", s.shadow_frames}}},
        {"pictures", of_pictures(s.pictures)},
        {"rest",
         {{"frames", s.rest_frames},
          {"full_detail_frames", s.rested_frames},
          {"samples", s.rest_samples},
          {"full_detail_ms", rounded(s.rest_ms)}}},
        {"downgrades", s.downgrades},
        {"coarse_frames", s.coarse_frames},
        {"floor_frames", s.floor_frames},
        {"unused_ms",
         {{"mean", rounded(s.unused_ms.mean)}, {"p50", rounded(s.unused_ms.p50)}, {"p99", rounded(s.unused_ms.p99)}}},
        {"switches_per_frame", rounded(s.switches_per_frame)},
        {"cut_hash", s.cut_hash},
        {"steal_ms", rounded(s.steal_ms)},
        {"rt",
         {{"fifo", s.fifo},
          {"pinned", s.pinned},
          {"isolated", s.isolated},
          {"locked", s.locked},
          {"page_faults", s.page_faults},
          {"guard_violations", s.guard_violations},
          {"driver_allocations_per_frame", rounded(s.driver_allocations_per_frame)}}},
        {"threads", threads_of(s.threads)},
        {"calibrated", s.uncalibrated.empty()},
        {"control", control_of(s.control)},
        {"input", input_of(s.input)},
        {"picture", picture_of(s.picture)},
        {"seat", seat_of(s.seat)},
        {"acuity_arcmin", s.acuity_arcmin > 0 ? Json(rounded(s.acuity_arcmin)) : Json(nullptr)},
    };
    add_shown(s.shown, json);
    json["display"] = display_of(s.display);
    json["dropped_parts"] = dropped_of(s.dropped_parts);
    if (s.guarantee.accuracy > 0) json["guarantee"] = guarantee_of(s.guarantee);
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace surefoot::report
