// A frame of a walk's cache: what is covered, what pays, what is drawn.
#include "render/cache/walk_cache.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace surefoot::cache {

namespace {

constexpr float min_saving_us = 5;           // less is not worth a picture
constexpr double same_change_frames = 2;     // what is forgotten again so soon was forgotten for one reason
constexpr double sooner_share = 0.25;        // of the usual time between two of them: nothing is expected sooner
constexpr double min_life_frames = 4;        // for less, nothing is offered
constexpr std::uint64_t tight_frames = 16;   // after room was missing, only what finds room is offered
constexpr double rounded_down = 1 - 1e-6;    // errors are reported in float
constexpr float new_share = 0.5F;            // of a cost that was measured anew
constexpr double doubt = 0.15;               // of what a picture saves, where pictures take twice as long as the table says
constexpr double new_margin = 0.3;           // of what a new one takes, there: so much more must it save
constexpr std::uint32_t idle_prospects = 4;  // times as many, in a plan of an idle cache
constexpr float pays_band = 0.1F;  // of its price: so much less must a picture save before it is left out, and more to come back
constexpr float share_alone = 0.5F;             // of what lies across several boxes, for each by itself
constexpr float dearer = 1.1F;                  // than when a picture was last worked out: then it is worked out again at once
constexpr std::uint64_t view_first_frames = 8;  // after a picture was offered in view
constexpr std::size_t max_tries = 64;           // candidates that are worked out in a frame

/// Where the table errs about pictures, it is not trusted to the last.
float sure_share(double picture_factor) { return static_cast<float>(1 - doubt * std::clamp(picture_factor - 1, 0.0, 1.0)); }
/// Nor is a new picture made that hardly saves more than it takes.
float needed_share(double picture_factor) {
    return static_cast<float>(1 + new_margin * std::clamp(picture_factor - 1, 0.0, 1.0));
}

}  // namespace

WalkCache::WalkCache(SceneBoxes boxes, const WalkCacheOptions& options, std::vector<Box> blended)
    : boxes_(std::move(boxes)), options_(options), slots_(options.layers), blended_(std::move(blended)) {
    if (options.layers == 0) return;
    cones_.resize(blended_.size());
    const std::size_t count = boxes_.size();
    held_.resize(count);
    last_covered_.resize(count, 0);
    cost_us_.resize(count, 0);
    saving_us_.resize(count, 0);
    across_us_.resize(count, 0);
    shown_value_.resize(count);
    value_.resize(count);
    facts_.resize(count);
    own_us_.resize(count, 0);
    best_us_.resize(count, 0);
    candidates_.reserve(count);
    offers_.reserve(options.max_offers);
    pending_.reserve(count);
    victims_.reserve(count);
    trial_ = slots_;
    relies_.resize(count, false);
    serves_.resize(count, false);
    pays_.resize(count, true);
    in_view_.resize(count, false);
    planes_across_.resize(count, 0);
    refused_.reserve(max_refused);
    out_until_.resize(count, 0);
    cell_worth_us_.resize(std::size_t{options.layers} * cells_a_side * cells_a_side);
    draws_.boxes.reserve(count);
    draws_.unserved.reserve(count);
    if (!options.surround) return;
    known_from_.resize(count, dvec3(std::numeric_limits<double>::quiet_NaN()));
    seen_now_.resize(count, false);
}

/// Room comes by itself.
void WalkCache::forget_refused() {
    refused_.clear();
    std::fill(out_until_.begin(), out_until_.end(), 0U);
    no_place_until_ = {};
    tight_until_ = 0;
}

void WalkCache::forget() {
    for (Index i = 0; i < held_.size(); ++i) {
        HeldPicture& held = held_[i];
        if (held.any() && held.until == 0 && !is_pending(i)) held.until = frame_ + relied_frames;
    }
    for (Pending& pending : pending_) pending.before = {};
    forget_refused();
    const auto since = static_cast<double>(frame_ - forgot_frame_);
    if (since <= same_change_frames) return;
    forget_frames_ = forget_frames_ > 0 ? std::min(since, 0.5 * (forget_frames_ + since)) : since;
    forgot_frame_ = frame_;
}

