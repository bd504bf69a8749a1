// Checking scenes (scene_check.hpp).
#include "tools/selftest/scene_check.hpp"

#include <array>
#include <cmath>

#include "rt/base/hash.hpp"
#include "tools/selftest/cut_fixture.hpp"

namespace surefoot::selftest {

namespace {

/// Seen from four places, numbers must be finite and cuts legal.
std::uint64_t unsound_views(const model::Model& model, std::uint64_t& cut_hash) {
    std::uint64_t bad = 0;
    CutFixture fixture(model);
    const Box& box = model.nodes[0].box;
    const double size = std::max(box.diagonal(), 1e-30);
    for (const dvec3& at : {box.centre(), box.centre() + dvec3(0, 0, 1) * size, box.centre() + dvec3(3, 2, 5) * size, box.max}) {
        Pose pose;
        pose.position = at;
        const prepare::PreparedFrame& frame = fixture.prepare({pose, 0, 0});
        bad += unsound(frame, fixture.costs());
        const select::Cut& cut = fixture.select(select::usual_selector, 2500);
        bad += illegal(frame, cut);
        cut_hash = fnv1a(cut_hash, cut.hash);
    }
    for (const model::Representation& r : model.reps) bad += std::isfinite(r.error_m) ? 0 : 1;
    return bad;
}

}  // namespace

void check_scene(const std::string& name, importer::Scene scene, std::uint64_t wanted, Tally& tally, Outcome& out) {
    ++tally.cases;
    const auto model = import_and_bake(std::move(scene));
    if (!model) {
        if (wanted != refused) tally.complain(name + " is refused: " + model.error().text());
        if (model.error().place.empty() || model.error().what.empty()) tally.complain(name + " is refused without a word");
        out.digest_of(refused);
        return;
    }
    tally.kept += model->triangles();
    if (model->triangles() != wanted)
        tally.complain(name + " has " + std::to_string(model->triangles()) + " triangles, not " + std::to_string(wanted));
    std::uint64_t hash = out.cut_hash;
    if (unsound_views(*model, hash) > 0) tally.complain(name + " has unsound numbers or cuts");
    for (const model::Vertex& v : model->vertices) {
        const double length = glm::length(dvec3(v.normal[0], v.normal[1], v.normal[2]));
        if (length < 120 || length > 130) {
            tally.complain(name + " has a normal of no length");
            break;
        }
    }
    out.cut_hash = hash;
    out.digest_of(model->triangles());
    out.digest_of(hash);
}

void report(const Tally& tally, std::size_t min_cases, Outcome& out) {
    out.none_of("cases that do not end as they must" + (tally.first.empty() ? "" : " (" + tally.first + ")"), tally.wrong);
    out.at_least("cases", static_cast<double>(tally.cases), static_cast<double>(min_cases));
    out.triangles = tally.kept;
}

importer::Primitive with(const std::vector<vec3>& more, std::vector<std::uint32_t> indices) {
    importer::Primitive p = triangles({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 3});
    for (std::uint32_t& i : indices) i += 4;
    p.positions.insert(p.positions.end(), more.begin(), more.end());
    p.indices.insert(p.indices.end(), indices.begin(), indices.end());
    return p;
}

}  // namespace surefoot::selftest
