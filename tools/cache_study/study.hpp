// A study of the image cache: what every frame of a walk would make, combine and reuse. Counts only: nothing is drawn.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/cache/update.hpp"
#include "render/model/view.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "tools/cache_study/birds_eye.hpp"

namespace surefoot::cache_study {

/// What to study. The paper says only that its pictures were small.
struct StudyRequest {
    std::string study;
    std::uint32_t frames = 0;  ///< 0: as many as the paper shows
    std::uint32_t width = 320, height = 240;
    bool pictures = false;  ///< a sheet of bird's-eye views
};

/// A frame of the cache. Errors are of what is drawn as pictures, in pixels at the corner of the view.
struct StudyFrame {
    cache::CacheCounts counts;
    std::uint64_t bytes = 0;  ///< of all pictures that are held
    double bound_px = 0;      ///< what the cache promises; 0 by the published rules, which know no sum
    double measured_px = 0;   ///< of points that are followed through the pictures
};

/// Frames after the first one, summed.
struct StudySums {
    std::uint64_t fresh = 0, combined = 0, reused = 0, not_replaceable = 0;
    std::uint32_t max_fresh = 0;           ///< of one frame
    double bound_px = 0, measured_px = 0;  ///< of one frame
};
StudySums sums_after_first(const std::vector<StudyFrame>& frames);

/// Both rules walk the same way through the same boxes.
struct Study {
    std::uint64_t triangles = 0;
    std::uint32_t boxes = 0, filled_boxes = 0;  ///< filled: with triangles
    std::vector<StudyFrame> corrected, published;
    ViewSheet sheet;  ///< empty unless StudyRequest::pictures
};

/// Errors: unknown study, no room for the boxes, stopped.
Result<Study> run_study(const StudyRequest& request, const Progress& progress);

/// What the paper's graphs show after the first frame. Many more pictures are reused than combined; more combined than made anew.
struct StudyShape {
    double reused_per_combined = 0, combined_per_fresh = 0;  ///< infinite where nothing is combined or made anew
    [[nodiscard]] bool as_published() const { return reused_per_combined >= 10 && combined_per_fresh > 1; }
};
StudyShape shape_of(const StudySums& sums);

}  // namespace surefoot::cache_study
