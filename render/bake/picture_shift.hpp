// Texture error of a level: how far its texture is shifted along the surface. Exact geometry may still have a squeezed texture.
#pragma once

#include <memory>
#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// The full detail of one geometry, with which its levels' textures are compared.
class PictureReference {
public:
    /// `pictures`: by material. The geometry must outlive this. Its vertex array may grow; used vertices must not change.
    PictureReference(const Geometry& full, const std::vector<Picture>& pictures);
    ~PictureReference();
    PictureReference(const PictureReference&) = delete;
    PictureReference& operator=(const PictureReference&) = delete;

    /// Metres along the surface, at the 90 % quantile of the level's textured area; 0 without textured parts. Sampled: no bound.
    /// Compares each sample with the nearest point of the full detail in the same material. Whole repeats of a repeating texture
    /// do not count. The quantile excludes seams, where the nearest point may be on the other side.
    [[nodiscard]] float shift_m(const Level& level) const;

private:
    struct Surface;  ///< one material's full detail
    const Geometry& full_;
    std::vector<std::unique_ptr<Surface>> surfaces_;
};

}  // namespace surefoot::bake
