// Bench: the coarse forms of a model beside those of three single methods, at equal predicted time. The methods: edge collapses
// by quadrics of positions (Garland and Heckbert 1997), clusters of vertices (Rossignac and Borrel 1993), and thinning in a
// scattered order, where what stays is enlarged (Cook and others 2007). The first two are meshoptimizer's. Each method may use
// the best of its forms that take no longer than a share of full detail's time, by the built-in cost table. Without such a form
// the leaf is missing. Judged are leaves of 100 triangles or more, evenly spread, each mesh once: pictures of about 64 pixels
// across from eight sides and from above, before the sky, in the sun. Quadrics may join vertices of one place or not.
//
// bench_methods MODEL.walk [MESHES 60] -> one JSON object, a minute.
#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "render/bake/form_picture.hpp"
#include "render/bake/mesh_surface.hpp"
#include "render/model/cost.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/random.hpp"
#include "tests/bake/surface.hpp"

namespace {

using namespace surefoot;

constexpr std::uint32_t across_px = 64, min_triangles = 100;
constexpr std::array shares{0.5, 0.25, 0.125};  // of full detail's time
enum Method : std::size_t { ours, quadrics, clustering, thinning, methods };
constexpr std::array<const char*, methods> method_names{"ours", "quadrics", "clustering", "thinning"};

/// A form of one leaf, and how it did.
struct Form {
    double time_us = 0;
    double squared_error = 0;  ///< of 0..1, mean of the pixels that it or full detail covers, and of three channels
    double outline = 0;        ///< pixels that only one of both covers, by those of full detail
    double bound = -1;         ///< of the two-sided distance, by the diagonal; below 0: not known yet
    bake::Geometry geometry;   ///< of the rivals
    bool whole = false;        ///< full detail
    bool missing = false;      ///< no form is as cheap
};

/// Full detail about the node's centre, along the world's axes.
bake::Geometry geometry_of(const model::Model& m, const model::Representation& rep, const dvec3& centre) {
    bake::Geometry g;
    const model::Placement& placement = m.placements[rep.placement];
    const mat3 normals = cofactors(placement.linear);
    const bool mirrored = glm::determinant(placement.linear) < 0;
    for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
        const model::Part& part = m.parts[p];
        bake::GeometryPart own{part.material, {}};
        const auto base = static_cast<std::uint32_t>(g.vertices.size());
        for (std::uint32_t v = 0; v < part.vertex_count; ++v) {
            model::Vertex vertex = m.vertices[part.first_vertex + v];
            const vec3 at = bake::placed(m, rep, vertex, centre);
            vec3 normal = normals * vec3(vertex.normal[0], vertex.normal[1], vertex.normal[2]);
            normal *= (mirrored ? -127.0F : 127.0F) / std::max(glm::length(normal), 1e-20F);
            for (int k = 0; k < 3; ++k) {
                vertex.position[k] = at[k];
                vertex.normal[k] = static_cast<std::int8_t>(std::lround(normal[k]));
            }
            g.vertices.push_back(vertex);
        }
        for (std::uint32_t i = 0; i < part.index_count; ++i) {
            const std::uint32_t of_three = i % 3, turned = mirrored && of_three > 0 ? i - of_three + 3 - of_three : i;
            own.indices.push_back(base + m.indices[part.first_index + turned]);
        }
        g.parts.push_back(std::move(own));
    }
    return g;
}

/// Vertices of one place become one in each part: seams no longer stop a simplifier, but show the wrong picture.
bake::Geometry welded(bake::Geometry g) {
    for (bake::GeometryPart& part : g.parts) {
        std::map<std::array<float, 3>, std::uint32_t> first;
        for (std::uint32_t& index : part.indices) {
            const float* at = g.vertices[index].position;
            index = first.try_emplace({at[0], at[1], at[2]}, index).first->second;
        }
    }
    return g;
}