/// By the time between the last changes. Nobody knows when the next one comes, so it is never expected at once: a light that
/// seldom changes stops no pictures. At least 1.
double WalkCache::frames_to_forget() const {
    const auto since = static_cast<double>(frame_ - forgot_frame_);
    if (!(since < 2 * forget_frames_)) return std::numeric_limits<double>::infinity();
    return std::max({1.0, forget_frames_ - since, sooner_share * forget_frames_});
}

/// Error and texels that a picture of the box may have.
double WalkCache::allowed_rad(Index box, const Box& seen, const ViewPixels& pixels) const {
    const double pixel_rad = pixels.smallest_rad(seen);
    const auto importance = static_cast<double>(boxes_.importance(box));
    if (!(promise_rad_ > 0) || !(importance > 0)) return pixel_rad;
    return std::min(pixel_rad, rounded_down * promise_rad_ / importance);
}

bool WalkCache::is_pending(Index box) const {
    return std::any_of(pending_.begin(), pending_.end(), [&](const Pending& pending) { return pending.box == box; });
}

/// A box whose slot still holds its picture of before keeps that one.
void WalkCache::drop_pending() {
    while (!pending_.empty()) {
        const Pending last = pending_.back();
        if (last.before.any()) {
            held_[last.box] = last.before;
            pending_.pop_back();
        } else {
            drop(last.box);
        }
    }
}

void WalkCache::captured(Index box) {
    pending_.erase(std::remove_if(pending_.begin(), pending_.end(), [&](const Pending& pending) { return pending.box == box; }),
                   pending_.end());
}

void WalkCache::drop(Index box) {
    slots_.give(held_[box].slot);
    held_[box] = {};
    captured(box);
}

void WalkCache::clear() {
    for (Index i = 0; i < held_.size(); ++i)
        if (held_[i].any()) drop(i);
    pending_.clear();
    forget_refused();
}

const model::CoverBits& WalkCache::cover(const ViewPixels& pixels, double radius_m) {
    ++frame_;
    make_room_by_worth();
    covered_.reset();
    bool any_valid = false, looked = false;
    for (Index i = 0; i < held_.size(); ++i) {
        if (held_[i].until != 0 && frame_ > held_[i].until) drop(i);
        if (!held_[i].any() || held_[i].until != 0 || !pays_[i] || is_pending(i)) continue;
        if (!valid_around(held_[i].picture, pixels.eye, radius_m, allowed_rad(i, held_[i].box, pixels))) continue;
        if (!std::exchange(looked, true)) look_from(pixels.eye);
        if (before_blended(held_[i].box)) continue;
        covered_.set(i);
        last_covered_[i] = frame_;
        any_valid = true;
    }
    if (!any_valid) return covered_;  // nothing lies wholly in boxes without contents
    covered_ |= boxes_.empty();
    boxes_.complete(covered_);
    return covered_;
}

void WalkCache::begin_costs(const model::CoverBits& covered) {
    set_ = covered;
    std::fill(cost_us_.begin(), cost_us_.end(), 0.0F);
    std::fill(shown_value_.begin(), shown_value_.end(), Value{});
}

/// What meets one box that is not covered goes with a picture of it. What lies across several goes with all of them: half of it
/// counts for each by itself, so that a first one is made, and half for the box that holds them all.
void WalkCache::add_cost(model::Index node, float us, float value, float full_value) {
    const std::span<const Index> met = boxes_.boxes_of(node);
    const auto open = static_cast<float>(std::count_if(met.begin(), met.end(), [&](Index box) { return !set_[box]; }));
    const float share = open > 1 ? share_alone : 1.0F;
    Index all = none;
    for (const Index box : met) {
        if (set_[box]) continue;
        cost_us_[box] += share * us / open;
        shown_value_[box].full += full_value / open;
        shown_value_[box].missing += std::max(0.0F, full_value - value) / open;
        all = all == none ? box : common_box(all, box);
    }
    if (open > 1) cost_us_[all] += (1 - share) * us;
}

