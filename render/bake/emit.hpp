// Geometry and representations into the model's flat arrays.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/bake/capture_box.hpp"
#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// Where the levels of a chain lie in the model: a range of parts each, shared by all placements.
struct EmittedChain {
    /// One level, as a range of parts.
    struct Level {
        model::Index first_part = 0;
        std::uint32_t part_count = 0, triangles = 0;
        float error_m = 0;
        model::EffectMask effects = 0;
    };
    std::vector<Level> levels;
    dvec3 centre{0};
    const LodChain* chain = nullptr;
};

/// Takes out all that the functions below add, and nodes and names. Materials and textures stay.
void clear_emitted(model::Model& model);
/// Where the name lies in the model's names; 0: none.
model::Index add_name(model::Model& model, const std::string& name);

EmittedChain emit_chain(const LodChain& chain, model::Model& model);

/// Adds one representation a level, placed by `world` (mesh frame to world), and moved by `motion`. Errors are multiplied by its
/// largest stretch.
void emit_representations(const EmittedChain& emitted, const dmat4& world, model::Model& model,
                          model::Index motion = model::none);

/// A box impostor in the world frame, for a node with box `box`.
struct BoxForm {
    std::array<FaceCapture, box_faces> faces;
    Box box;
    float error_m = 0;
    bool textured = false;     ///< else each face has one colour
    bool lit = false;          ///< pictures are without light, which faces have
    std::uint32_t pixels = 0;  ///< of a face's side
    [[nodiscard]] std::uint32_t shown_faces() const {
        return static_cast<std::uint32_t>(
            std::count_if(faces.begin(), faces.end(), [](const FaceCapture& f) { return f.covered > 0; }));
    }
};
/// Texels of a face in a cell of a picture of six, whose rim keeps mip levels from mixing faces.
constexpr std::uint32_t face_pixels(std::uint32_t cell) { return cell - cell / 8; }
/// Adds the representation of the box, which `motion` moves. proxy: the material of plain boxes.
void emit_box(const BoxForm& form, model::Index proxy, model::Model& model, model::Index motion = model::none);

}  // namespace surefoot::bake