/// Each part by a simplifier that may leave so many indices.
template <class Simplify>
bake::Geometry simplified(const bake::Geometry& full, double share, const Simplify& simplify) {
    bake::Geometry g = full;
    for (bake::GeometryPart& part : g.parts) {
        const std::size_t triangles = part.indices.size() / 3;
        const auto left = static_cast<std::size_t>(share * static_cast<double>(triangles));
        std::vector<std::uint32_t> out(part.indices.size());
        out.resize(simplify(out, part.indices, std::max<std::size_t>(1, left) * 3));
        part.indices = std::move(out);
    }
    return g;
}

bake::Geometry collapsed(const bake::Geometry& full, double share) {
    return simplified(full, share, [&](auto& out, const auto& indices, std::size_t target) {
        return meshopt_simplify(out.data(), indices.data(), indices.size(), full.vertices[0].position, full.vertices.size(),
                                sizeof(model::Vertex), target, 1e9F, 0, nullptr);
    });
}

bake::Geometry clustered(const bake::Geometry& full, double share) {
    return simplified(full, share, [&](auto& out, const auto& indices, std::size_t target) {
        return meshopt_simplifySloppy(out.data(), indices.data(), indices.size(), full.vertices[0].position, full.vertices.size(),
                                      sizeof(model::Vertex), target, 1e9F, nullptr);
    });
}

/// Triangles in a scattered order, the first ones, each as much larger as others are missing.
bake::Geometry thinned(const bake::Geometry& full, double share) {
    bake::Geometry g;
    Random random(7);
    for (const bake::GeometryPart& part : full.parts) {
        std::vector<std::size_t> order(part.indices.size() / 3);
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
        for (std::size_t i = order.size(); i > 1; --i)
            std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
        const std::size_t left = std::max<std::size_t>(1, static_cast<std::size_t>(share * static_cast<double>(order.size())));
        order.resize(std::min(left, order.size()));
        const float larger = std::sqrt(static_cast<float>(part.indices.size()) / 3.0F / static_cast<float>(order.size()));
        bake::GeometryPart own{part.material, {}};
        for (const std::size_t triangle : order) {
            std::array<model::Vertex, 3> corners;
            vec3 middle(0.0F);
            for (std::size_t k = 0; k < 3; ++k) {
                corners[k] = full.vertices[part.indices[3 * triangle + k]];
                middle += bake::position_of(corners[k]) / 3.0F;
            }
            for (model::Vertex& corner : corners) {
                const vec3 at = middle + larger * (bake::position_of(corner) - middle);
                for (int k = 0; k < 3; ++k) corner.position[k] = at[k];
                own.indices.push_back(static_cast<std::uint32_t>(g.vertices.size()));
                g.vertices.push_back(corner);
            }
        }
        g.parts.push_back(std::move(own));
    }
    return g;
}

/// Full detail of one leaf from all round, and forms beside it.
class Judge {
public:
    Judge(const model::Model& m, const model::Node& node, const model::CostModel& costs)
        : m_(m), node_(node), costs_(costs), centre_(node.box.centre()) {
        const model::Representation& finest = m.reps[node.first_rep + node.rep_count - 1];
        for (unsigned k = 0; k < 9; ++k) {
            const auto from = bake::direction_of(std::numbers::pi * k / 4, k < 8 ? 0.1 : std::numbers::pi / 2);
            bake::FormPicture picture;
            picture.clear(bake::view_of(node.box, from, centre_, across_px));
            bake::draw_form(m, finest, picture);
            full_.push_back(std::move(picture));
        }
        full = geometry_of(m, finest, centre_);
    }

