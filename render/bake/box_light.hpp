// The light of boxes with pictures, at the corners of their faces: the mean of what a face shows near there.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "render/bake/baked_light.hpp"
#include "render/bake/emit.hpp"
#include "render/bake/picture_tree.hpp"
#include "render/model/model.hpp"

namespace surefoot::bake {

/// The light on what one sees of a leaf from one side: means over what is lit, as large as it is seen. Each but `colour` counts
/// by the surface's colour: what is bright makes more of light.
struct SeenLight {
    float weight = 0;  ///< mean of the colours' channels; 0: nothing that one sees is lit
    vec3 normal{0.0F};
    float sky = 0, room = 0;  ///< factors of light by openness: min(1, 4 * sky), and 0.6 + 0.4 * room
    std::array<float, std::tuple_size_v<SunDirections>> sun{};  ///< of the sun at each moment: by angle, shadow and openness
    vec3 colour{0.0F}, lamps{0.0F};                             ///< lamps: 1 is the brightest of the model
    void add(const SeenLight& more, float times);
};

/// Works out light of leaves, by small pictures of them.
class LeafLight {
public:
    explicit LeafLight(const model::Model& model);
    /// Of a leaf's full detail, from direction_of_face(face).
    [[nodiscard]] SeenLight seen(const model::Node& leaf, std::uint32_t face) const;
    /// Of all leaves, by node.
    [[nodiscard]] std::vector<SeenLight> seen_of_all(std::uint32_t face, const ForAll& for_all) const;
    [[nodiscard]] const SunDirections& suns() const { return suns_; }

private:
    const model::Model& model_;
    SunDirections suns_;
    std::vector<vec3> pictures_;  ///< by texture: its mean colour, 0..255
};

/// Fills face.light. owners: by texel, whose light of `lights` it shows, or none. Where nothing lit shows, it stays empty.
void light_corners(const std::vector<model::Index>& owners, std::span<const SeenLight> lights, const SunDirections& suns,
                   std::uint32_t pixels, FaceCapture& face);
/// Divides the pictures of a box by the light of their corners in the model's own light, and sets BoxForm::light. So by that
/// light it looks as it was captured, as far as no texel would be brighter than white. A box that has a face without light keeps
/// its pictures.
void take_light(const model::Model& model, BoxForm& box);

}  // namespace surefoot::bake
