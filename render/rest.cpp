// The picture at rest (rest.hpp): its phases, each in parts that fit a frame.
#include "render/rest.hpp"

#include <algorithm>
#include <cmath>

#include "rt/base/check.hpp"

namespace surefoot {

namespace {

constexpr double time_share = 0.8;  // of the frame's limit: what is drawn at rest is never urgent
constexpr double collect_us = 100;  // at most, for the nodes of a chunk
constexpr std::size_t collect_chunk = 32, sort_chunk = 4096;
constexpr double margin = 1.1;        // on the cost of a slice
constexpr double forget = 0.95;       // a frame, of the learned ratio
constexpr double highest_ratio = 4;   // a stolen core says nothing about costs
constexpr double early_share = 0.25;  // of the limit: a frame that begins later is no reason to refuse a picture
constexpr double min_learned_us = 500;

double halton(std::uint32_t index, std::uint32_t base) {
    double value = 0, digit = 1;
    for (; index > 0; index /= base) {
        digit /= base;
        value += digit * (index % base);
    }
    return value;
}

/// 16 buckets each time the distance doubles, from 1/16 m on.
std::uint8_t bucket_of(float distance_m) {
    const float at = 16.0F * (std::log2(std::max(distance_m, 0.0625F)) + 4.0F);
    return static_cast<std::uint8_t>(std::clamp(at, 0.0F, 255.0F));
}

}  // namespace

bool RestWatch::at_rest(const Pose& pose, std::int64_t now_ns) {
    if (after_ns_ <= 0) return false;
    const double moved = glm::length(pose.position - pose_.position);
    const dquat& a = pose.orientation;
    const dquat b = glm::dot(a, pose_.orientation) < 0 ? -pose_.orientation : pose_.orientation;
    const double turned = 2.0 * glm::length(a - b);  // for small angles
    const double zoomed = std::abs(pose.fov_y_rad - pose_.fov_y_rad);
    const bool still = known_ && moved <= still_m && turned <= still_rad && zoomed <= still_rad;
    if (!still || now_ns < since_ns_) {
        known_ = true;
        pose_ = pose;
        since_ns_ = now_ns;
        return false;
    }
    return now_ns - since_ns_ >= after_ns_;
}

dvec2 rest_offset_px(std::uint32_t sample) {
    return sample == 0 ? dvec2(0) : dvec2(halton(sample, 2) - 0.5, halton(sample, 3) - 0.5);
}

/// One frame's time, and what it has drawn.
struct RestPicture::Frame {
    const RestScene& scene;
    const SubmitLimits& limits;
    double start_us, limit_us, scale;
    double predicted_us = 0, in_flight_us = 0;
    std::uint32_t slices = 0;
    bool progress = false;