    /// One of the model's forms.
    [[nodiscard]] Form of_model(const model::Representation& rep) const {
        Form form;
        form.time_us = time_us(
            rep.triangles, rep.effects, pixels_of([&](const auto& use) {
                model::for_triangles(m_, rep, [&](const model::Material& material, const vec3& a, const vec3& b, const vec3& c) {
                    const mat3& linear = m_.placements[rep.placement].linear;
                    use(material, linear * a, linear * b, linear * c);
                });
            }));
        compare(form, [&](const bake::FormView& view) {
            bake::FormPicture picture;
            picture.clear(view);
            bake::draw_form(m_, rep, picture);
            return picture;
        });
        form.bound = static_cast<double>(rep.error_m) / node_.box.diagonal();
        return form;
    }
    /// A rival's form.
    [[nodiscard]] Form of_geometry(bake::Geometry g) const {
        Form form;
        model::EffectMask effects = 0;
        for (const bake::GeometryPart& part : g.parts) effects |= m_.materials[part.material].effects;
        form.time_us =
            time_us(g.triangles(), effects, pixels_of([&](const auto& use) {
                        for (const bake::GeometryPart& part : g.parts) {
                            for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3) {
                                const auto at = [&](std::size_t k) { return bake::position_of(g.vertices[part.indices[i + k]]); };
                                use(m_.materials[part.material], at(0), at(1), at(2));
                            }
                        }
                    }));
        compare(form, [&](bake::FormView view) {
            view.middle = dvec3(0.0);  // these vertices are about the centre
            bake::FormPicture picture;
            picture.clear(view);
            bake::draw_geometry(m_, g.vertices, g.parts, picture);
            return picture;
        });
        form.geometry = std::move(g);
        return form;
    }
    [[nodiscard]] double bound_of(const bake::Geometry& g) const {
        const bake::MeshSurface a(full.vertices, full.parts), b(g.vertices, g.parts);
        if (b.view().triangles() == 0) return 1.0;
        measure::DistanceLimits limits;
        limits.relative = 0.25F;
        limits.absolute = static_cast<float>(0.0005 * node_.box.diagonal());
        return static_cast<double>(measure::two_sided_distance(a.view(), b.view(), limits).upper) / node_.box.diagonal();
    }
    bake::Geometry full;

private:
    /// Rasterised pixels, mean of all views, overdraw included.
    template <class Each>
    [[nodiscard]] double pixels_of(const Each& each) const {
        double sum = 0;
        each([&](const model::Material& material, const vec3& a, const vec3& b, const vec3& c) {
            const dvec3 area = 0.5 * dvec3(glm::cross(b - a, c - a));
            for (const bake::FormPicture& seen : full_)
                sum += (material.two_sided ? 1.0 : 0.5) * std::abs(glm::dot(area, dvec3(seen.view.direction.towards))) *
                       std::ldexp(1.0, -2 * seen.view.exponent);
        });
        return sum / static_cast<double>(full_.size());
    }
    [[nodiscard]] double time_us(std::size_t triangles, model::EffectMask effects, double pixels) const {
        const model::ItemCost cost =
            costs_.item(static_cast<float>(triangles), static_cast<float>(pixels), costs_.grid_for(effects));
        return static_cast<double>(costs_.combine.frame_us(cost.submit_us, cost.raster_us) - costs_.combine.fixed_us);
    }
    template <class Draw>
    void compare(Form& form, const Draw& draw) const {
        double squares = 0, either = 0, one = 0, covered = 0;
        for (const bake::FormPicture& seen : full_) {
            const bake::FormPicture own = draw(seen.view);
            for (std::size_t i = 0; i < seen.samples.size(); ++i) {
                const bake::FormSample &a = seen.samples[i], &b = own.samples[i];
                covered += a.covered() ? 1 : 0;
                if (!a.covered() && !b.covered()) continue;
                either += 1;
                one += a.covered() != b.covered() ? 1 : 0;
                for (std::size_t k = 0; k < 3; ++k) {
                    const auto colour = [&](const bake::FormSample& s) {
                        return s.covered() ? s.rgb[1][k] / 255.0 : static_cast<double>(model::usual_sky[k]);
                    };
                    squares += std::pow(colour(a) - colour(b), 2) / 3;
                }
            }
        }
        form.squared_error = squares / std::max(either, 1.0);
        form.outline = one / std::max(covered, 1.0);
    }

    const model::Model& m_;
    const model::Node& node_;
    const model::CostModel& costs_;
    dvec3 centre_;
    std::vector<bake::FormPicture> full_;
};

/// What the methods use within each share of full detail's time.
using Used = std::array<std::array<Form, methods>, shares.size()>;