/// The smallest box that holds both.
Index WalkCache::common_box(Index a, Index b) const {
    const std::vector<CacheBox>& boxes = boxes_.tree().boxes;
    while (a != b) {
        if (boxes[a].level < boxes[b].level) std::swap(a, b);
        a = boxes[a].parent;
    }
    return a;
}

void WalkCache::end_costs() {
    for (Index i = boxes_.size(); i-- > 0;) {
        const CacheBox& box = boxes_.tree().boxes[i];
        float& own_us = across_us_[i];
        const bool is_new = !set_[i] && measured(i);
        if (is_new) own_us += (own_us > 0.0F ? new_share : 1.0F) * (cost_us_[i] - own_us);
        saving_us_[i] = own_us;
        if (box.child_count == 0 && is_new) value_[i] = shown_value_[i];
        if (box.child_count > 0) value_[i] = {};
        for (Index child = box.first_child; child < box.first_child + box.child_count; ++child) {
            saving_us_[i] += saving_us_[child];
            value_[i].full += value_[child].full;
            value_[i].missing += value_[child].missing;
        }
    }
    planned_ = false;
}

float WalkCache::draw_us(Index box, const dvec3& eye, double pixel_rad, double view_px) const {
    const double pixels = std::min(view_px, faces_sr(boxes_.filled(box), eye) / (pixel_rad * pixel_rad));
    return options_.picture_us + 1e-3F * options_.picture_ns_per_pixel * static_cast<float>(pixels);
}

float WalkCache::draw_us(Index box, const PlanView& view) const {
    return static_cast<float>(view.picture_factor) * draw_us(box, view.course.eye, view.pixel_rad, view.view_px);
}

/// Of a picture of the box in a frame, without its own time.
float WalkCache::full_worth_us(Index box, const PlanView& view) const {
    if (view.ample) return 0;
    const Value& shown = value_[box];
    return saving_us_[box] + static_cast<float>(view.us_per_value) * (shown.missing - loss() * shown.full);
}

float WalkCache::us_of(const model::FrameCombine& combine, const model::ItemCost& cost) {
    return combine.frame_us(cost.submit_us, cost.raster_us) - combine.fixed_us;
}

/// By the pixel of the box as it will be captured. Else a picture could be too coarse as soon as it is there.
double WalkCache::allowed_for_new_rad(Index box, const PlanView& view) const {
    const Box& filled = boxes_.filled(box);
    const double rad = allowed_rad(box, filled, view.pixels);
    const double grown_m = grown_for(filled, view.course.eye, rad);
    if (!std::isfinite(grown_m)) return rad;
    return std::min(rad, allowed_rad(box, {filled.min - dvec3(grown_m), filled.max + dvec3(grown_m)}, view.pixels));
}

/// A new picture of the box, where it pays. False: it does not.
bool WalkCache::work_out(Index box, const PlanView& view, CacheOffer& offer) const {
    const float price_us = draw_us(box, view), worth_us = sure_share(view.picture_factor) * full_worth_us(box, view);
    const float saves_us = worth_us - price_us;
    if (!(saves_us > min_saving_us && worth_us > needed_share(view.picture_factor) * price_us)) return false;
    const auto prospect = prospect_of(boxes_.filled(box), view.course, allowed_for_new_rad(box, view));
    if (!prospect || before_blended(prospect->box)) return false;
    offer.box = box;
    offer.prospect = *prospect;
    const double texels = prospect->picture.texels, per_m = texels / prospect->picture.side_m;
    offer.price_us = us_of(view.combine, boxes_.capture_cost(box, per_m)) + options_.capture_us +
                     1e-3F * options_.capture_ns_per_texel * static_cast<float>(texels * texels);
    if (offer.price_us > static_cast<float>(view.max_price_us)) return false;
    offer.gain_us = saves_us * static_cast<float>(prospect->life_frames);
    return offer.gain_us >= static_cast<float>(options_.pays) * offer.price_us;
}

