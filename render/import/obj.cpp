// Wavefront OBJ to a Scene: a node and mesh an object or group, a primitive a material, corners shared.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <unordered_map>

#include <fmt/format.h>

#include "render/image/image.hpp"
#include "render/import/corner_map.hpp"
#include "render/import/finish.hpp"
#include "render/import/obj_material.hpp"
#include "render/import/polygon.hpp"
#include "render/import/text_cursor.hpp"
#include "rt/base/file.hpp"

namespace surefoot::importer {
namespace {

/// Faces are collected with positions still in double; a mesh far from the origin gets its own (map coordinates would
/// lose centimetres in float).
struct Collected {
    Index material = none;
    CornerMap corners;
    std::vector<Corner> vertices;
    std::vector<std::uint32_t> indices;
};

struct Group {
    std::string name;
    std::vector<Collected> parts;  ///< one a material
    std::unordered_map<Index, std::size_t> part_of_material;
};

struct Skipped {
    std::uint64_t count = 0, first_line = 0;
    void add(std::uint64_t line) {
        if (count++ == 0) first_line = line;
    }
};

class ObjReader {
public:
    ObjReader(const std::string& file, const Progress& progress) : file_(file), progress_(progress) {}

    Result<Scene> read() {
        auto text = read_text(file_, 1ULL << 34U);
        if (!text) return text.error();
        if (auto parsed = parse(*text); !parsed) return parsed.error();
        text = std::string();
        make_meshes();
        warn_skipped();
        if (auto usable = finish(scene_, file_, progress_); !usable) return usable.error();
        return std::move(scene_);
    }

private:
    Error wrong(std::uint64_t line, std::string what) const {
        return {fmt::format("{}:{}", file_, line), std::move(what), "Export the model again", ErrorKind::damaged};
    }

    Result<void> parse(const std::string& text) {
        std::uint64_t statements = 0;
        for (TextCursor cursor(text); !cursor.done(); cursor.next_line()) {
            if (cursor.at_line_end()) continue;
            if (auto read = statement(cursor); !read) return read;
            if (++statements % 65536 != 0) continue;
            if (progress_.stopped()) return Error{file_, "The import was stopped", "", ErrorKind::stopped};
            progress_.update("import", 1.0 - static_cast<double>(cursor.rest().size()) / static_cast<double>(text.size()));
        }
        return {};
    }

    Result<void> statement(TextCursor& cursor) {
        const std::uint64_t line = cursor.line();
        const std::string_view key = cursor.word();
        if (key == "v") return position(cursor, line);
        if (key == "f") return face(cursor, line);
        if (key == "vn") return vector(cursor, line, normals_);
        if (key == "vt") return coordinate(cursor, line);
        if (key == "o") {
            object_ = cursor.line_text();
            group_of_name_.clear();  // two objects of one name are two objects; groups of one name within it are one
            group_name_.clear();
            group_ = none;
        } else if (key == "g") {
            group_name_ = cursor.line_text();
            group_ = none;
        } else if (key == "usemtl") {
            use_material(std::string(cursor.line_text()));
        } else if (key == "mtllib") {
            library(std::string(cursor.line_text()));
        } else if (key == "p" || key == "l") {
            points_and_lines_.add(line);
        } else if (key != "s" && key != "vp") {
            unknown_.add(line);
        }
        return {};
    }

    Result<void> position(TextCursor& cursor, std::uint64_t line) {
        std::array<double, 8> n{};
        std::size_t count = 0;
        while (count < n.size() && !cursor.at_line_end()) {
            if (!cursor.number(n[count])) return wrong(line, fmt::format("The word '{}' is not a number", cursor.word()));
            ++count;
        }
        if (count < 3) return wrong(line, fmt::format("A position has only {} numbers", count));
        positions_.emplace_back(n[0], n[1], n[2]);
        // v x y z [w] [r g b]: six or seven numbers end with a colour.
        if (count >= 6) {
            colours_.resize(positions_.size() - 1, {255, 255, 255, 255});
            const std::size_t c = count == 7 ? 4 : 3;
            colours_.push_back({image::to_byte(static_cast<float>(n[c])), image::to_byte(static_cast<float>(n[c + 1])),
                                image::to_byte(static_cast<float>(n[c + 2])), 255});
        }
        return {};
    }

    Result<void> vector(TextCursor& cursor, std::uint64_t line, std::vector<vec3>& to) const {
        vec3 v(0);
        for (int i = 0; i < 3; ++i) {
            if (!cursor.number(v[i])) return wrong(line, "A normal has fewer than three numbers");
        }
        to.push_back(v);
        return {};
    }

