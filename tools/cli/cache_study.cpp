// surefoot cache-study: counts of the three-dimensional image cache on walks like the published ones.
#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

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

constexpr std::string_view sheet_ending = ".png", no_times = "Nothing is drawn yet";

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
            {"triangles_drawn", frame.work.triangles},
            {"texels_made", frame.work.texels},
            {"bytes", frame.bytes},
            {"bound_px", frame.bound_px},
            {"traced_px", frame.traced_px},
            {"ms", nullptr}};
}

nlohmann::ordered_json cache_sums_json(const cache_study::StudySums& sums, std::uint64_t triangles) {
    const cache_study::StudyShape shape = cache_study::shape_of(sums);
    const nlohmann::ordered_json verdict = sums.frames > 0 ? nlohmann::ordered_json(shape.as_published()) : nullptr;
    return {{"frames", sums.frames},
            {"new", sums.fresh},
            {"combined", sums.combined},
            {"reused", sums.reused},
            {"not_replaceable", sums.not_replaceable},
            {"max_new_of_a_frame", sums.max_fresh},
            {"max_refreshes_of_a_frame", sums.max_refreshes},
            {"triangles_drawn", sums.work.triangles},
            {"triangles_without_cache", sums.frames * triangles},
            {"texels_made", sums.work.texels},
            {"traced_px", sums.traced_px},
            {"reused_per_combined", finite_or_null(shape.reused_per_combined)},
            {"combined_per_new", finite_or_null(shape.combined_per_fresh)},
            {"shape_as_published", verdict}};
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
                {"walked_m", study.walked_m},
                {"step_m", study.step_m},
                {"ms_reason", no_times},
                {"frames", frames},
                {"after_first", cache_sums_json(cache_study::sums_after_first(study.corrected), study.triangles)},
                {"published_tests", cache_sums_json(cache_study::sums_after_first(study.published), study.triangles)}});
}

using StudyRow = std::pair<const char*, cache_study::StudySums>;

void print_study_tables(const std::vector<StudyRow>& rows, std::uint64_t triangles) {
    const report::Columns counts({{"", 22},
                                  {"new", -7},
                                  {"combined", -9},
                                  {"reused", -8},
                                  {"not replaceable", -16},
                                  {"most refreshed", -15},
                                  {"traced", -9}});
    fmt::print("{}\n", counts.heading());
    for (const auto& [what, s] : rows)
        fmt::print("{}\n", counts.row({what, std::to_string(s.fresh), std::to_string(s.combined), std::to_string(s.reused),
                                       std::to_string(s.not_replaceable), std::to_string(s.max_refreshes),
                                       fmt::format("{:.2f} px", s.traced_px)}));
    const report::Columns work(
        {{"", 22}, {"triangles drawn", -16}, {"without a cache", -16}, {"share", -8}, {"texels made", -13}});
    fmt::print("{}\n", work.heading());
    for (const auto& [what, s] : rows) {
        const double all = static_cast<double>(s.frames) * static_cast<double>(triangles);
        const double share = all > 0 ? static_cast<double>(s.work.triangles) / all : 0;
        fmt::print("{}\n", work.row({what, std::to_string(s.work.triangles), std::to_string(s.frames * triangles),
                                     fmt::format("{:.0f} %", 100 * share), std::to_string(s.work.texels)}));
    }
}

void print_study_verdict(const char* rules, const cache_study::StudySums& sums) {
    const cache_study::StudyShape shape = cache_study::shape_of(sums);
    fmt::print("{}: {:.1f} reused for each combined one, {:.2f} combined for each new one: {}.\n", rules,
               shape.reused_per_combined, shape.combined_per_fresh, shape.as_published() ? "holds" : "does not hold");
}

void print_study_text(const CacheStudyArguments& a, const cache_study::Study& study) {
    fmt::print("{}: {} triangles in {} boxes, {} of them empty; {} frames of {}x{} at 60 degrees\n", a.request.study,
               study.triangles, study.boxes, study.boxes - study.filled_boxes, study.corrected.size(), a.request.width,
               a.request.height);
    fmt::print("Walked: {:.1f} m, in steps of {:.3f} m.\n", study.walked_m, study.step_m);
    const auto sums = cache_study::sums_after_first(study.corrected), of_1996 = cache_study::sums_after_first(study.published);
    std::vector<StudyRow> rows = {{"first frame", cache_study::sums_of({&study.corrected.front(), 1})}};
    if (sums.frames > 0) rows.insert(rows.end(), {{"after it, summed", sums}, {"by the tests of 1996", of_1996}});
    print_study_tables(rows, study.triangles);
    fmt::print("Pictures held at the end: {:.1f} MB.\n", static_cast<double>(study.corrected.back().bytes) * 1e-6);
    fmt::print("Traced: the largest error of points in pictures, in pixels at the corner of the view. Promised: {:.2f} px.\n",
               sums.bound_px);
    if (sums.frames > 0) {
        fmt::print(
            "Published curves, as we read them: 10 or more are reused for each combined one, and over 1 combined for each "
            "new.\n");
        print_study_verdict("Here", sums);
        print_study_verdict("By the tests of 1996", of_1996);
    }
    fmt::print("There are no times. {}.\n", no_times);
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
    c->add_option("--frames", a->request.frames, "Number of frames on the same way (else as many as the paper shows: 120 or 100)")
        ->check(whole_number_within(1, 1'000'000));
    c->add_option("--size", a->size, "Size of the picture in pixels [320x240]");
    c->add_option(
         "--birds-eye", a->birds_eye,
         "PNG file of up to 20 views from above, spread over the frames. Red: new; green: combined; white: reused; black: "
         "not replaceable")
        ->check(names_something());
    c->callback([&context, a] { context.run = [a, &context] { return run_cache_study(*a, context); }; });
}

}  // namespace surefoot::cli
