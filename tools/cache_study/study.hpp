// A study of the image cache: what every frame of a walk makes, combines and reuses, and how long it takes to draw.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/cache/update.hpp"
#include "render/model/view.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "tools/cache_study/study_device.hpp"
#include "tools/cache_study/study_pictures.hpp"
#include "tools/cache_study/view_sheet.hpp"

namespace surefoot::cache_study {

/// What to study. The paper says only that its pictures were small.
struct StudyRequest {
    std::string study;
    std::uint32_t frames = 0;  ///< 0: as many as the paper shows
    std::uint32_t width = 320, height = 240;
    bool pictures = false;                   ///< a sheet of bird's-eye views
    std::optional<gl::BackendKind> backend;  ///< that draws the frames; none: they are counted only
    PictureKind kind = PictureKind::quad;    ///< of those that the backend draws
    bool views = false;                      ///< some frames as pictures, and whether they are right; with a backend
};

/// What a frame would draw, and what of it is new.
struct DrawWork {
    std::uint64_t triangles = 0;  ///< for new pictures, and of leaves that are drawn as triangles; once for every box
    std::uint64_t texels = 0;     ///< of new pictures, combined ones too
};
DrawWork work_of(const cache::BoxTree& tree, const cache::CachePlan& plan);

/// How long a frame took: all of it with the cache, its plan included, and without it. Times of the wall and of the processor.
struct FrameTimes {
    DrawTimes cached, full;
    std::uint32_t pictures = 0, leaves = 0;  ///< in view: drawn as pictures, and as triangles
    std::uint32_t meshes = 0;                ///< of the pictures: on meshes, of so many triangles
    std::uint64_t mesh_triangles = 0;
    MeshCounts made;
};

/// A frame of the cache. Errors are of what is drawn as pictures, in pixels at the corner of the view.
struct StudyFrame {
    cache::CacheCounts counts;
    std::uint64_t bytes = 0;  ///< of all pictures that are held
    double bound_px = 0;      ///< what the cache promises; 0 by the published rules, which know no sum
    double traced_px = 0;     ///< of points that are followed through the pictures
    DrawWork work;
    std::optional<FrameTimes> times;  ///< none: it was not drawn
};

/// Frames, summed.
struct StudySums {
    std::uint64_t fresh = 0, combined = 0, reused = 0, not_replaceable = 0;
    std::uint32_t max_fresh = 0, max_refreshes = 0;  ///< of one frame
    double bound_px = 0, traced_px = 0;              ///< of one frame
    DrawWork work;
    std::uint64_t frames = 0;
    std::uint64_t drawn = 0, faster = 0, faster_cpu = 0;  ///< frames that were drawn, and those that the cache made faster
    DrawTimes cached, full;
    std::uint64_t pictures = 0, meshes = 0, mesh_triangles = 0;  ///< that were drawn
    MeshCounts made;
};
StudySums sums_of(std::span<const StudyFrame> frames);
StudySums sums_after_first(const std::vector<StudyFrame>& frames);

/// A frame as pictures, RGBA8.
struct StudyView {
    std::uint32_t frame = 0;
    gl::PixelImage cached, full, by_object;  ///< by_object: one picture an object; empty where no object is known
};
constexpr std::uint32_t views_a_study = 5;

/// What was compared with the scene itself.
struct StudyCheck {
    const char* what = "";
    CheckedFrames frames;
};

/// Both rules walk the same way through the same boxes.
struct Study {
    std::uint64_t triangles = 0;
    std::uint32_t boxes = 0, filled_boxes = 0;  ///< filled: with triangles
    double walked_m = 0, step_m = 0;            ///< in all, and from a frame to the next
    std::vector<StudyFrame> corrected, published;
    ViewSheet sheet;                 ///< empty unless StudyRequest::pictures
    std::string renderer, no_times;  ///< what drew the frames; or why nothing did
    std::vector<StudyView> views;    ///< empty unless StudyRequest::views
    std::vector<StudyCheck> checks;  ///< the same
};

/// Errors: unknown study, no room for the boxes, stopped. A device that cannot be had is none: Study::no_times has the reason.
Result<Study> run_study(const StudyRequest& request, const Progress& progress);

/// What the paper's graphs seem to show after the first frame: many more pictures are reused than combined, and more are
/// combined than made anew. The numbers that stand for it here are ours: its text has none.
struct StudyShape {
    double reused_per_combined = 0, combined_per_fresh = 0;  ///< infinite where nothing is combined or made anew
    [[nodiscard]] bool as_published() const { return reused_per_combined >= 10 && combined_per_fresh > 1; }
};
StudyShape shape_of(const StudySums& sums);

}  // namespace surefoot::cache_study
