// Effects counted over poses of a path, without drawing.
#include "tools/accuracy/effect_use.hpp"

#include <algorithm>
#include <map>

#include "render/model/moving.hpp"
#include "render/model/room_sides.hpp"
#include "tools/walk/frame_share.hpp"

namespace surefoot::accuracy {

namespace {

double share(std::uint64_t part, std::uint64_t all) { return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : 0; }

/// The object that a leaf belongs to; the leaf itself, if there is none.
model::Index object_of(const model::Model& m, model::Index leaf) {
    for (model::Index n = leaf; n != model::none; n = m.nodes[n].parent)
        if (m.nodes[n].kind == model::NodeKind::object) return n;
    return leaf;
}

/// Leaves of one name. Pieces of a divided object have no node in common: their object's index tells them apart.
struct Named {
    std::uint64_t triangles = 0;
    std::vector<model::Index> objects;
};

/// Triangles by effect as the device draws forms for an eye: what sees no sky has no sun there.
class SeenTriangles {
public:
    SeenTriangles(const model::Model& m, double time_s)
        : m_(m), closed_(m), poses_(m), of_reps_(triangles_of_reps(m)), seen_(of_reps_) {
        poses_.set_time(time_s);
    }
    std::span<const TrianglesByEffect> from(const dvec3& eye, std::span<const model::Index> reps) {
        for (const model::Index r : reps) count(r, eye);
        return seen_;
    }

private:
    void count(model::Index r, const dvec3& eye) {
        const model::Representation& rep = m_.reps[r];
        const model::Placement& place = m_.placements[rep.placement];
        seen_[r] = of_reps_[r];
        for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
            if (!closed_.any(p)) continue;
            const dvec3 at_rest = place.motion == model::none ? eye : poses_.at(place.motion).back(eye);
            if (!closed_.shows_no_sky(p, model::eye_in_frame(place.origin, place.linear, at_rest))) continue;
            const model::EffectMask unused = m_.materials[m_.parts[p].material].effects & model::effects_under_sky;
            for (std::size_t e = 0; e < seen_[r].size(); ++e)
                if ((unused >> e & 1U) != 0) seen_[r][e] -= m_.parts[p].index_count / 3;
        }
    }

    const model::Model& m_;
    model::RoomSides closed_;
    model::MotionPoses poses_;
    std::vector<TrianglesByEffect> of_reps_, seen_;
};

}  // namespace

void FramesInUse::add(const model::Model& m, std::span<const TrianglesByEffect> of_reps, std::span<const model::Index> reps) {
    ++frames;
    for (std::size_t e = 0; e < triangles_with.size(); ++e) {
        model::Index largest = model::none;
        for (const model::Index rep : reps) {
            if (of_reps[rep][e] == 0) continue;
            triangles_with[e] += of_reps[rep][e];
            ++items_with[e];
            ++frames_of_rep[e][rep];
            if (largest == model::none || of_reps[rep][e] > of_reps[largest][e]) largest = rep;
        }
        if (largest == model::none) continue;
        if (++frames_with[e] > 1) continue;
        first_frame[e] = frames - 1;
        first_rep[e] = largest;
    }
    for (const model::Index rep : reps) triangles += m.reps[rep].triangles;
}

model::Index node_of(const model::Model& m, model::Index rep) {
    for (model::Index n = 0; n < m.nodes.size(); ++n)
        if (rep >= m.nodes[n].first_rep && rep < m.nodes[n].first_rep + m.nodes[n].rep_count) return n;
    return model::none;
}

double FramesInUse::share_of_frames(std::size_t effect) const { return share(frames_with[effect], frames); }
double FramesInUse::share_of_triangles(std::size_t effect) const { return share(triangles_with[effect], triangles); }

