// The boxes of all nodes: six pictures of full detail each, captured from the emitted model and put into it.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "render/bake/emit.hpp"
#include "render/bake/picture_tree.hpp"
#include "render/model/cost.hpp"

namespace surefoot::bake {

/// Which boxes are captured, and how.
struct BoxRequest {
    std::vector<bool> wanted;   ///< by node
    bool textured = false;      ///< pictures; else one colour a face, without light
    std::uint32_t pixels = 28;  ///< of a face's side: face_pixels()
};

/// A box a node; those that are not wanted have no faces. Errors are not bounded yet. Empty: step() said to stop.
std::vector<BoxForm> capture_boxes(const model::Model& model, const BoxRequest& request, const ForAll& for_all,
                                   const std::function<bool()>& step);
/// How many steps there are.
std::size_t box_steps(const model::Model& model, const BoxRequest& request);

/// Nodes take the boxes that have faces, as their coarsest forms. proxy: the material of boxes without pictures.
class PlacedBoxes {
public:
    PlacedBoxes(std::vector<BoxForm> boxes, model::Index proxy, model::Model& model);
    /// Takes out the boxes that are best at no size on the screen: others look about as good for no more time. Call it once the
    /// losses are measured. Those that cover too little or too much of full detail go too, if a coarse mesh is left.
    /// covered: MeasuredLosses::covered; empty: not known. Returns how many are left. Of these, what shows no hole loses its
    /// mask.
    std::size_t drop_idle(const model::CostModel& costs, const std::vector<float>& covered = {});

private:
    void insert();
    [[nodiscard]] model::Index material_of(const model::Representation& coarsest);
    [[nodiscard]] bool is_best_somewhere(const model::Node& node, const model::CostModel& costs) const;

    model::Model& model_;
    std::vector<BoxForm> boxes_;
    model::Index proxy_, in_rooms_ = model::none;
    std::vector<model::Representation> meshes_;                                            ///< the forms without boxes
    std::vector<std::pair<model::Index, std::uint32_t>> ranges_;                           ///< by node: its forms in meshes_
    std::size_t vertices_, indices_, parts_, placements_, materials_, textures_, texels_;  ///< of the model without boxes
};

}  // namespace surefoot::bake
