// Notices a fall to the floor: sums of pixels, and a look at what each node showed before.
#include "render/floor_watch.hpp"

namespace surefoot {

void FloorWatch::reserve(std::size_t nodes, std::size_t max_drawn) {
    last_form_.assign(nodes, model::none);
    floor_.reserve(max_drawn);
}

void FloorWatch::begin() {
    pixels_ = floor_pixels_ = 0;
    floor_.clear();
}

void FloorWatch::add(const gl::DrawItem& item, float pixels, bool floor) {
    pixels_ += pixels;
    if (!floor) return;
    floor_pixels_ += pixels;
    if (floor_.size() < floor_.capacity()) floor_.push_back({item, pixels});
}

float FloorWatch::floor_share() const { return pixels_ > 0 ? static_cast<float>(floor_pixels_ / pixels_) : 0.0F; }

float FloorWatch::fallen_share(std::span<const select::Shown> last) {
    if (!(pixels_ > 0)) return 0;
    for (const select::Shown& shown : last) last_form_[shown.node] = shown.form;
    double fallen = 0;
    for (const FloorItem& f : floor_) {
        const model::Index before = last_form_[f.item.node];  // forms go from coarse to fine; `opened` is finer than all
        if (before != model::none && before > f.item.rep) fallen += f.pixels;
    }
    for (const select::Shown& shown : last) last_form_[shown.node] = model::none;
    return static_cast<float>(fallen / pixels_);
}

}  // namespace surefoot
