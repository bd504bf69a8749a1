// surefoot cache-study: the three-dimensional image cache on walks like the published ones: counts, times and pictures.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "render/gl/backends.hpp"
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
    std::string size, birds_eye, backend{gl::usual_backend}, pictures, kind{cache_study::picture_kinds().front().name};
    bool json = false;
};

constexpr std::string_view sheet_ending = ".png";

nlohmann::ordered_json finite_or_null(double value) {
    if (std::isfinite(value)) return value;
    return nullptr;
}

nlohmann::ordered_json cache_frame_json(const cache_study::StudyFrame& frame) {
    nlohmann::ordered_json json = {{"new", frame.counts.fresh},
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
    if (!frame.times) return json;
    json["ms"] = frame.times->cached.ms;
    json["full_ms"] = frame.times->full.ms;
    json["cpu_ms"] = frame.times->cached.cpu_ms;
    json["full_cpu_ms"] = frame.times->full.cpu_ms;
    json["pictures_in_view"] = frame.times->pictures;
    json["leaves_in_view"] = frame.times->leaves;
    json["meshes_in_view"] = frame.times->meshes;
    json["mesh_triangles"] = frame.times->mesh_triangles;
    return json;
}

nlohmann::ordered_json study_times_json(const cache_study::StudySums& sums) {
    if (sums.drawn == 0) return nullptr;
    const auto frames = static_cast<double>(sums.drawn);
    return {{"frames", sums.drawn},
            {"faster", sums.faster},
            {"faster_cpu", sums.faster_cpu},
            {"mean_ms", sums.cached.ms / frames},
            {"mean_full_ms", sums.full.ms / frames},
            {"mean_cpu_ms", sums.cached.cpu_ms / frames},
            {"mean_full_cpu_ms", sums.full.cpu_ms / frames},
            {"mean_pictures", static_cast<double>(sums.pictures) / frames},
            {"mean_meshes", static_cast<double>(sums.meshes) / frames},
            {"mean_mesh_triangles", static_cast<double>(sums.mesh_triangles) / frames},
            {"meshes_made", sums.made.made},
            {"meshes_too_dear", sums.made.too_dear},
            {"depths_read", sums.made.read_texels},
            {"mean_meshing_cpu_ms", sums.made.making_cpu_ms / frames}};
}

nlohmann::ordered_json study_checks_json(const std::vector<cache_study::StudyCheck>& checks) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const cache_study::StudyCheck& check : checks)
        json[check.what] = {{"frames", check.frames.frames},       {"wrong_frames", check.frames.wrong_frames},
                            {"pixels", check.frames.pixels},       {"wrong", check.frames.wrong},
                            {"uncovered", check.frames.uncovered}, {"most_wrong_of_a_frame", check.frames.worst},
                            {"pictures", check.frames.pictures},   {"leaves", check.frames.leaves},
                            {"meshes", check.frames.meshes}};
    return json;
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
                {"kind", a.kind},
                {"width", a.request.width},
                {"height", a.request.height},
                {"walked_m", study.walked_m},
                {"step_m", study.step_m},
                {"renderer", study.renderer.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(study.renderer)},
                {"ms_reason", study.no_times.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(study.no_times)},
                {"frames", frames},
                {"after_first", cache_sums_json(cache_study::sums_after_first(study.corrected), study.triangles)},
                {"published_tests", cache_sums_json(cache_study::sums_after_first(study.published), study.triangles)},
                {"times_after_first", study_times_json(cache_study::sums_after_first(study.corrected))},
                {"checks", study_checks_json(study.checks)}});
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

void print_study_times(const cache_study::Study& study, const cache_study::StudySums& sums) {
    if (!study.no_times.empty()) fmt::print("There are no times. {}\n", study.no_times);
    if (sums.drawn == 0) return;
    const auto frames = static_cast<double>(sums.drawn);
    fmt::print("Drawn by {}: {:.2f} ms a frame, in full {:.2f}; of processor time {:.2f}, in full {:.2f}.\n", study.renderer,
               sums.cached.ms / frames, sums.full.ms / frames, sums.cached.cpu_ms / frames, sums.full.cpu_ms / frames);
    fmt::print("Faster with the cache: {:.1f} % of {} frames; by processor time {:.1f} %.\n",
               100 * static_cast<double>(sums.faster) / frames, sums.drawn, 100 * static_cast<double>(sums.faster_cpu) / frames);
    if (sums.made.made + sums.made.too_dear == 0) return;
    fmt::print("Meshes: {:.1f} of {:.1f} pictures a frame, with {:.0f} triangles; {} made, {} too dear, in {:.2f} ms a frame.\n",
               static_cast<double>(sums.meshes) / frames, static_cast<double>(sums.pictures) / frames,
               static_cast<double>(sums.mesh_triangles) / frames, sums.made.made, sums.made.too_dear,
               sums.made.making_cpu_ms / frames);
}