/// While the picture of before lives on, a new one brings nothing.
bool WalkCache::pays_beside_held(CacheOffer& offer, const PlanView& view) const {
    const HeldPicture& held = held_[offer.box];
    if (!held.any() || held.until != 0) return true;
    const double left = life_of(held.picture, view.course, allowed_rad(offer.box, held.box, view.pixels));
    if (!(left > 0)) return true;
    offer.gain_us *= static_cast<float>(std::max(0.0, 1 - left / std::max(1.0, offer.prospect.life_frames)));
    return offer.gain_us >= static_cast<float>(options_.pays) * offer.price_us;
}

/// A few boxes a frame, in turns; before them those in view that cost more than they did. With a surround, most of them in view:
/// they are found first after a jump.
void WalkCache::refresh_facts(const PlanView& view) {
    const bool seldom = quiet_plans_ >= options_.quiet_plans && !view.refills;
    const std::uint32_t all = (seldom ? idle_prospects : 1) * options_.prospects, quarter = all / 4;
    std::uint32_t left = quarter;
    for (Index i = 0; i < boxes_.size() && left > 0; ++i)
        if (in_view_[i] && full_worth_us(i, view) > dearer * facts_[i].worth_us) left -= work_out_fact(i, view) ? 1 : 0;
    left += all - (options_.surround ? 2 : 1) * quarter;
    work_out_facts(view, next_fact_, left, true);
    left += quarter;
    if (options_.surround) work_out_facts(view, next_beside_, left, false);
}

void WalkCache::work_out_facts(const PlanView& view, Index& next, std::uint32_t& left, bool in_view) {
    for (Index tested = 0; tested < boxes_.size() && left > 0; ++tested) {
        const Index i = next;
        next = i + 1 < boxes_.size() ? i + 1 : 0;
        if (in_view_[i] != in_view) continue;
        estimate(i, view);
        if (work_out_fact(i, view)) --left;
    }
}

/// False: that took no time.
bool WalkCache::work_out_fact(Index i, const PlanView& view) {
    facts_[i] = {0, full_worth_us(i, view)};
    if (!boxes_.may_have_picture(i) || !(facts_[i].worth_us > min_saving_us)) return false;
    CacheOffer offer;
    if (work_out(i, view, offer))
        facts_[i].net_us = (offer.gain_us - offer.price_us) / static_cast<float>(std::max(1.0, offer.prospect.life_frames));
    return true;
}

/// Whether its picture serves now and for a while.
bool WalkCache::serves_on(Index box, const PlanView& view) const {
    const HeldPicture& held = held_[box];
    if (!held.any() || held.until != 0 || before_blended(held.box)) return false;
    const EyeCourse& course = view.course;
    const double max_rad = allowed_rad(box, held.box, view.pixels);
    return valid_around(held.picture, course.eye, course.radius_m, max_rad) &&
           valid_around(held.picture, course.eye + course.step_m * options_.renewed_frames, course.radius_m, max_rad);
}

/// Of a picture that serves for a while: all that it saves, since it is paid for. Else what a new one would bring.
float WalkCache::own_net_us(Index box, const PlanView& view) {
    serves_[box] = false;
    if (frame_ < out_until_[box]) return 0;
    if (!(facts_[box].net_us > 0.0F) && !held_[box].any()) return 0;
    if (!options_.surround && !in_view_[box]) return 0;
    const float price_us = draw_us(box, view), worth_us = full_worth_us(box, view), net_us = worth_us - price_us;
    pays_[box] = sure_share(view.picture_factor) * worth_us > (pays_[box] ? 1 - pays_band : 1 + pays_band) * price_us;
    const bool serves = serves_on(box, view);
    serves_[box] = serves && pays_[box];
    if (!serves) return facts_[box].net_us;
    return pays_[box] ? std::max(facts_[box].net_us, net_us) : 0.0F;
}