    [[nodiscard]] double measured_us() const {
        scene.device.draws.plays();
        return (limits.now_ns != nullptr ? static_cast<double>(limits.now_ns(limits.now_context)) * 1e-3
                                         : scene.device.charged_us()) -
               start_us;
    }
    /// Time for more. Without a clock, predictions count.
    [[nodiscard]] double left_us() const {
        const double spent_us =
            limits.now_ns != nullptr ? measured_us() + in_flight_us * scale : std::max(measured_us(), predicted_us * scale);
        return limit_us - limits.elapsed_us - spent_us;
    }
    [[nodiscard]] double us_of(const model::ItemCost& cost) const {
        const model::FrameCombine& combine = scene.costs.combine;
        return static_cast<double>(combine.frame_us(cost.submit_us, cost.raster_us) - combine.fixed_us);
    }
    /// Of a pass over the whole picture.
    [[nodiscard]] double pass_us() const { return static_cast<double>(scene.costs.rest_pass_us(scene.viewport)); }
    /// Of the pass that begins a sample.
    [[nodiscard]] double begin_us() const { return pass_us() + static_cast<double>(scene.costs.behind_us(scene.viewport)); }
    [[nodiscard]] bool pass_fits() const { return pass_us() * scale <= left_us(); }
    [[nodiscard]] bool begin_fits() const { return begin_us() * scale <= left_us(); }
    /// A slice or a pass was handed to the driver: at most one is unfinished beside it.
    void drawn(double us) {
        scene.device.draws.plays();
        scene.device.wait_slices(1);
        predicted_us += us;
        in_flight_us = us;
        ++slices;
        progress = true;
    }
};

void RestPicture::reserve(const model::Model& model) {
    std::size_t leaves = 0, blended = 0;
    for (const model::Node& node : model.nodes) {
        if (node.child_count > 0) continue;
        ++leaves;
        if ((model.reps[node.first_rep + node.rep_count - 1].effects & model::effect_blend) != 0) ++blended;
    }
    const auto touch = [](auto& list, std::size_t count) {  // now, so that no frame faults
        list.resize(count);
        list.clear();
    };
    touch(stack_, model.nodes.size());
    touch(leaves_, leaves);
    touch(items_, leaves);
    touch(cost_, leaves);
    touch(blended_leaves_, blended);
    touch(blended_, blended);
    touch(blended_cost_, blended);
}

void RestPicture::leave() {
    phase_ = Phase::away;
    shown_ = 0;
}

bool RestPicture::frame(const RestScene& scene, const Pose& pose, const SubmitLimits& limits, double correction,
                        SubmitReport& report) {
    scene.device.draws.plays();
    if (phase_ == Phase::refused || scene.device.rest_support() == gl::RestSupport::none) return false;
    if (phase_ == Phase::away) {
        phase_ = Phase::collect;
        pose_ = pose;
        frustum_ = model::make_frustum(pose, scene.viewport, model::far_corners_m(scene.model.nodes[0].box));
        scale_ = model::make_view_scale(pose, scene.viewport);
        pixel_rad_ = model::pixel_angle(pose, scene.viewport);
        stack_.assign(1, 0);
        for (auto* list : {&leaves_, &blended_leaves_}) list->clear();
        for (auto* list : {&items_, &blended_}) list->clear();
        place_.fill(0);
        triangles_ = 0;
        sample_ = shown_ = 0;
        stalled_ = 0;
    }
    Frame now{scene, limits, 0, limits.limit_us * time_share,
              margin * std::clamp(std::max(correction, learned_), 0.25, highest_ratio)};
    now.start_us = now.measured_us();
    while (advance(now)) {
    }
    scene.device.finish_rest_frame();
    report.submitted_us = report.finished_us = now.measured_us();
    learned_ *= forget;
    if (now.predicted_us > min_learned_us)
        learned_ = std::max(learned_, std::min(report.finished_us / now.predicted_us, highest_ratio));
    const bool early = limits.elapsed_us < early_share * limits.limit_us;
    if (now.progress || phase_ == Phase::done) {
        stalled_ = 0;
    } else if (shown_ == 0 && early && ++stalled_ >= max_stalled) {
        phase_ = Phase::refused;  // from the next frame on; this one is presented. What is whole stays shown
    }
    report.at_rest = true;
    report.rest_samples = shown_;
    report.slices = now.slices;
    report.downgraded_slices = report.draws = 0;
    report.predicted_us = now.predicted_us;
    if (shown_ > 0) {
        describe(report);
        report.filter = scene.filter;
    }
    return true;
}

/// The shown picture: full detail.
void RestPicture::describe(SubmitReport& report) const {
    report.items = static_cast<std::uint32_t>(items_.size());
    report.culled = 0;
    report.triangles = triangles_;
    report.resolution = 1;
    report.worst_error_rad = report.worst_weighted_rad = 0;
    report.worst_node = model::none;
    if (report.guarantee != rt::Guarantee::none) report.guarantee = rt::Guarantee::kept;
    report.value = 1;
    report.one_more_ms = 0;
    report.dropped_objects = 0;
    report.pictures = report.pictures_reused = report.boxes_as_triangles = 0;
    report.floor_share = 0;
}

/// Does one part of the work. False: there is no time for the next one in this frame, or nothing is left to do.
bool RestPicture::advance(Frame& frame) {
    frame.scene.device.draws.plays();
    switch (phase_) {
        case Phase::collect:
            return collect(frame);
        case Phase::sort:
            return sort(frame);
        case Phase::begin:
            if (!frame.begin_fits()) return false;
            frame.scene.device.set_filter(frame.scene.filter);
            frame.scene.device.begin_rest(pose_, rest_offset_px(sample_));
            frame.drawn(frame.begin_us());
            next_ = 0;
            phase_ = Phase::opaque;
            return true;
        case Phase::opaque:
            return draw(frame, gl::Parts::opaque);
        case Phase::blended:
            return draw(frame, gl::Parts::blended);
        case Phase::add:
            if (!frame.pass_fits()) return false;
            frame.scene.device.add_sample(sample_ == 0);
            frame.drawn(frame.pass_us());
            phase_ = sample_ == 0 ? Phase::begin : Phase::show;
            if (sample_ == 0) sample_ = 1;
            return true;
        case Phase::show:
            return show(frame);
        case Phase::away:
        case Phase::done:
        case Phase::refused:
            return false;
    }
    return false;
}

/// The first sample is shown before it is added, so that full detail does not wait; the others make a new mean.
bool RestPicture::show(Frame& frame) {
    gl::Device& device = frame.scene.device;
    device.draws.plays();
    if (!frame.pass_fits()) return false;
    shown_ = sample_ + 1;
    device.show_rest(shown_);
    frame.drawn(frame.pass_us());
    if (sample_ == 0) {
        phase_ = device.rest_support() == gl::RestSupport::samples ? Phase::add : Phase::done;
    } else {
        phase_ = ++sample_ < max_rest_samples ? Phase::begin : Phase::done;
    }
    return true;
}

/// A pixel is added around each box: a moved sample sees a little more.
void RestPicture::collect_node(const Frame& frame, model::Index index) {
    const model::Model& model = frame.scene.model;
    const model::Node& node = model.nodes[index];
    const dvec3 centre = node.box.centre();
    const double distance = glm::length(centre - pose_.position);
    const dvec3 grown(1.5 * pixel_rad_ * (distance + 0.5 * node.box.diagonal()));
    if (node.box.empty() || !model::visible(frustum_, {node.box.min - grown, node.box.max + grown})) return;
    if (node.child_count > 0) {
        for (std::uint32_t c = node.child_count; c > 0; --c) {
            if (!CHECK_RARE(stack_.size() < stack_.capacity(), "A walk down the tree holds each node at most once")) return;
            stack_.push_back(node.first_child + c - 1);
        }
        return;
    }
    const model::Index rep = node.first_rep + node.rep_count - 1;
    if (!CHECK_RARE(leaves_.size() < leaves_.capacity(), "There are no more leaves than were counted")) return;
    const auto near = static_cast<float>(distance);
    float pixels = 0;
    model::ItemCost cost = frame.scene.item_costs.of(rep, node.box, pose_.position, scale_, pixels, frame.scene.hidden);
    if (frame.scene.filter_costs.any()) cost = frame.scene.filter_costs.with(rep, cost);
    leaves_.push_back({{index, rep}, cost, near, bucket_of(near)});
    ++place_[leaves_.back().bucket];
    triangles_ += model.reps[rep].triangles;
    if ((model.reps[rep].effects & model::effect_blend) != 0) blended_leaves_.push_back(leaves_.back());
}

bool RestPicture::collect(Frame& frame) {
    if (collect_us > frame.left_us()) return false;
    frame.progress = true;
    for (std::size_t i = 0; i < collect_chunk && !stack_.empty(); ++i) {
        const model::Index node = stack_.back();
        stack_.pop_back();
        collect_node(frame, node);
    }
    if (!stack_.empty()) return true;
    std::uint32_t first = 0;
    for (std::uint32_t& place : place_) {
        const std::uint32_t count = place;
        place = first;
        first += count;
    }
    items_.resize(leaves_.size());
    cost_.resize(leaves_.size());
    next_ = 0;
    phase_ = Phase::sort;
    return true;
}

/// Near leaves first: hidden pixels cost a fraction of shown ones.
bool RestPicture::sort(Frame& frame) {
    if (collect_us > frame.left_us()) return false;
    frame.progress = true;
    const std::size_t end = std::min(next_ + sort_chunk, leaves_.size());
    for (; next_ < end; ++next_) {
        const std::uint32_t at = place_[leaves_[next_].bucket]++;
        items_[at] = leaves_[next_].item;
        cost_[at] = leaves_[next_].cost;
    }
    if (next_ < leaves_.size()) return true;
    sort_blended();
    phase_ = Phase::begin;
    return true;
}

/// In the device's order, so that the picture is that of a frame of its own.
void RestPicture::sort_blended() {
    std::sort(blended_leaves_.begin(), blended_leaves_.end(), [](const Leaf& a, const Leaf& b) {
        return a.distance_m != b.distance_m ? a.distance_m > b.distance_m : a.item.node < b.item.node;
    });
    blended_.resize(blended_leaves_.size());
    blended_cost_.resize(blended_leaves_.size());
    for (std::size_t i = 0; i < blended_leaves_.size(); ++i) {
        blended_[i] = blended_leaves_[i].item;
        blended_cost_[i] = blended_leaves_[i].cost;
    }
}

/// A slice of the items that are left: as long as the setting says, and never longer than the time that is left.
bool RestPicture::draw(Frame& frame, gl::Parts parts) {
    const bool opaque = parts == gl::Parts::opaque;
    const std::span<const gl::DrawItem> items(opaque ? items_ : blended_);
    const std::span<const model::ItemCost> costs(opaque ? cost_ : blended_cost_);
    if (next_ == items.size()) {
        next_ = 0;
        phase_ = opaque ? Phase::blended : sample_ == 0 ? Phase::show : Phase::add;
        return true;
    }
    frame.scene.device.draws.plays();
    const double left_us = frame.left_us();
    model::ItemCost sum{frame.scene.costs.slice_us, 0};
    double us = 0;
    std::size_t count = 0;
    while (next_ + count < items.size()) {
        model::ItemCost with = sum;
        with += costs[next_ + count];
        const double with_us = frame.us_of(with);
        if (with_us * frame.scale > left_us || (count > 0 && with_us > frame.scene.slice_us)) break;
        sum = with;
        us = with_us;
        ++count;
    }
    if (count == 0) return false;
    frame.scene.device.draw_rest(items.subspan(next_, count), parts);
    next_ += count;
    frame.drawn(us);
    return true;
}

}  // namespace surefoot