void print_study_checks(const std::vector<cache_study::StudyCheck>& checks) {
    if (checks.empty()) return;
    const report::Columns columns({{"compared in full colours", 26},
                                   {"frames", -8},
                                   {"pixels", -10},
                                   {"wrong", -8},
                                   {"uncovered", -11},
                                   {"pictures", -10}});
    fmt::print("{}\n", columns.heading());
    for (const cache_study::StudyCheck& check : checks)
        fmt::print("{}\n", columns.row({check.what, std::to_string(check.frames.frames), std::to_string(check.frames.pixels),
                                        std::to_string(check.frames.wrong), std::to_string(check.frames.uncovered),
                                        std::to_string(check.frames.pictures)}));
    fmt::print(
        "Wrong: what the pixel shows is not seen in the scene within a pixel. Uncovered: of these, it is there, but hidden.\n");
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
    print_study_times(study, sums);
    print_study_checks(study.checks);
}

/// |a - b|, opaque.
std::vector<std::uint8_t> difference_of(const gl::PixelImage& a, const gl::PixelImage& b) {
    std::vector<std::uint8_t> rgba(a.rgba.size(), 255);
    for (std::size_t i = 0; i < rgba.size(); ++i)
        if (i % 4 != 3) rgba[i] = static_cast<std::uint8_t>(std::abs(int{a.rgba[i]} - int{b.rgba[i]}));
    return rgba;
}

Result<void> write_study_views(const CacheStudyArguments& a, const cache_study::Study& study) {
    for (const cache_study::StudyView& view : study.views) {
        if (view.cached.rgba.size() != view.full.rgba.size()) continue;
        const auto write = [&](const char* what, std::span<const std::uint8_t> rgba) -> Result<void> {
            if (rgba.empty()) return {};
            return image::write_png(fmt::format("{}/{}-{:05}-{}.png", a.pictures, a.request.study, view.frame, what),
                                    a.request.width, a.request.height, rgba);
        };
        if (auto ok = write("cache", view.cached.rgba); !ok) return ok;
        if (auto ok = write("full", view.full.rgba); !ok) return ok;
        if (auto ok = write("difference", difference_of(view.cached, view.full)); !ok) return ok;
        if (auto ok = write("by-object", view.by_object.rgba); !ok) return ok;
    }
    return {};
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
    a.request.kind = cache_study::picture_kind_named(a.kind);
    const auto backend = gl::backend_named(a.backend);
    if (!backend) return misuse(backend.error());
    if ((*backend)->draws()) a.request.backend = (*backend)->kind;
    if (!a.pictures.empty()) {
        if (!a.request.backend)
            return misuse({"--pictures " + a.pictures, "This backend draws nothing",
                           "Remove --pictures, or choose another --backend", ErrorKind::misuse});
        std::error_code error;
        std::filesystem::create_directories(a.pictures, error);
        if (error)
            return fail({a.pictures, "The folder cannot be made: " + error.message(), "Name another folder with --pictures",
                         ErrorKind::unwritable});
        a.request.views = true;
    }
    const auto study = cache_study::run_study(a.request, terminal_progress(context));
    end_progress(context);
    if (!study) return fail(study.error());
    if (!a.birds_eye.empty()) {
        const cache_study::SheetPicture sheet = cache_study::picture_of_sheet(study->sheet);
        if (auto ok = image::write_png(a.birds_eye, sheet.width, sheet.height, sheet.rgba); !ok) return fail(ok.error());
    }
    if (auto ok = write_study_views(a, *study); !ok) return fail(ok.error());
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
        app, "cache-study", "Count and draw what an image cache makes, combines and reuses on walks like the published ones",
        "surefoot cache-study flat --birds-eye flat.png\n"
        "  surefoot cache-study room --pictures room\n\n"
        "Pictures of boxes stand for what is in them, as long as no point is displaced by over a pixel. The first table row\n"
        "is the frame that fills the cache. Each frame is drawn with the cache, then in full, and both are timed.\n"
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
    c->add_option(
        "--backend", a->backend,
        "Backend that draws: " + gl::drawing_backends() + "; null: count only [" + std::string(gl::usual_backend) + "]");
    std::string kind_help = "What shows a picture. ";
    std::vector<std::string_view> kind_names;
    for (const Named& kind : cache_study::picture_kinds()) {
        kind_help += fmt::format("{}{}: {}", kind_names.empty() ? "" : "; ", kind.name, kind.help);
        kind_names.push_back(kind.name);
    }
    c->add_option("--kind", a->kind, fmt::format("{} [{}]", kind_help, kind_names.front()))->check(one_of(kind_names));
    c->add_option(
         "--pictures", a->pictures,
         "Folder for five frames as PNG: with the cache, in full, their difference, and with a picture an object. Frames "
         "are also compared in full colours")
        ->check(names_something());
    c->callback([&context, a] { context.run = [a, &context] { return run_cache_study(*a, context); }; });
}

}  // namespace surefoot::cli
