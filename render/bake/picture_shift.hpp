// How far the pictures on a level lie from where they belong: a plate may be exact in form with its picture moved or squeezed.
#pragma once

#include <memory>
#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// The full detail of one geometry, against which its levels' pictures are held.
class PictureReference {
public:
    /// `pictures`: by material. The geometry must outlive this; its vertices may grow, those that its parts use stay.
    PictureReference(const Geometry& full, const std::vector<Picture>& pictures);
    ~PictureReference();
    PictureReference(const PictureReference&) = delete;
    PictureReference& operator=(const PictureReference&) = delete;

    /// Metres along the surface, at the 90 % quantile of the level's area in parts that carry a picture; 0 without such parts.
    /// Sampled: no bound. Against the nearest place of the full detail in the same material; whole repeats of a picture that
    /// repeats count as none. The quantile leaves out seams, where the nearest place is at times the other side's.
    [[nodiscard]] float shift_m(const Level& level) const;

private:
    struct Surface;  ///< one material's full detail
    const Geometry& full_;
    std::vector<std::unique_ptr<Surface>> surfaces_;
};

}  // namespace surefoot::bake
