// surefoot cache-study: counts of the three-dimensional image cache on walks like the published ones.
#include <fmt/format.h>

#include <cmath>

#include "render/image/image.hpp"
#include "rt/base/file.hpp"
#include "tools/cache_study/study.hpp"
#include "tools/cache_study/study_scenes.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/report/terminal.hpp"

namespace surefoot::cli {

namespace {

struct CacheStudyArguments {
    cache_study::StudyRequest request;
    std::string size, birds_eye;
    bool json = false;
};

constexpr std::string_view sheet_ending = ".png";

nlohmann::ordered_json finite_or_null(double value) {
    if (std::isfinite(value)) return value;
    return nullptr;
}

nlohmann::ordered_json cache_frame_json(const cache_study::StudyFrame& frame) {
    return {{"new", frame.counts.fresh},
            {"combined", frame.counts.combined},
            {"reused", frame.counts.reused},
            {"not_replaceable", frame.counts.not_replaceable},
            {"refreshed_ahead", frame.counts.ahead},
            {"bytes", frame.bytes},
            {"bound_px", frame.bound_px},
            {"measured_px", frame.measured_px}};
}

nlohmann::ordered_json cache_sums_json(const cache_study::StudySums& sums) {
    const cache_study::StudyShape shape = cache_study::shape_of(sums);
    return {{"new", sums.fresh},
            {"combined", sums.combined},
            {"reused", sums.reused},
            {"not_replaceable", sums.not_replaceable},
            {"max_new_of_a_frame", sums.max_fresh},
            {"measured_px", sums.measured_px},
            {"reused_per_combined", finite_or_null(shape.reused_per_combined)},
            {"combined_per_new", finite_or_null(shape.combined_per_fresh)},
            {"shape_as_published", shape.as_published()}};
}

void print_study_json(const CacheStudyArguments& a, const cache_study::Study& study) {
    nlohmann::ordered_json frames = nlohmann::ordered_json::array();
    for (const cache_study::StudyFrame& frame : study.corrected) frames.push_back(cache_frame_json(frame));
    print_json({{"study", a.request.study},
                {"triangles", study.triangles},
                {"boxes", study.boxes},
                {"filled_boxes", study.filled_boxes},
                {"width", a.request.width},
                {"height", a.request.height},
                {"frames", frames},
                {"after_first", cache_sums_json(cache_study::sums_after_first(study.corrected))},
                {"published_tests", cache_sums_json(cache_study::sums_after_first(study.published))}});
}

void print_study_text(const CacheStudyArguments& a, const cache_study::Study& study) {
    fmt::print("{}: {} triangles in {} boxes, {} of them empty; {} frames of {}x{} at 60 degrees\n", a.request.study,
               study.triangles, study.boxes, study.boxes - study.filled_boxes, study.corrected.size(), a.request.width,
               a.request.height);
    const report::Columns columns(
        {{"", 28}, {"new", -7}, {"combined", -9}, {"reused", -8}, {"not replaceable", -16}, {"most new", -9}, {"measured", -10}});
    fmt::print("{}\n", columns.heading());
    const auto row = [&](const char* what, const cache_study::StudySums& s) {
        fmt::print("{}\n", columns.row({what, std::to_string(s.fresh), std::to_string(s.combined), std::to_string(s.reused),
                                        std::to_string(s.not_replaceable), std::to_string(s.max_fresh),
                                        fmt::format("{:.2f} px", s.measured_px)}));
    };
    const cache_study::StudyFrame& first = study.corrected.front();
    const cache::CacheCounts& counts = first.counts;
    row("first frame",
        {counts.fresh, counts.combined, counts.reused, counts.not_replaceable, counts.fresh, 0, first.measured_px});
    const auto sums = cache_study::sums_after_first(study.corrected);
    row("after it, summed", sums);
    row("by the tests of 1996", cache_study::sums_after_first(study.published));
    const cache_study::StudyShape shape = cache_study::shape_of(sums);
    fmt::print("Pictures held at the end: {:.1f} MB.\n", static_cast<double>(study.corrected.back().bytes) * 1e-6);
    fmt::print("Measured: the largest error of points in pictures, in pixels at the corner of the view. Promised: {:.2f} px.\n",
               sums.bound_px);
    fmt::print("After the first frame {:.1f} pictures are reused for each combined one, and {:.2f} combined for each new one.\n",
               shape.reused_per_combined, shape.combined_per_fresh);
    fmt::print("Published: many more are reused than combined (here 10 or more), and more combined than new (over 1): {}.\n",
               shape.as_published() ? "holds" : "does not hold");
    fmt::print("Nothing is drawn yet, so there are no times.\n");
}

int run_cache_study(CacheStudyArguments& a, const Context& context) {
    if (!a.size.empty()) {
        const auto size = parse_size(a.size);
        if (!size) return misuse(size.error());
        a.request.width = size->width;
        a.request.height = size->height;
    }
    if (!a.birds_eye.empty()) {
        if (!a.birds_eye.ends_with(sheet_ending))
            return misuse({"--birds-eye " + a.birds_eye, "The picture cannot be written in this format",
                           fmt::format("Write FILE{}", sheet_ending), ErrorKind::misuse});
        if (auto ok = probe_writable(a.birds_eye); !ok) return fail(ok.error());
        a.request.pictures = true;
    }
    const auto study = cache_study::run_study(a.request, terminal_progress(context));
    end_progress(context);
    if (!study) return fail(study.error());
    if (!a.birds_eye.empty()) {
        const cache_study::SheetPicture sheet = cache_study::picture_of_sheet(study->sheet);
        if (auto ok = image::write_png(a.birds_eye, sheet.width, sheet.height, sheet.rgba); !ok) return fail(ok.error());
    }
    if (a.json)
        print_study_json(a, *study);
    else
        print_study_text(a, *study);
    return exit_success;
}

}  // namespace

void add_cache_study(CLI::App& app, Context& context) {
    auto a = std::make_shared<CacheStudyArguments>();
    CLI::App* c = add_command(
        app, "cache-study", "Count what an image cache would make, combine and reuse on walks like the published ones",
        "surefoot cache-study flat --birds-eye flat.png\n\n"
        "Pictures of boxes stand for what is in them, as long as no point is displaced by over a pixel. The first table row\n"
        "is the frame that fills the cache. Nothing is drawn yet: walks do not use this cache, and no times are measured.\n"
        "Source: Schaufler and Stuerzlinger 1996.",
        a->json);
    std::string help = "Study. ";
    std::vector<std::string_view> names;
    for (const Named& study : cache_study::studies()) {
        help += fmt::format("{}{}: {}", names.empty() ? "" : "; ", study.name, study.help);
        names.push_back(study.name);
    }
    c->add_option("study", a->request.study, help)->required()->check(one_of(names));
    c->add_option("--frames", a->request.frames, "Number of frames (else as many as the paper shows: 120 or 100)")
        ->check(whole_number_within(1, 1'000'000));
    c->add_option("--size", a->size, "Size of the picture in pixels [320x240]");
    c->add_option("--birds-eye", a->birds_eye,
                  "PNG file of 20 views from above, spread over the frames. Red: new; green: combined; white: reused; black: "
                  "not replaceable")
        ->check(names_something());
    c->callback([&context, a] { context.run = [a, &context] { return run_cache_study(*a, context); }; });
}

}  // namespace surefoot::cli
