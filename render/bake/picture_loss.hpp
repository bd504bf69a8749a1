// Measures how far the picture of each form is off its node's full detail, from some directions.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "render/bake/picture_tree.hpp"
#include "render/model/picture_loss.hpp"

namespace surefoot::bake {

/// Azimuth and elevation of the eye, rad: round about, mostly as a walker sees things, and some from above and below.
constexpr std::array<std::array<double, 2>, 6> loss_directions = {
    {{0.3, 0.15}, {1.35, 0.6}, {2.4, -0.15}, {3.44, 0.15}, {4.49, 0.6}, {5.53, -0.15}}};

/// Sums over pictures of one form against full detail. Whole numbers: the order does not matter.
struct PictureDifference {
    /// Pictures of one view. levels: 1 where textures do not differ by level.
    void add(const FormPicture& full, const FormPicture& form, std::size_t levels = picture_levels);
    /// A sample of both. Call end() after the last.
    void add(const FormSample& full, const FormSample& form, std::size_t levels);
    /// Where textures do not differ by level, all levels are the first.
    void end(std::size_t levels);
    /// Zero where neither picture shows anything.
    [[nodiscard]] model::PictureLoss loss(const model::ColourSpread& of_model) const;

    /// Samples that the form covers.
    [[nodiscard]] std::uint64_t form() const { return 2 * either - one - full_detail; }
    /// To those that full detail covers. 1 where that shows nothing.
    [[nodiscard]] double covered() const {
        return full_detail > 0 ? static_cast<double>(form()) / static_cast<double>(full_detail) : 1;
    }

    using ByLevel = std::array<std::uint64_t, picture_levels>;
    std::uint64_t full_detail = 0, either = 0, one = 0;  ///< samples that it covers, that either covers, that only one covers
    ByLevel both{};                                      ///< squared differences of bytes, where both cover
    ByLevel squares{};                                   ///< squares of bytes, where only one covers
    std::array<ByLevel, 3> sums{};                       ///< of bytes there, by channel
};

/// What measure_losses() found.
struct MeasuredLosses {
    std::vector<model::PictureLoss> forms;   ///< one a form of the model; empty: stopped
    std::vector<float> covered;              ///< one a form: samples that it covers, to those of full detail
    std::vector<model::LossOfGroup> groups;  ///< as Model::group_losses
    model::ColourSpread colours;
    /// To the model that was measured, which holds no `covered`.
    void move_to(model::Model& model);
};

/// Objects of one mesh share what the first of them shows. The same bits, whatever the threads. step(): false: stop.
MeasuredLosses measure_losses(const model::Model& model, const ForAll& for_all, const std::function<bool()>& step);
/// How many steps there are.
std::size_t loss_steps(const model::Model& model);

}  // namespace surefoot::bake