    Result<void> coordinate(TextCursor& cursor, std::uint64_t line) {
        vec2 uv(0);
        if (!cursor.number(uv.x)) return wrong(line, "A texture coordinate has no number");
        (void)cursor.number(uv.y);
        uvs_.emplace_back(uv.x, 1.0F - uv.y);  // OBJ counts from the picture's lower edge
        return {};
    }

    /// 1-based, or negative from the end; `none` where out of range.
    static std::uint32_t resolve(std::int64_t index, std::size_t size) {
        const std::int64_t at = index > 0 ? index - 1 : static_cast<std::int64_t>(size) + index;
        return index == 0 || at < 0 || at >= static_cast<std::int64_t>(size) ? none : static_cast<std::uint32_t>(at);
    }

    /// v, v/vt, v//vn or v/vt/vn; an empty vt or vn counts as not given, and so, noted, does a wrong one. False: no position
    /// there.
    bool corner(TextCursor& cursor, std::uint64_t line, Corner& corner) {
        std::int64_t index = 0;
        corner = {none, none, none};
        if (!cursor.integer(index)) return false;
        corner.position = resolve(index, positions_.size());
        if (cursor.take('/')) {
            bool wrong = false;
            if (cursor.integer(index)) wrong = (corner.uv = resolve(index, uvs_.size())) == none;
            if (cursor.take('/') && cursor.integer(index)) wrong |= (corner.normal = resolve(index, normals_.size())) == none;
            if (wrong) bad_corners_.add(line);
        }
        return corner.position != none;
    }

    Result<void> face(TextCursor& cursor, std::uint64_t line) {
        polygon_.clear();
        while (!cursor.at_line_end()) {
            Corner c{};
            if (!corner(cursor, line, c)) {
                bad_faces_.add(line);
                lost_.add(line);
                return {};
            }
            if (!cursor.at_word_end()) return wrong(line, "A corner of a face is none of v, v/vt, v//vn, v/vt/vn");
            polygon_.push_back(c);
        }
        if (polygon_.size() < 3) {
            bad_faces_.add(line);
            return {};
        }
        add_polygon(line);
        return {};
    }

    void add_polygon(std::uint64_t line) {
        Collected& part = current_part();
        triples_.clear();
        if (polygon_.size() == 3) {
            triples_ = {0, 1, 2};
        } else {
            outline_.clear();
            for (const Corner& c : polygon_) outline_.push_back(positions_[c.position]);
            if (!triangulate(outline_, triples_)) crossing_.add(line);
        }
        for (const std::uint32_t i : triples_) {
            const auto next = static_cast<std::uint32_t>(part.vertices.size());
            const std::uint32_t vertex = part.corners.find_or_add(polygon_[i], next);
            if (vertex == next) part.vertices.push_back(polygon_[i]);
            part.indices.push_back(vertex);
        }
    }

    Collected& current_part() {
        if (group_ == none) {
            const std::string name = object_.empty() ? group_name_ : group_name_.empty() ? object_ : object_ + "/" + group_name_;
            const auto [found, added] = group_of_name_.try_emplace(name, static_cast<Index>(groups_.size()));
            if (added) groups_.push_back(Group{name.empty() ? "object" : name, {}, {}});
            group_ = found->second;
        }
        Group& group = groups_[group_];
        const auto [found, added] = group.part_of_material.try_emplace(material_, group.parts.size());
        if (added) group.parts.push_back(Collected{material_, {}, {}, {}});
        return group.parts[found->second];
    }

    /// One name, which may have spaces in it; or several.
    void library(const std::string& names) {
        std::error_code ignored;
        if (std::filesystem::exists(place_beside(file_, names), ignored) || names.find(' ') == std::string::npos)
            return one_library(names);
        for (TextCursor cursor(names); !cursor.at_line_end();) one_library(std::string(cursor.word()));
    }

    void one_library(const std::string& name) {
        const std::size_t before = scene_.materials.size();
        if (const std::string lack = read_mtl(file_, name, scene_); !lack.empty()) library_lack_ = lack;
        for (std::size_t i = before; i < scene_.materials.size(); ++i)
            material_of_name_.try_emplace(scene_.materials[i].name, static_cast<Index>(i));
    }

    /// One that no library has is white: damage where a library is missing, usual where none was named.
    void use_material(const std::string& name) {
        const auto [found, added] = material_of_name_.try_emplace(name, static_cast<Index>(scene_.materials.size()));
        if (added) {
            scene_.materials.push_back(Material{.name = name, .two_sided = true});
            if (!library_lack_.empty()) scene_.materials.back().lacks.push_back(library_lack_);
        }
        material_ = found->second;
    }