/// A picture that serves is drawn, whatever its children could have.
void WalkCache::choose(Index i) {
    const CacheBox& box = boxes_.tree().boxes[i];
    if (!(best_us_[i] > 0.0F) || serves_[i]) return;
    if (own_us_[i] < best_us_[i]) {
        for (Index child = box.first_child; child < box.first_child + box.child_count; ++child) choose(child);
        return;
    }
    candidates_.push_back({i, own_us_[i], static_cast<bool>(in_view_[i])});
}

/// The best come first. While pictures are made in view, the rest has a share alone.
void WalkCache::offer_candidates(const PlanView& view) {
    std::size_t beside = frame_ < view_first_until_ ? options_.max_offers / 4 : options_.max_offers;
    for (const Candidate& candidate : std::span(candidates_).first(std::min(candidates_.size(), max_tries))) {
        if (offers_.size() == options_.max_offers) break;
        if (!candidate.in_view && beside == 0) continue;
        CacheOffer offer;
        if (!work_out(candidate.box, view, offer) || !pays_beside_held(offer, view)) continue;
        if (takes_place_of_waiting(candidate, offer.prospect.picture.texels)) continue;
        if (frame_ < tight_until_ && !find_room(candidate.box, offer.prospect.picture.texels)) continue;
        if (candidate.in_view) {
            view_first_until_ = frame_ + view_first_frames;
        } else {
            offer.gain_us *= share_out_of_view;
            --beside;
        }
        offers_.push_back(offer);
    }
}

std::span<const CacheOffer> WalkCache::plan(const PlanView& of) {
    offers_.clear();
    candidates_.clear();
    no_room_for_ = 0;
    if (!any() || of.frustum == nullptr) return offers_;
    is_idle_ = !of.refills && quiet_plans_ >= options_.quiet_plans && ++idle_calls_ < options_.idle_every;
    if (is_idle_) return offers_;
    idle_calls_ = 0;
    PlanView view = of;
    view.course.max_frames = std::min(view.course.max_frames, frames_to_forget());
    if (view.course.max_frames < min_life_frames) return offers_;
    look_from(view.course.eye);
    seen_ = *view.frustum;
    seen_from_ = view.course.eye;
    planned_ = true;
    find_in_view();
    refresh_facts(view);
    for (Index i = boxes_.size(); i-- > 0;) {
        const CacheBox& box = boxes_.tree().boxes[i];
        own_us_[i] = own_net_us(i, view);
        float below = 0;
        for (Index child = box.first_child; child < box.first_child + box.child_count; ++child) below += best_us_[child];
        best_us_[i] = serves_[i] ? own_us_[i] : std::max(own_us_[i], below);
    }
    quiet_plans_ = best_us_[0] > 0.0F ? 0 : std::min(quiet_plans_ + 1, options_.quiet_plans);
    choose(0);
    std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
        if (a.in_view != b.in_view) return a.in_view;
        return a.net_us != b.net_us ? a.net_us > b.net_us : a.box < b.box;
    });
    offer_candidates(view);
    return offers_;
}

