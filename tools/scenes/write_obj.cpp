// A scene as Wavefront OBJ: every instance written out in the world, materials and pictures beside the file.
#include <array>
#include <charconv>
#include <filesystem>

#include <fmt/format.h>

#include "rt/base/file.hpp"
#include "tools/scenes/writers.hpp"

namespace surefoot::scenes {
namespace {

using importer::none;

std::string plain(const std::string& name) {
    std::string out;
    for (const char c : name) out += static_cast<unsigned char>(c) <= ' ' ? '_' : c;
    return out;
}

class ObjWriter {
public:
    ObjWriter(const std::string& file, const importer::Scene& scene, AtomicFile& out) : file_(file), scene_(scene), out_(out) {}

    Result<void> run() {
        const std::filesystem::path path(file_);
        const std::string stem = path.stem().string();
        fmt::format_to(std::back_inserter(text_), "mtllib {}.mtl\n", stem);
        for (const importer::Node& node : scene_.nodes) {
            if (node.mesh == none) continue;
            fmt::format_to(std::back_inserter(text_), "o {}\n", plain(node.name));
            for (const importer::Primitive& p : scene_.meshes[node.mesh].primitives) {
                if (auto done = primitive(p, node.world); !done) return done;
            }
        }
        if (auto done = out_.write(text_); !done) return done;
        // The library last, small beside the geometry: a full disk shows before anything that was there is replaced.
        return library((path.parent_path() / stem).string(), stem);
    }

private:
    Result<void> library(const std::string& base, const std::string& stem) {
        std::string mtl;
        for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
            const importer::Material& m = scene_.materials[i];
            fmt::format_to(std::back_inserter(mtl), "newmtl m{}_{}\nKd {} {} {}\nd {}\n", i, plain(m.name), m.colour[0],
                           m.colour[1], m.colour[2], m.colour[3]);
            if (m.image != none) fmt::format_to(std::back_inserter(mtl), "map_Kd {}_{}.png\n", stem, m.image);
        }
        for (std::size_t i = 0; i < scene_.images.size(); ++i) {
            const image::Image& image = scene_.images[i];
            if (auto done = image::write_png(fmt::format("{}_{}.png", base, i), image.width, image.height, image.rgba); !done)
                return done;
        }
        return write_text(base + ".mtl", mtl);
    }

    void number(double value, char after) {
        std::array<char, 40> buffer{};
        const auto end =
            std::to_chars(buffer.data(), buffer.data() + buffer.size(), value == 0.0 ? 0.0 : value, std::chars_format::general, 9)
                .ptr;
        text_.append(buffer.data(), end);
        text_ += after;
    }

    void vertices(const importer::Primitive& p, const dmat4& world) {
        const dmat3 normals = glm::transpose(glm::inverse(dmat3(world)));
        for (std::size_t i = 0; i < p.positions.size(); ++i) {
            const dvec3 v = world * dvec4(p.positions[i], 1.0);
            const dvec3 n = glm::normalize(normals * dvec3(p.normals[i]));
            text_ += "v ";
            number(v.x, ' ');
            number(v.y, ' ');
            number(v.z, p.colours.empty() ? '\n' : ' ');
            if (!p.colours.empty()) {
                number(p.colours[i][0] / 255.0, ' ');
                number(p.colours[i][1] / 255.0, ' ');
                number(p.colours[i][2] / 255.0, '\n');
            }
            text_ += "vn ";
            number(n.x, ' ');
            number(n.y, ' ');
            number(n.z, '\n');
            text_ += "vt ";
            number(p.uvs.empty() ? 0.0 : p.uvs[i].x, ' ');
            number(p.uvs.empty() ? 0.0 : 1.0 - p.uvs[i].y, '\n');
        }
    }

    Result<void> primitive(const importer::Primitive& p, const dmat4& world) {
        fmt::format_to(std::back_inserter(text_), "usemtl m{}_{}\n", p.material, plain(scene_.materials[p.material].name));
        vertices(p, world);
        const bool mirrored = glm::determinant(dmat3(world)) < 0;
        for (std::size_t i = 0; i + 3 <= p.indices.size(); i += 3) {
            const std::uint64_t a = base_ + p.indices[i], b = base_ + p.indices[i + (mirrored ? 2 : 1)],
                                c = base_ + p.indices[i + (mirrored ? 1 : 2)];
            fmt::format_to(std::back_inserter(text_), "f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", a, b, c);
        }
        base_ += p.positions.size();
        if (text_.size() < (1U << 20U)) return {};
        auto done = out_.write(text_);
        text_.clear();
        return done;
    }

    const std::string& file_;
    const importer::Scene& scene_;
    AtomicFile& out_;
    std::string text_;
    std::uint64_t base_ = 1;
};

}  // namespace

Result<void> write_obj(const std::string& file, const importer::Scene& scene) {
    auto out = AtomicFile::create(file);
    if (!out) return out.error();
    if (auto done = ObjWriter(file, scene, *out).run(); !done) return done;
    return out->commit();
}

}  // namespace surefoot::scenes