    void make_meshes() {
        for (Group& group : groups_) {
            Node node;
            node.name = group.name;
            node.mesh = static_cast<Index>(scene_.meshes.size());
            const dvec3 origin = origin_of(group);
            node.world[3] = dvec4(origin, 1.0);
            Mesh mesh;
            mesh.name = group.name;
            for (Collected& part : group.parts) mesh.primitives.push_back(primitive(part, origin));
            scene_.meshes.push_back(std::move(mesh));
            scene_.nodes.push_back(std::move(node));
            group = Group{};
        }
    }

    /// Whole metres, and only where the object is far from the origin compared to its size.
    dvec3 origin_of(const Group& group) const {
        Box box;
        for (const Collected& part : group.parts) {
            for (const Corner& c : part.vertices) {
                if (const dvec3& p = positions_[c.position]; std::isfinite(p.x + p.y + p.z)) box.grow(p);
            }
        }
        if (box.empty() || glm::length(box.centre()) < 1000.0 || glm::length(box.centre()) < 8.0 * box.diagonal())
            return dvec3(0);
        return glm::round(box.centre());
    }

    Primitive primitive(Collected& part, const dvec3& origin) {
        Primitive to;
        if (part.material == none) part.material = plain_material();
        to.material = part.material;
        const auto any = [&](auto member) {
            return std::any_of(part.vertices.begin(), part.vertices.end(), [&](const Corner& c) { return c.*member != none; });
        };
        const bool with_uv = any(&Corner::uv), with_normal = any(&Corner::normal);
        for (const Corner& c : part.vertices) {
            to.positions.emplace_back(positions_[c.position] - origin);
            if (with_uv) to.uvs.push_back(c.uv == none ? vec2(0) : uvs_[c.uv]);
            if (with_normal) to.normals.push_back(c.normal == none ? vec3(0) : normals_[c.normal]);
            if (!colours_.empty())
                to.colours.push_back(c.position < colours_.size() ? colours_[c.position]
                                                                  : std::array<std::uint8_t, 4>{255, 255, 255, 255});
        }
        to.indices = std::move(part.indices);
        part = Collected{};
        return to;
    }

    Index plain_material() {
        const auto [found, added] = material_of_name_.try_emplace("", static_cast<Index>(scene_.materials.size()));
        if (added) scene_.materials.push_back(Material{.name = "default", .two_sided = true});
        return found->second;
    }

    void warn_skipped() {
        const auto text = [](const Skipped& skipped, const char* one, const char* more) {
            return fmt::format("{} {} (first in line {})", skipped.count, skipped.count == 1 ? one : more, skipped.first_line);
        };
        const auto warn = [&](const Skipped& skipped, const char* one, const char* more) {
            if (skipped.count > 0) scene_.warnings.push_back(text(skipped, one, more));
        };
        warn(bad_faces_, "face is dropped: index out of range, or fewer than three corners",
             "faces are dropped: index out of range, or fewer than three corners");
        // Loose edges are useless, not broken.
        if (lost_.count > 0)
            scene_.damage.push_back(
                {file_, text(lost_, "face is dropped: index out of range", "faces are dropped: index out of range")});
        if (bad_corners_.count > 0)
            scene_.damaged(text(bad_corners_, "face names a texture coordinate or normal that does not exist",
                                "faces name a texture coordinate or normal that does not exist"));
        warn(crossing_, "polygon crosses itself, so triangles may overlap",
             "polygons cross themselves, so triangles may overlap");
        warn(points_and_lines_, "point or line is dropped", "points or lines are dropped");
        warn(unknown_, "statement is not understood", "statements are not understood");
    }

    const std::string& file_;
    const Progress& progress_;
    Scene scene_;
    std::vector<dvec3> positions_;
    std::vector<std::array<std::uint8_t, 4>> colours_;  ///< empty, or filled up to the last coloured position
    std::vector<vec3> normals_;
    std::vector<vec2> uvs_;
    std::vector<Group> groups_;
    std::unordered_map<std::string, Index> group_of_name_, material_of_name_;
    std::string object_, group_name_;
    Index group_ = none, material_ = none;
    std::vector<Corner> polygon_;
    std::vector<dvec3> outline_;
    std::vector<std::uint32_t> triples_;
    Skipped bad_faces_, lost_, bad_corners_, crossing_, points_and_lines_, unknown_;
    std::string library_lack_;  ///< of the last library that could not be read
};

}  // namespace

Result<Scene> import_obj(const std::string& file, const Progress& progress) { return ObjReader(file, progress).read(); }

}  // namespace surefoot::importer