/// The box's own slot goes first, then the longest unused of those that no set relies on. False: there is no room; no
/// picture goes. It may be noted as refused.
bool WalkCache::find_room(Index box, std::uint32_t texels) {
    victims_.clear();
    if (held_[box].slot.texels == texels) return true;
    if (no_room_for_ != 0 && texels >= no_room_for_ && !held_[box].any()) {
        refuse(box, texels);
        return false;
    }
    trial_ = slots_;  // of the same size: nothing allocates
    trial_.give(held_[box].slot);
    if (trial_.take(texels)) return true;
    for (Index i = 0; i < held_.size(); ++i)
        if (i != box && held_[i].any() && last_covered_[i] + options_.kept_frames < frame_) victims_.push_back(i);
    std::sort(victims_.begin(), victims_.end(), [&](Index a, Index b) {
        return last_covered_[a] != last_covered_[b] ? last_covered_[a] < last_covered_[b] : a < b;
    });
    for (std::size_t i = 0; i < victims_.size(); ++i) {
        trial_.give(held_[victims_[i]].slot);
        if (!trial_.take(texels)) continue;
        victims_.resize(i + 1);
        return true;
    }
    no_room_for_ = texels;
    tight_until_ = frame_ + tight_frames;
    refuse(box, texels);
    return false;
}

bool WalkCache::take(const CacheOffer& offer) {
    const std::uint32_t texels = offer.prospect.picture.texels;
    if (!any() || pending_.size() == pending_.capacity() || !find_room(offer.box, texels)) return false;
    HeldPicture before = held_[offer.box];
    if (before.slot.texels != texels) {
        drop(offer.box);
        for (const Index victim : victims_) drop(victim);
        before = {};
    }
    const Slot slot = before.any() ? before.slot : slots_.take(texels).value_or(Slot{});
    held_[offer.box] = {offer.prospect.picture, offer.prospect.box, offer.prospect.grown_m, slot};
    pays_[offer.box] = true;
    last_covered_[offer.box] = frame_;  // so that it is not dropped before a set may use it
    pending_.push_back({offer.box, before.until == 0 ? before : HeldPicture{}});
    return true;
}

const CacheDraws& WalkCache::draws(const model::CoverBits& set, const ViewPixels& pixels, const model::Frustum& frustum) {
    draws_.boxes.clear();
    draws_.unserved.clear();
    draws_.value = draws_.saves_us = 0;
    if (!any() || set.none()) return draws_;
    look_from(pixels.eye);
    for (Index i = boxes_.size(); i-- > 0;) {
        const CacheBox& box = boxes_.tree().boxes[i];
        bool needed = box.child_count == 0 && set[i] && boxes_.has_contents(i);
        for (Index child = box.first_child; !needed && child < box.first_child + box.child_count; ++child)
            needed = relies_[child];
        relies_[i] = needed;
    }
    draw_below(0, pixels, frustum);
    return draws_;
}

void WalkCache::draw_below(Index i, const ViewPixels& pixels, const model::Frustum& frustum) {
    const CacheBox& box = boxes_.tree().boxes[i];
    if (!relies_[i] || !model::visible(frustum, boxes_.filled(i))) return;
    const HeldPicture& held = held_[i];
    const bool valid =
        held.any() && valid_around(held.picture, pixels.eye, 0, allowed_rad(i, held.box, pixels)) && !before_blended(held.box);
    if (box.child_count == 0 && !valid) draws_.unserved.push_back(i);
    const std::size_t shown = draws_.boxes.size(), unserved = draws_.unserved.size();
    const double value = draws_.value, saves_us = draws_.saves_us;
    if (box.child_count > 0 && (!valid || !pays_[i]))
        back_to_front(boxes_.tree(), box.first_child, box.child_count, pixels.eye,
                      [&](Index child) { draw_below(child, pixels, frustum); });
    if (draws_.boxes.size() > shown) draws_.saves_us += static_cast<double>(across_us_[i]);  // of what lies across its children
    // One that does not pay is drawn for a set that was told of it, where its children have none.
    if (!valid || (box.child_count > 0 && !pays_[i] && draws_.unserved.size() == unserved)) return;
    draws_.boxes.resize(shown);
    draws_.unserved.resize(unserved);
    draws_.boxes.push_back(i);
    draws_.value = value + static_cast<double>((1 - loss()) * value_[i].full);
    draws_.saves_us = saves_us + static_cast<double>(saving_us_[i]);
}

}  // namespace surefoot::cache
