// A Scene as OSTF: containers for nodes, one leaf a primitive in world coordinates, pictures as PNG beside the file.
#include <array>
#include <charconv>
#include <filesystem>

#include <fmt/format.h>

#include "render/import/ostf.hpp"
#include "rt/base/file.hpp"

namespace surefoot::importer {
namespace {

constexpr std::size_t flush_bytes = 1U << 20U;
/// Digits of a number: a tenth of a millimetre on a map 100 km wide, more than float holds elsewhere.
constexpr int digits = 9;

class Writer {
public:
    Writer(const std::string& file, const Scene& scene, const Progress& progress, AtomicFile& out)
        : file_(file), scene_(scene), progress_(progress), out_(out) {}

    Result<void> run() {
        children_.resize(scene_.nodes.size());
        std::vector<Index> roots;
        for (std::size_t i = 0; i < scene_.nodes.size(); ++i) {
            const Index parent = scene_.nodes[i].parent;
            (parent == none ? roots : children_[parent]).push_back(static_cast<Index>(i));
        }
        mark_used();
        for (const Index root : roots) {
            if (auto done = tree(root); !done) return done;
        }
        if (auto done = out_.write(text_); !done) return done;
        return {};
    }

private:
    /// Branches without triangles are left out: an object of count 0 must hold objects.
    void mark_used() {
        used_.assign(scene_.nodes.size(), false);
        for (std::size_t i = scene_.nodes.size(); i-- > 0;) {
            if (scene_.nodes[i].mesh != none) used_[i] = true;
            if (used_[i] && scene_.nodes[i].parent != none) used_[scene_.nodes[i].parent] = true;
        }
    }

    Result<void> tree(Index root) {
        struct Open {
            Index node;
            std::size_t next;
        };
        std::vector<Open> stack;
        const auto enter = [&](Index node) -> Result<void> {
            if (!used_[node]) return {};
            begin(scene_.nodes[node].name, 0, "");
            stack.push_back({node, 0});
            return leaves(node);
        };
        if (auto done = enter(root); !done) return done;
        while (!stack.empty()) {
            Open& top = stack.back();
            if (top.next == children_[top.node].size()) {
                text_ += "END_TAG\n";
                stack.pop_back();
                progress_.update("write", static_cast<double>(++written_) / static_cast<double>(scene_.nodes.size()));
            } else if (auto done = enter(children_[top.node][top.next++]); !done) {
                return done;
            }
        }
        return {};
    }

    void begin(const std::string& name, std::uint64_t triangles, const std::string& texture) {
        std::string plain;
        for (const char c : name) plain += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
        if (plain.find_first_not_of(' ') == std::string::npos) plain = "object";
        fmt::format_to(std::back_inserter(text_), "START_TAG\n{}\n{}\n", plain, triangles);
        if (triangles > 0 || !texture.empty()) text_ += texture + "\n";
    }

    Result<void> leaves(Index node) {
        if (scene_.nodes[node].mesh == none) return {};
        const Mesh& mesh = scene_.meshes[scene_.nodes[node].mesh];
        for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
            const Primitive& p = mesh.primitives[i];
            auto texture = texture_of(p.material);
            if (!texture) return texture.error();
            begin(fmt::format("{}.{}", scene_.nodes[node].name, i), p.indices.size() / 3, *texture);
            if (auto done = triangles(p, scene_.nodes[node].world); !done) return done;
            text_ += "END_TAG\n";
        }
        return {};
    }

    Result<std::string> texture_of(Index material) {
        const Index image = scene_.materials[material].image;
        if (image == none) return std::string();
        const std::filesystem::path path(file_);
        const std::string name = fmt::format("{}_{}.png", path.stem().string(), image);
        textures_.resize(scene_.images.size());
        if (!textures_[image]) {
            const image::Image& from = scene_.images[image];
            if (auto done = image::write_png((path.parent_path() / name).string(), from.width, from.height, from.rgba); !done)
                return done.error();
            textures_[image] = true;
        }
        return name;
    }

    void number(double value, char after) {
        std::array<char, 40> buffer{};
        const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value == 0.0 ? 0.0 : value,
                                       std::chars_format::general, digits)
                             .ptr;
        text_.append(buffer.data(), end);
        text_ += after;
    }
    void vector(const dvec3& v) {
        number(v.x, ' ');
        number(v.y, ' ');
        number(v.z, '\n');
    }

    void vertex(const Primitive& p, std::uint32_t i, const dmat4& world, const dmat3& normals) {
        vector(p.normals.empty() ? dvec3(0) : glm::normalize(normals * dvec3(p.normals[i])));
        vector(dvec3(world * dvec4(p.positions[i], 1.0)));
        const Material& material = scene_.materials[p.material];
        dvec3 colour(material.colour[0], material.colour[1], material.colour[2]);
        if (!p.colours.empty()) colour *= dvec3(p.colours[i][0], p.colours[i][1], p.colours[i][2]) / 255.0;
        vector(colour);
        number(p.uvs.empty() ? 0.0 : p.uvs[i].x, ' ');
        number(p.uvs.empty() ? 0.0 : 1.0 - p.uvs[i].y, '\n');
    }

    Result<void> triangles(const Primitive& p, const dmat4& world) {
        const dmat3 linear(world);
        const bool mirrored = glm::determinant(linear) < 0;
        const dmat3 normals = glm::transpose(glm::inverse(linear));
        for (std::size_t i = 0; i + 3 <= p.indices.size(); i += 3) {
            for (const std::size_t k :
                 {std::size_t{0}, mirrored ? std::size_t{2} : std::size_t{1}, mirrored ? std::size_t{1} : std::size_t{2}}) {
                vertex(p, p.indices[i + k], world, normals);
            }
            if (text_.size() < flush_bytes) continue;
            if (progress_.stopped()) return Error{file_, "The writing was stopped", "", ErrorKind::stopped};
            if (auto done = out_.write(text_); !done) return done;
            text_.clear();
        }
        return {};
    }

    const std::string& file_;
    const Scene& scene_;
    const Progress& progress_;
    AtomicFile& out_;
    std::string text_;
    std::vector<std::vector<Index>> children_;
    std::vector<bool> used_, textures_;
    std::uint64_t written_ = 0;
};

}  // namespace

Result<void> write_ostf(const std::string& file, const Scene& scene, const Progress& progress) {
    auto out = AtomicFile::create(file);
    if (!out) return out.error();
    if (auto done = Writer(file, scene, progress, *out).run(); !done) return done;
    return out->commit();
}

}  // namespace surefoot::importer
