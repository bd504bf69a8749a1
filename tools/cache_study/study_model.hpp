// The scene of a study as a model that a device draws: its triangles by box, by object, and each once.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/gl/device.hpp"
#include "render/model/model.hpp"
#include "tools/cache_study/study_scenes.hpp"

namespace surefoot::cache_study {

/// What colours the triangles have.
enum class Colouring : std::uint8_t {
    shaded,     ///< their own, in the light of the sun
    by_object,  ///< one of seven full colours for each object, without light: what is wrong is seen
};

/// Of Colouring::by_object, never black, which is what is behind all.
std::array<std::uint8_t, 3> full_colour(std::uint32_t object);

/// An object of the scene: an item that holds all its triangles.
struct StudyObject {
    gl::DrawItem item;
    Box box;
};

/// The model, and what of it to draw for what.
struct StudyModel {
    model::Model model;
    std::vector<gl::DrawItem> of_leaf;                   ///< one a box: all triangles that meet it, if it is a leaf
    std::vector<std::vector<gl::DrawItem>> of_captured;  ///< all that meet the box when it is grown; those of two leaves twice
    std::vector<StudyObject> whole;                      ///< every triangle once, near ones together
    std::vector<StudyObject> objects;                    ///< every triangle once, by what it belongs to
};
/// grown_m: the boxes of pictures are grown by no more. What is in the rim and hides something there must be captured too.
StudyModel make_study_model(const StudyScene& scene, Colouring colouring, double grown_m);

}  // namespace surefoot::cache_study