std::vector<Holder> holders_of(const model::Model& m, std::size_t effect) {
    const std::vector<TrianglesByEffect> of_reps = triangles_of_reps(m);
    std::map<std::string, Named> by_name;
    std::uint64_t all = 0;
    for (model::Index n = 0; n < m.nodes.size(); ++n) {
        const model::Node& leaf = m.nodes[n];
        if (leaf.child_count > 0) continue;
        const std::uint64_t triangles = of_reps[leaf.first_rep + leaf.rep_count - 1][effect];
        if (triangles == 0) continue;
        all += triangles;
        Named& named = by_name[m.name_of(m.nodes[object_of(m, n)])];
        named.triangles += triangles;
        named.objects.push_back(leaf.object);
    }
    std::vector<Holder> out;
    for (auto& [name, named] : by_name) {
        std::sort(named.objects.begin(), named.objects.end());
        const auto end = std::unique(named.objects.begin(), named.objects.end());
        out.push_back({name, static_cast<std::uint32_t>(end - named.objects.begin()), share(named.triangles, all)});
    }
    std::stable_sort(out.begin(), out.end(), [](const Holder& a, const Holder& b) { return a.share > b.share; });
    out.resize(std::min(out.size(), max_holders));
    return out;
}

namespace {

/// Counts vertices of the parts with the effect, and those that see sky.
void count_vertices(const model::Model& m, model::Index rep, std::size_t effect, DrawnHolder& out) {
    std::vector<std::uint32_t> used;
    for (model::Index p = m.reps[rep].first_part; p < m.reps[rep].first_part + m.reps[rep].part_count; ++p) {
        const model::Part& part = m.parts[p];
        const model::Material& material = m.materials[part.material];
        if ((material.effects >> effect & 1U) == 0) continue;
        const auto first = m.indices.begin() + part.first_index;
        used.assign(first, first + part.index_count);
        std::sort(used.begin(), used.end());
        used.erase(std::unique(used.begin(), used.end()), used.end());
        out.vertices += static_cast<std::uint32_t>(used.size());
        out.see_sky += static_cast<std::uint32_t>(std::count_if(used.begin(), used.end(), [&](std::uint32_t v) {
            const auto& hidden = m.vertices[part.first_vertex + v].hidden;
            return hidden[0] != 255 || (material.two_sided && hidden[1] != 255);
        }));
    }
}

}  // namespace

std::vector<DrawnHolder> drawn_holders(const model::Model& m, const FramesInUse& frames, std::size_t effect) {
    std::vector<model::Index> nodes(m.reps.size(), model::none);
    for (model::Index n = 0; n < m.nodes.size(); ++n)
        for (model::Index r = m.nodes[n].first_rep; r < m.nodes[n].first_rep + m.nodes[n].rep_count; ++r) nodes[r] = n;
    struct Often {
        std::uint32_t frames = 0;
        model::Index rep = model::none;
    };
    std::map<std::string, std::pair<std::uint64_t, Often>> by_name;
    for (const auto& [rep, count] : frames.frames_of_rep[effect]) {
        auto& [items, often] = by_name[nodes[rep] == model::none ? "" : m.name_of(m.nodes[nodes[rep]])];
        items += count;
        if (count > often.frames) often = {count, rep};
    }
    std::vector<DrawnHolder> out;
    for (const auto& [name, drawn] : by_name) {
        DrawnHolder& holder = out.emplace_back();
        holder.name = name;
        holder.items = drawn.first;
        holder.node = nodes[drawn.second.rep];
        if (holder.node != model::none) holder.middle_m = m.nodes[holder.node].box.centre();
        count_vertices(m, drawn.second.rep, effect, holder);
    }
    std::stable_sort(out.begin(), out.end(), [](const DrawnHolder& a, const DrawnHolder& b) { return a.items > b.items; });
    return out;
}

UseOfEffects measure_use(Engine& engine, std::span<const Pose> poses, const Progress& progress, double time_s) {
    UseOfEffects use;
    const model::Model& m = engine.model();
    SeenTriangles triangles(m, time_s);
    constexpr double budget_us = walk::frame_share * 1e6 / walked_rate_hz;
    prepare::PreparedFrame prepared;
    engine.reserve(prepared);
    PrepareHints hints;
    hints.time_s = time_s;
    std::vector<model::Index> reps;
    const auto count = [&](FramesInUse& frames, const dvec3& eye, const auto& items) {
        reps.clear();
        for (const auto& item : items) reps.push_back(item.rep);
        frames.add(m, triangles.from(eye, reps), reps);
    };
    for (const Pose& pose : poses) {
        if (progress.stopped()) break;
        count(use.full, pose.position, engine.full_detail(pose));
        engine.prepare({pose, 0.0, 0.0}, 0, 0.0, 0.0, prepared, hints);
        count(use.walked, pose.position, engine.select(prepared, budget_us, {}, 0.0).items);
    }
    return use;
}

}  // namespace surefoot::accuracy