Used compare_methods(const model::Model& m, const model::Node& node, const model::CostModel& costs) {
    const Judge judge(m, node, costs);
    std::array<std::vector<Form>, methods> forms;
    const model::Index end = node.first_rep + node.rep_count;
    for (model::Index r = node.first_rep; r < end; ++r) {
        forms[ours].push_back(judge.of_model(m.reps[r]));
        forms[ours].back().whole = r + 1 == end;
    }
    const double full_us = forms[ours].back().time_us;
    const bake::Geometry joined = welded(judge.full);
    for (double share = 0.75; share * static_cast<double>(judge.full.triangles()) >= 4; share *= 0.75) {
        forms[quadrics].push_back(judge.of_geometry(collapsed(judge.full, share)));
        forms[quadrics].push_back(judge.of_geometry(collapsed(joined, share)));
        forms[clustering].push_back(judge.of_geometry(clustered(judge.full, share)));
        forms[thinning].push_back(judge.of_geometry(thinned(judge.full, share)));
    }
    Form nothing = judge.of_geometry({});
    nothing.bound = 1;
    nothing.missing = true;
    Used used;
    for (std::size_t s = 0; s < shares.size(); ++s) {
        for (std::size_t method = 0; method < methods; ++method) {
            Form* best = nullptr;
            for (Form& form : forms[method])
                if (!form.whole && form.time_us <= shares[s] * full_us &&
                    (best == nullptr || form.squared_error < best->squared_error))
                    best = &form;
            if (best != nullptr && best->bound < 0) best->bound = judge.bound_of(best->geometry);
            used[s][method] = best != nullptr ? *best : nothing;
            used[s][method].geometry = {};
        }
    }
    return used;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return fmt::print(stderr, "bench_methods MODEL.walk [MESHES]\n"), 2;
    auto m = model::read_walk(argv[1]);
    if (!m) return fmt::print(stderr, "{}\n", m.error().text()), 1;
    const long meshes = argc > 2 ? std::max(1L, std::atol(argv[2])) : 60;
    const std::vector<model::Index> leaves = bake::distinct_leaves(*m, static_cast<std::size_t>(meshes), min_triangles);
    if (leaves.empty())
        return fmt::print(stderr, "bench_methods: no mesh has {} triangles and a coarser form\n", min_triangles), 1;
    const model::CostModel costs = model::default_costs();
    std::vector<Used> used(leaves.size());
    std::atomic<std::size_t> next{0};
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < std::max(1U, std::thread::hardware_concurrency()); ++t)
        threads.emplace_back([&] {
            for (std::size_t i = next++; i < leaves.size(); i = next++) used[i] = compare_methods(*m, m->nodes[leaves[i]], costs);
        });
    for (std::thread& thread : threads) thread.join();
    std::string out = fmt::format("{{\"meshes\": {}", leaves.size());
    for (std::size_t method = 0; method < methods; ++method) {
        out += fmt::format(", \"{}\": {{", method_names[method]);
        for (std::size_t s = 0; s < shares.size(); ++s) {
            double squares = 0, outline = 0, missing = 0;
            std::vector<double> bounds;
            for (const Used& of_leaf : used) {
                squares += of_leaf[s][method].squared_error;
                outline += of_leaf[s][method].outline;
                missing += of_leaf[s][method].missing ? 1 : 0;
                bounds.push_back(of_leaf[s][method].bound);
            }
            std::sort(bounds.begin(), bounds.end());
            const auto count = static_cast<double>(used.size());
            out += fmt::format(
                "{}\"at_{:.0f}\": {{\"psnr_db\": {:.2f}, \"outline_percent\": {:.1f}, \"bound_percent\": {:.2f}, \"missing\": "
                "{}}}",
                s == 0 ? "" : ", ", 100 * shares[s], -10 * std::log10(std::max(squares / count, 1e-13)), 100 * outline / count,
                100 * bounds[bounds.size() / 2], missing);
        }
        out += "}";
    }
    fmt::print("{}}}\n", out);
    return 0;
}
