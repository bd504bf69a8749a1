// The walk's frame: take the newest pose, take the newest prepared set, select, submit, account, present.
#include "tools/walk/walk_stages.hpp"

#include <algorithm>
#include <limits>

#include "rt/frame/blame.hpp"
#include "rt/threads/guard.hpp"
#include "tools/walk/frame_share.hpp"
#include "tools/walk/light.hpp"

namespace surefoot::walk {

namespace {
constexpr std::size_t steps = model::resolution_steps.size();
static_assert(rt::Corrections::states == 2 * steps, "A correction for each resolution, with one mip level and with two");

std::size_t state_of(float resolution, bool filtered) { return model::resolution_step(resolution) + (filtered ? steps : 0); }

static_assert(model::none == rt::no_node);

/// rad^-1; infinite where all is exact.
float accuracy_of(float error_rad) {
    return error_rad > model::exact_up_to_rad ? 1.0F / error_rad : std::numeric_limits<float>::infinity();
}

constexpr double max_margin_share = 0.2;  // of the mean limit: more would only draw everything coarse

std::int64_t clock_now(void* context) { return static_cast<const rt::Clock*>(context)->now_ns(); }
}  // namespace

void KeptFrame::reserve(const Engine& engine) {
    engine.reserve(prepared);
    select::reserve(cut, engine.options().prepare.max_candidates);
    memory.reserve(engine.options().prepare.max_candidates);
}

capture::Capture capture_of(const KeptFrame& kept, const WalkRequest& request, const Engine& engine) {
    const select::SelectInput input{
        &engine.model(),       &kept.prepared,   &engine.costs(),          kept.budget_us, kept.correction.factor,
        kept.target_error_rad, request.slice_us, kept.correction.headroom, &kept.offered,  engine.options().max_error_rad};
    capture::Capture taken =
        capture::take(input, request.selector,
                      {kept.memory, kept.bought_before, engine.options().hysteresis, engine.options().reserve_share}, kept.cut);
    taken.frame = kept.frame;
    return taken;
}

WalkStages::WalkStages(Engine& engine, PoseSource& pose_source, rt::Clock& clock, rt::TripleBuffer<PoseSample>& poses,
                       rt::TripleBuffer<prepare::PreparedFrame>& prepared, SnapshotStore& snapshots, KeptFrame& kept,
                       const WalkStagesOptions& options)
    : engine_(engine),
      pose_source_(pose_source),
      clock_(clock),
      poses_(poses),
      prepared_(prepared),
      snapshots_(snapshots),
      kept_(kept),
      options_(options),
      request_(options.request),
      limit_(options.limit_us, static_cast<double>(options.period_ns) * 1e-3, options.shared_cores),
      virtual_clock_(options.request.clock == rt::ClockKind::virtual_time),
      called_for_(engine.model().called_for()) {}

Fault WalkStages::inject(FramePhase phase, const rt::FrameRecord& record) const {
    if (options_.inject == nullptr) return Fault::none;
    const Fault fault = (*options_.inject)(phase, record);
    if (fault == Fault::context_lost && options_.lost != nullptr) options_.lost->store(true);
    return fault;
}

void WalkStages::inject_submit(rt::FrameRecord& record) const {
    if (options_.inject == nullptr) return;
    const std::int64_t from_ns = clock_.now_ns();
    if (inject(FramePhase::submit, record) == Fault::upload) record.upload_ns += clock_.now_ns() - from_ns;
}

/// Real work for the rasterisers, for as long as the fault wants it.
void WalkStages::inject_raster(const rt::FrameRecord& record, std::int64_t begun_ns) {
    while (inject(FramePhase::raster, record) == Fault::draw_again) {
        engine_.draw_unbudgeted(now_.pose, engine_.drawn(), engine_.shown_pictures(), 1, rt::TextureFilter::automatic);
        report_.finished_us = static_cast<double>(clock_.now_ns() - begun_ns) * 1e-3;
    }
}

Correction WalkStages::correction_at(float resolution, bool filtered) const {
    const float of_table = engine_.costs().headroom;
    if (!request_.correct_costs) return {1.0, static_cast<double>(of_table)};
    const std::size_t state = state_of(resolution, filtered);
    return {corrections_.factor(state), corrections_.of(state).headroom(static_cast<double>(of_table))};
}

double WalkStages::margin_us() const { return std::min(overshoot_.margin_us(), max_margin_share * limit_.us()); }

/// What presenting takes of the time that frames are planned for: it has the rest of the period before that.
double WalkStages::taken_by_lead_us() const {
    return std::max(0.0, lead_us_ - (1 - frame_share) * static_cast<double>(options_.period_ns) * 1e-3);
}

SubmitLimits WalkStages::frame_limits() const {
    SubmitLimits limits;
    limits.limit_us = limit_.next_us() - taken_by_lead_us();
    limits.deadline_us = static_cast<double>(options_.period_ns) * 1e-3 - lead_us_;
    limits.margin_us = margin_us();
    return limits;
}

/// What a cut may take from now on, spent_us after the frame was due.
double WalkStages::planned_us(const Correction& by, double spent_us) const {
    spent_us += taken_by_lead_us();
    const double budget_us = std::max(0.0, options_.budget_us - spent_us);
    return request_.in_frame_check ? std::min(budget_us, limit_.plan_us(spent_us, margin_us(), by.headroom)) : budget_us;
}

PrepareHints WalkStages::hints() const {
    PrepareHints hints;
    // One headroom for all: that of a resolution that is not drawn says nothing of these frames.
    const Correction drawn = correction_at(learnt_resolution_, filtered_);
    for (std::size_t step = 0; step < hints.planned_us.size(); ++step) {
        const double factor =
            request_.correct_costs ? corrections_.expected(state_of(model::resolution_steps[step], filtered_)) : drawn.factor;
        hints.planned_us[step] = planned_us(drawn, 0) / (factor * drawn.headroom);
    }
    if (request_.correct_costs) hints.form_ratio = forms_.ratio();
    hints.time_s = walk_time_s();
    const double period_s = static_cast<double>(options_.period_ns) * 1e-9;
    hints.span_s = span_s(period_s);
    return hints;
}

void WalkStages::rehearse(std::int64_t until_ns) {
    if (!rehearses(request_, virtual_clock_)) return;
    gl::Device& device = engine_.device();
    device.draws.plays();
    std::int64_t due_ns = clock_.now_ns();
    for (int i = 0; i < rehearsed_frames && due_ns < until_ns - 2 * options_.period_ns; ++i) {
        clock_.sleep_until_ns(due_ns);
        const auto is_set = [](const std::atomic<bool>* flag) {
            return flag != nullptr && flag->load(std::memory_order_relaxed);
        };
        if (is_set(options_.stop) || is_set(options_.left) || device.lost()) break;
        prepared_.refresh();
        const prepare::PreparedFrame& set = prepared_.front();
        limit_.count(set);
        const FramePose newest = pose_source_.sample({0, due_ns, clock_.now_ns()});
        show(light_at(newest));
        publish_rehearsed(newest, due_ns);
        const std::int64_t begun_ns = due_ns;
        due_ns += options_.period_ns;
        if (!covers(set.region, newest.pose, set.viewport)) continue;  // a button leads elsewhere
        SubmitLimits limits = frame_limits();
        limits.now_ns = clock_now;
        limits.now_context = &clock_;
        const Correction correction = correction_at(set.resolution, false);
        engine_.select(set, planned_us(correction, 0), correction, options_.target_error_rad);
        report_ = engine_.submit(newest.pose, limits);
        device.present();
        learn(report_.finished_us);
        limit_.ended(static_cast<double>(clock_.now_ns() - begun_ns) * 1e-3);
        due_ns = std::max(due_ns, clock_.now_ns());
    }
    rehearsed_ = walked_;
}

void WalkStages::publish_rehearsed(const FramePose& newest, std::int64_t due_ns) {
    PoseSample& sample = poses_.back();
    sample = {};
    sample.frame = walked_++;
    sample.time_ns = due_ns;
    sample.pose = newest.pose;
    sample.before = newest.before;
    sample.dt_s = static_cast<double>(options_.period_ns) * 1e-9;
    sample.predicted = newest.predicted;
    sample.hints = hints();
    sample.valid = true;
    poses_.publish();
}

void WalkStages::sample(rt::FrameRecord& record) {
    inject(FramePhase::sample, record);
    lead_us_ = static_cast<double>(options_.period_ns - (record.deadline_ns - record.due_ns)) * 1e-3;
    const double period_s = static_cast<double>(options_.period_ns) * 1e-9;
    // With a control, the walk goes on where its last block ended: slots of the bare loop do not advance the path.
    path_slot_ = request_.control ? walked_ - rehearsed_ : record.slot;
    FramePose newest = pose_source_.sample(frame_time(record));
    if (request_.stills && virtual_clock_) {
        newest.jumped = true;
        newest.before = newest.pose;
        newest.predicted = {};
        newest.predicted.known = true;
        newest.predicted.region = {newest.pose, 0, 0};
    }
    const bool unseen = !now_.valid || newest.jumped;  // no frame has seen where this one's motion comes from
    if (virtual_clock_) {
        // Prepares from the pose of one frame ago, as the workers would. A jump of the eye is known to them, so it is used at
        // once.
        if (unseen) {
            now_.pose = newest.pose;
            now_.before = newest.before;
            now_.predicted = newest.predicted;
            now_.dt_s = period_s;
        }
        now_.hints.time_s = walk_time_s();  // it is known when the frame is due
        show(light_at(newest));             // and so is its light
        prepare_inline();
    }
    now_.before = unseen ? newest.before : now_.pose;
    now_.dt_s = period_s * (1.0 + (request_.control || unseen ? 0 : record.skipped_before));
    now_.predicted = newest.predicted;
    now_.frame = walked_++;
    now_.time_ns = record.due_ns;
    now_.hints = hints();
    now_.valid = true;
    take(newest, record);
    now_.hints.covered = engine_.cover(now_.pose, region_after(now_, period_s));
    poses_.back() = now_;
    poses_.publish();
}

FrameTime WalkStages::frame_time(const rt::FrameRecord& record) const { return {path_slot_, record.due_ns, clock_.now_ns()}; }

rt::ShownLight WalkStages::light_at(const FramePose& at) const {
    return {rt::switched(request_, at.switches), hour_at(request_, walk_time_s())};
}

/// An hour's light is worked out once, when it comes.
void WalkStages::show(const rt::ShownLight& light) {
    show_light(engine_, {light.on, light.hour == shown_hour_ ? rt::no_hour : light.hour});
    shown_hour_ = light.hour;
}

double WalkStages::walk_time_s() const {
    return static_cast<double>(path_slot_) * static_cast<double>(options_.period_ns) * 1e-9;
}

void WalkStages::take(const FramePose& from, rt::FrameRecord& record) {
    const Pose& pose = now_.pose = from.pose;
    record.eye = {pose.position.x, pose.position.y, pose.position.z};
    record.orientation = {pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w};
    record.input_stamp_ns = from.stamp_ns;
    record.input_reports = from.reports;
    record.stopped = from.stopped;
    record.light = light_at(from);
    show(record.light);
    engine_.set_time(walk_time_s());
}

/// What came while the cut was chosen still counts, as far as the cut was made for it.
void WalkStages::latch(rt::FrameRecord& record) {
    const rt::OwnScope own;  // the submission around it is the driver's, this is not
    FramePose newest;
    if (!pose_source_.latch(frame_time(record), newest)) return;
    if (coarse_ || covers(prepared_.front().region, newest.pose, prepared_.front().viewport)) take(newest, record);
}

void WalkStages::prepare_inline() {
    const rt::DriverScope not_the_frame_threads_own;  // the workers' library may allocate
    prepare_after(engine_, now_, static_cast<double>(options_.period_ns) * 1e-9, options_.clip, prepared_.back());
    prepared_.publish();
}

void WalkStages::select(rt::FrameRecord& record) {
    inject(FramePhase::select, record);
    prepared_.refresh();
    const prepare::PreparedFrame& set = prepared_.front();
    const std::uint64_t age = now_.frame - std::min(set.frame, now_.frame);
    record.prepared_age = static_cast<std::uint32_t>(age);
    limit_.count(set);
    record.cost_scale = static_cast<float>(request_.cost_scale);
    const Correction before = correction_at(set.resolution, filtered_);
    record.correction = static_cast<float>(before.factor);
    record.budget_us = static_cast<float>(planned_us(before, 0));
    const bool moved_on =
        request_.motion && !engine_.model().motions.empty() && walk_time_s() > set.to_s + 1e-6;  // where things were
    coarse_ = age > rt::oldest_prepared(options_.period_ns) || moved_on || !covers(set.region, now_.pose, set.viewport);
    if (coarse_) {
        engine_.select_last();
        record.dropped_parts = dropped_parts(engine_.effect_sales(), called_for_);
        return;
    }
    const double spent_us = static_cast<double>(clock_.now_ns() - record.due_ns) * 1e-3;
    const Correction with_filter = correction_at(set.resolution, true);
    const bool filtered = engine_.offer_filter(set, planned_us(with_filter, spent_us), with_filter);
    const Correction correction = correction_at(set.resolution, filtered);
    const double budget_us = planned_us(correction, spent_us);
    record.correction = static_cast<float>(correction.factor);
    const select::Cut& cut = engine_.select(set, budget_us, correction, options_.target_error_rad);
    record.dropped_parts = dropped_parts(engine_.effect_sales(), called_for_);
    record.floor_us = cut.floor_us;
    record.floor_binds = cut.floor_binds;
    record.switches = cut.switches;
    record.cut_hash = cut.hash;
    record.visits = set.visits;
    record.hidden = set.hidden;
    record.candidates = static_cast<std::uint32_t>(set.candidates.size());
    record.prepare_cpu_us = static_cast<float>(set.cpu_us);
    cut_ = &cut;
    requested_budget_us_ = budget_us;
    requested_correction_ = correction;
}

/// After the frame, when it is known whether it was late. Copying takes a tenth of a millisecond for a few thousand candidates;
/// of larger sets only the requested frame is kept, because the copy itself could make the next frame late.
void WalkStages::keep(const rt::FrameRecord& record) {
    constexpr std::size_t max_candidates = 16'384;
    const prepare::PreparedFrame& set = prepared_.front();
    const bool missed = options_.capture_missed && record.missed && set.candidates.size() <= max_candidates;
    if (coarse_ || cut_ == nullptr || (record.frame != options_.capture_frame && !missed)) return;
    if (kept_.kept.load(std::memory_order_acquire)) return;
    kept_.frame = record.frame;
    kept_.prepared = set;  // into vectors that were reserved: no allocation
    kept_.cut = *cut_;
    kept_.memory = engine_.selection_memory().before;
    kept_.offered = engine_.offered();
    kept_.bought_before = engine_.selection_memory().bought_before;
    kept_.budget_us = requested_budget_us_;
    kept_.correction = requested_correction_;
    kept_.target_error_rad = options_.target_error_rad;
    kept_.kept.store(true, std::memory_order_release);
}

void WalkStages::submit(rt::FrameRecord& record) {
    inject_submit(record);
    latch(record);
    SubmitLimits limits = frame_limits();
    const std::int64_t begun_ns = clock_.now_ns();
    limits.elapsed_us = static_cast<double>(begun_ns - record.due_ns) * 1e-3;
    limits.frame_ns = record.due_ns;
    if (!virtual_clock_) {
        limits.now_ns = clock_now;
        limits.now_context = &clock_;
    }
    time_left_us_ = limits.limit_us - limits.elapsed_us;
    report_ = engine_.submit(now_.pose, limits);
    if (!virtual_clock_) inject_raster(record, begun_ns);
    engine_.device().draws.plays();
    if (engine_.device().lost() && options_.lost != nullptr) options_.lost->store(true);
    if (virtual_clock_) {
        const double charged_us = report_.finished_us > 0 ? report_.finished_us : report_.predicted_us * request_.cost_scale;
        static_cast<rt::VirtualClock&>(clock_).advance(static_cast<std::int64_t>(charged_us * 1e3));
        report_.finished_us = charged_us;
        report_.submitted_us = std::min(report_.submitted_us, charged_us);
    }
    record.submitted_ns = begun_ns + static_cast<std::int64_t>(report_.submitted_us * 1e3);
    record.rastered_ns = begun_ns + static_cast<std::int64_t>(report_.finished_us * 1e3);
}

void WalkStages::shown_late(const rt::FrameRecord& record) { keep(record); }

/// What predictions of this frame's items are to be multiplied by. Where the in-frame check found them wrong, what it found
/// counts.
double WalkStages::cost_factor(const rt::FrameRecord& record, double actual_us) const {
    const double expected = record.correction;
    if (coarse_ || report_.downgraded_slices == 0 || !(report_.predicted_us > 0)) return expected;
    return std::max(expected, actual_us / report_.predicted_us);
}

/// submit() has waited for the last fence. No time of the virtual clock is a display's, so a window shows that picture at once.
void WalkStages::finish(rt::FrameRecord& record) {
    inject(FramePhase::finish, record);
    if (!virtual_clock_) return;
    engine_.device().draws.plays();
    engine_.device().present();
}

rt::Shown WalkStages::present(rt::FrameRecord& record) {
    inject(FramePhase::present, record);
    if (options_.display != nullptr) return options_.display->present(record);
    gl::Device& device = engine_.device();
    device.draws.plays();
    const rt::Shown shown = device.present();
    if (!device.lost()) return shown;
    if (options_.lost != nullptr) options_.lost->store(true);
    return {};
}

/// What a frame that drew a selected cut says of predictions.
void WalkStages::learn(double actual_us) {
    // The correction is of the machine's own figures: it must not take back an overhead that the user asked for.
    const double overhead = virtual_clock_ ? 1.0 : request_.cost_scale;
    const bool had_filter = filtered_;
    learnt_resolution_ = report_.resolution;
    filtered_ = engine_.device().switches_filter() && report_.filter == rt::TextureFilter::trilinear;
    corrections_.update(state_of(report_.resolution, filtered_), report_.predicted_us / overhead, actual_us);
    if (had_filter && !filtered_) corrections_.forget_from(steps);  // until it is bought again, the machine may be another
    if (!filtered_)  // all is in full detail then: nothing to compare, and another price may be wrong
        forms_.update(report_.full_us / overhead, report_.coarse_us / overhead, report_.other_us / overhead, actual_us);
}

void WalkStages::account(rt::FrameRecord& record) {
    limit_.ended(static_cast<double>(record.rastered_ns - record.due_ns) * 1e-3);
    record.slices = report_.slices;
    record.downgraded_slices = report_.downgraded_slices;
    record.items = report_.items;
    record.draws = report_.draws;
    record.triangles = report_.triangles;
    record.resolution = report_.resolution;
    record.samples = report_.samples;
    record.other_samples = report_.samples != request_.samples;
    record.filter = report_.filter;
    record.bought_items = report_.bought_items;
    record.refused_items = report_.refused_items;
    record.bought_us = static_cast<float>(report_.bought_us);
    record.shadow_refreshed = report_.shadow_refreshed;
    record.shadow_shown = report_.shadow_shown;
    record.pictures = report_.pictures;
    record.pictures_made = report_.pictures_made;
    record.pictures_reused = report_.pictures_reused;
    record.boxes_as_triangles = report_.boxes_as_triangles;
    record.pictures_us = static_cast<float>(report_.pictures_us);
    record.captures_us = static_cast<float>(report_.captures_us);
    record.picture_bytes = report_.picture_bytes;
    record.uncovered_items = report_.uncovered_items;
    record.accuracy = accuracy_of(report_.worst_error_rad);
    record.guaranteed_accuracy = static_cast<float>(report_.promised_rad > 0 ? 1 / report_.promised_rad : 0);
    record.reached_accuracy = accuracy_of(report_.worst_weighted_rad);
    record.guarantee = report_.guarantee;
    record.binding_node = report_.worst_node;
    record.value = static_cast<float>(report_.value);
    record.one_more_ms = static_cast<float>(report_.one_more_ms);
    record.dropped_objects = report_.dropped_objects;
    record.predicted_us = static_cast<float>(report_.predicted_us * record.correction);
    const double actual_us = report_.finished_us - static_cast<double>(record.stolen_ns) * 1e-3;
    record.actual_us = static_cast<float>(actual_us);
    record.at_rest = report_.at_rest;
    record.rest_samples = report_.rest_samples;
    if (!coarse_ && !report_.at_rest) learn(actual_us);
    if (report_.forecast_us > 0 && !report_.at_rest) overshoot_.update(actual_us - report_.forecast_us);
    if (coarse_ && record.missed && record.cause == rt::Cause::none) record.cause = rt::Cause::prepared_too_old;
    record.floor_share = report_.floor_share;
    const bool follows = now_.frame > rehearsed_;  // the cut before the first frame is of the warm-up
    record.floor_frame =
        follows && !report_.at_rest && engine_.fell_to_floor(now_.pose, time_left_us_, cost_factor(record, actual_us));
    if (report_.rest_samples > 0) record.dropped_parts = {};  // full detail has all of them
    keep(record);
    snapshots_.remember(record.frame, walk_time_s(), now_.pose, record.accuracy, record.resolution, record.filter,
                        record.triangles, engine_.drawn(), engine_.culled(), record.light,
                        rt::parts_left(record.light.on, record.dropped_parts), record.shadow_shown, engine_.shown_pictures());
    if (!record.at_rest) snapshots_.remember_boxes(record.frame, engine_.cache_boxes());
}

}  // namespace surefoot::walk
