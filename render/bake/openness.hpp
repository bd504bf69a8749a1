// What each vertex sees of the sky and of its room, by rays: the sun shines only where a sky is seen.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "render/bake/picture_tree.hpp"
#include "render/bake/ray_tree.hpp"
#include "render/model/model.hpp"

namespace surefoot::bake {

/// What was found of the lit triangles.
struct Openness {
    bool measured = false;        ///< and something is hidden somewhere
    std::uint64_t vertices = 0;   ///< that lit triangles use
    std::uint64_t triangles = 0;  ///< lit ones of the leaves' full detail, as often as they are placed
    std::uint64_t closed = 0;     ///< of these, in parts that see no sky at all: drawn without the sun
    /// By vertex: bit 0, its front lies within something, so it holds the mean of its neighbours; bit 1, its back.
    std::vector<std::uint8_t> within;
    /// Materials without the sun that were added, and what each is a copy of.
    std::vector<std::pair<model::Index, model::Index>> copies;
};

/// The first vertices of chains that see no sky in any of their places (sky_sides.hpp), ascending.
using ClosedVertices = std::vector<std::uint32_t>;

/// Fills Vertex::hidden of all lit vertices and gives their materials effect_openness, unless nothing is hidden. Parts that see
/// no sky get a copy of their material without the sun. A vertex that stands in more than four places holds the mean of four, and
/// keeps the sun unless it is known to be closed. Coarse forms of closed chains see no sky either. for_all may run on many
/// threads; `step` is called on any of them, openness_steps() times. If it returns false, nothing is measured, and of the model
/// only Vertex::hidden has changed. The same bytes at any number of threads.
Openness measure_openness(model::Model& model, const RayTree& opaque, const ClosedVertices& closed, const ForAll& for_all,
                          const std::function<bool()>& step);
/// Adds what was measured to the findings of openness and sun.
void add_to_findings(const Openness& openness, std::vector<model::EffectFinding>& findings);
/// How often it calls `step`.
std::size_t openness_steps(const model::Model& model);

}  // namespace surefoot::bake
