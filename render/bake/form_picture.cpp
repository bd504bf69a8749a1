// One triangle after the other into a depth buffer. Colours are those of the effects: material, vertex, sun and sky, texture.
#include "render/bake/form_picture.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "render/effects/surface_light.hpp"
#include "render/model/daylight.hpp"

namespace surefoot::bake {

namespace {

constexpr std::uint32_t max_side = 576;   // of 64 pixels across: a side reaches 1.1 * 4 * 64 samples and one to both sides
constexpr int level_octaves = 3;          // between two levels of a picture
constexpr float max_rounded_px = 1e4F;    // of twice a triangle's area
constexpr int max_octaves = 12;           // what is finer has hardly a sample
constexpr std::uint32_t few_columns = 6;  // so many samples are tried sooner than their row's ends are found

/// 0..1, evenly spread over 4 x 4 samples of the grid and the same in every picture: equal glass looks equal in two forms.
float threshold_of(std::int64_t x, std::int64_t y) {
    constexpr std::array<std::uint8_t, 16> order = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
    return (static_cast<float>(order[static_cast<std::size_t>((y & 3) * 4 + (x & 3))]) + 0.5F) / 16.0F;
}

/// 0..1, without order, and the same in every picture.
float chance_of(std::int64_t x, std::int64_t y) {
    std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9e3779b1U ^ static_cast<std::uint32_t>(y) * 0x85ebca77U;
    h = (h ^ h >> 15U) * 0x2c1b3c6dU;
    h = (h ^ h >> 12U) * 0x297a2d39U;
    return static_cast<float>((h ^ h >> 15U) >> 8U) / static_cast<float>(1U << 24U);
}

/// By what a vertex of a box's face is lit in the model's own light, as all vertices of that face.
vec3 light_of_picture(const model::Model& model, model::Index vertex) {
    const model::Vertex& v = model.vertices[vertex];
    effects::PictureLight light{{v.hidden[0], v.hidden[1], v.hidden[2], 0}, model.sun_seen[vertex], {}};
    return effects::light_on_picture(light, model::daylight_of_model(model.sun_direction, model.light));
}

/// The mip level with about one texel a pixel.
struct Texels {
    const std::byte* first = nullptr;
    std::uint32_t width = 1, height = 1;
    bool clamp = false;

    Texels() = default;
    Texels(const model::Model& model, const model::Texture& texture, float texels_a_pixel) {
        width = texture.width;
        height = texture.height;
        clamp = texture.clamp;
        std::uint64_t at = texture.first_byte;
        for (std::uint32_t level = 0; level + 1 < texture.levels && texels_a_pixel > 2.0F; ++level, texels_a_pixel *= 0.25F) {
            at += static_cast<std::uint64_t>(width) * height * 4;
            width = std::max(1U, width / 2);
            height = std::max(1U, height / 2);
        }
        first = model.texels.data() + at;
    }
    [[nodiscard]] std::size_t place(float uv, std::uint32_t size) const {
        const float inside = clamp ? std::clamp(uv, 0.0F, 1.0F) : uv - std::floor(uv);
        return inside > 0.0F ? std::min(size - 1, static_cast<std::uint32_t>(inside * static_cast<float>(size))) : 0;  // NaN: 0
    }
    [[nodiscard]] vec4 at(const vec2& uv) const {
        const std::byte* c = first + (place(uv.y, height) * width + place(uv.x, width)) * 4;
        return vec4(std::to_integer<int>(c[0]), std::to_integer<int>(c[1]), std::to_integer<int>(c[2]),
                    std::to_integer<int>(c[3])) /
               255.0F;
    }
};

float cross(const vec2& a, const vec2& b) { return a.x * b.y - a.y * b.x; }

/// Columns, from and to, that hold all samples of a row in a triangle, and one or two more on each side. Only for triangles below
/// max_rounded_px: weights of larger ones are rounded by more than that.
glm::uvec2 columns_of(const std::array<vec2, 3>& corners, float y, const glm::uvec2& all) {
    float left = 1e30F, right = -1e30F;
    for (std::size_t k = 0; k < 3; ++k) {
        const vec2 &p = corners[k], &q = corners[(k + 1) % 3];
        if (std::min(p.y, q.y) > y + 0.01F || std::max(p.y, q.y) < y - 0.01F) continue;
        const float rise = q.y - p.y;
        const bool level = std::abs(rise) <= 1e-3F;  // both of its ends count
        const float t = level ? 0.0F : std::clamp((y - p.y) / rise, 0.0F, 1.0F);
        const float from_x = p.x + t * (q.x - p.x), to_x = level ? q.x : from_x;
        left = std::min({left, from_x, to_x});
        right = std::max({right, from_x, to_x});
    }
    const float from = std::max(static_cast<float>(all.x), std::floor(left) - 1.0F);
    const float to = std::min(static_cast<float>(all.y), std::ceil(right) + 2.0F);
    return from < to ? glm::uvec2(from, to) : glm::uvec2(all.x, all.x);
}

vec2 uv_of(const model::Vertex& v) { return {v.uv[0], v.uv[1]}; }

std::array<std::uint8_t, 3> bytes_of(const vec4& colour) {
    const vec4 scaled = glm::clamp(colour, 0.0F, 1.0F) * 255.0F + 0.5F;
    return {static_cast<std::uint8_t>(scaled.r), static_cast<std::uint8_t>(scaled.g), static_cast<std::uint8_t>(scaled.b)};
}

/// One part of a form, as the view sees it.
struct Painter {
    const model::Model& model;
    const model::Material& material;
    FormPicture& picture;
    mat3 cofactor{1.0F};  ///< turns normals
    bool mirrored = false;
    bool own_vertices = false;  ///< the model's, which have shadows; not others that look like it

    struct Corner {
        vec3 at;  ///< pixels, pixels, metres towards the eye
        const model::Vertex* vertex;
    };
    /// What its samples are made from.
    struct Triangle {
        std::array<vec4, 3> colours;
        std::array<vec2, 3> uv;
        std::array<Texels, picture_levels> texels;
        std::array<SampleSource, 3> sources;
    };

    [[nodiscard]] model::Index index_of(const model::Vertex& v) const {
        return static_cast<model::Index>(&v - model.vertices.data());
    }
    /// Unit, in the world, and whether it was turned to the eye.
    [[nodiscard]] std::pair<vec3, bool> normal_of(const model::Vertex& v) const {
        vec3 n = cofactor * vec3(v.normal[0], v.normal[1], v.normal[2]);
        n *= (mirrored ? -1.0F : 1.0F) / std::sqrt(std::max(glm::dot(n, n), 1e-30F));
        const bool turned = material.two_sided && glm::dot(n, picture.view.direction.towards) < 0.0F;
        return {turned ? -n : n, turned};
    }
    /// Colours before the texture, 0 to about 1.
    [[nodiscard]] vec4 lit(const model::Vertex& v) const {
        vec4 colour(material.colour[0], material.colour[1], material.colour[2], material.colour[3]);
        if ((material.effects & model::effect_vertex_colour) != 0)
            colour *= vec4(v.colour[0], v.colour[1], v.colour[2], v.colour[3]) / 255.0F;
        if (picture.lit && own_vertices && (material.effects & model::effect_lit_picture) != 0)
            return {vec3(colour) * light_of_picture(model, index_of(v)), colour.a};
        constexpr model::EffectMask light = model::effect_sun | model::effect_openness;
        if (!picture.lit || (material.effects & light) == 0) return colour;
        const auto [n, turned] = normal_of(v);
        vec3 by_light(1.0F);
        if ((material.effects & model::effect_sun) != 0) {
            const vec3 sky = glm::mix(vec3(0.34F, 0.32F, 0.30F), vec3(0.52F, 0.56F, 0.62F), 0.5F * n.y + 0.5F);
            float sun = std::max(glm::dot(n, vec3(model.sun_direction)), 0.0F);
            if (own_vertices && (material.effects & model::effect_shadow) != 0)
                sun *= static_cast<float>(model.sun_seen[index_of(v)].share[0]) / 255.0F;
            by_light = sky + vec3(0.56F, 0.53F, 0.47F) * sun;
        }
        if ((material.effects & model::effect_openness) != 0) {
            const float sky = 1 - static_cast<float>(v.hidden[turned ? 1 : 0]) / 255.0F;
            const float near = 1 - static_cast<float>(v.hidden[turned ? 3 : 2]) / 255.0F;
            const vec3 room = vec3(0.98F, 0.95F, 0.91F) + (0.06F * n.x + 0.12F * n.y - 0.04F * n.z);
            by_light = glm::mix(room, by_light, std::min(1.0F, 4.0F * sky)) * (0.6F + 0.4F * near);
        }
        return {vec3(colour) * by_light, colour.a};
    }
    [[nodiscard]] bool textured() const { return (material.effects & model::effect_texture) != 0; }
    [[nodiscard]] Triangle triangle_of(const std::array<Corner, 3>& corners, float area) const;
    void draw(std::array<Corner, 3> corners) const;
    void fill(const std::array<Corner, 3>& corners, float area, const glm::uvec4& range) const;
    void put(const Triangle& triangle, const vec3& weights, float depth, std::uint32_t x, std::uint32_t y) const;
};

void Painter::draw(std::array<Corner, 3> corners) const {
    const vec2 a(corners[0].at), b(corners[1].at), c(corners[2].at);
    float area = cross(b - a, c - a);
    if (!(std::abs(area) > 1e-12F) || !std::isfinite(area)) return;
    if ((area > 0) == mirrored && !material.two_sided) return;
    if (area < 0) {
        std::swap(corners[1], corners[2]);
        area = -area;
    }
    const vec2 low = glm::min(glm::min(a, b), c), high = glm::max(glm::max(a, b), c);
    const vec2 size(picture.view.width, picture.view.height);
    const vec2 from = glm::ceil(glm::clamp(low, vec2(0), size)), to = glm::clamp(glm::floor(high) + 1.0F, vec2(0), size);
    if (from.x >= to.x || from.y >= to.y) return;
    fill(corners, area, {from.x, from.y, to.x, to.y});
}

Painter::Triangle Painter::triangle_of(const std::array<Corner, 3>& corners, float area) const {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) t.colours[k] = lit(*corners[k].vertex), t.uv[k] = uv_of(*corners[k].vertex);
    for (std::size_t k = 0; k < 3 && picture.keeps_sources && own_vertices; ++k)
        t.sources[k] = {index_of(*corners[k].vertex), 2 * static_cast<model::Index>(&material - model.materials.data()) +
                                                          (normal_of(*corners[k].vertex).second ? 1U : 0U)};
    if (textured()) {
        const model::Texture& texture = model.textures[material.texture];
        const float texels_a_pixel = std::abs(cross(t.uv[1] - t.uv[0], t.uv[2] - t.uv[0])) * static_cast<float>(texture.width) *
                                     static_cast<float>(texture.height) / area;
        float scale = std::ldexp(1.0F, -2 * level_octaves);
        for (Texels& texels : t.texels) {
            texels = Texels(model, texture, scale * texels_a_pixel);
            scale *= std::ldexp(1.0F, 2 * level_octaves);
        }
    }
    return t;
}

void Painter::fill(const std::array<Corner, 3>& corners, float area, const glm::uvec4& range) const {
    const vec2 a(corners[0].at), b(corners[1].at), c(corners[2].at);
    Triangle triangle;
    bool ready = false;
    const glm::uvec2 all(range.x, range.z);
    const bool few = range.z - range.x <= few_columns;
    for (std::uint32_t y = range.y; y < range.w; ++y) {
        const glm::uvec2 span = few || area >= max_rounded_px ? all : columns_of({a, b, c}, static_cast<float>(y), all);
        for (std::uint32_t x = span.x; x < span.y; ++x) {
            const vec2 p(static_cast<float>(x), static_cast<float>(y));
            const float wa = cross(c - b, p - b), wb = cross(a - c, p - c), wc = area - wa - wb;
            if (wa < 0 || wb < 0 || wc < 0) continue;
            const vec3 w = vec3(wa, wb, wc) / area;
            const float depth = w.x * corners[0].at.z + w.y * corners[1].at.z + w.z * corners[2].at.z;
            if (!(depth > picture.samples[static_cast<std::size_t>(y) * picture.view.width + x].depth)) continue;
            if (!ready) triangle = triangle_of(corners, area);  // most of the small triangles have no sample
            ready = true;
            put(triangle, w, depth, x, y);
        }
    }
}

void Painter::put(const Triangle& triangle, const vec3& w, float depth, std::uint32_t x, std::uint32_t y) const {
    const FormView& view = picture.view;
    FormSample& sample = picture.samples[static_cast<std::size_t>(y) * view.width + x];
    const vec4 plain = w.x * triangle.colours[0] + w.y * triangle.colours[1] + w.z * triangle.colours[2];
    const vec2 uv = w.x * triangle.uv[0] + w.y * triangle.uv[1] + w.z * triangle.uv[2];
    const auto colour_at = [&](std::size_t level) { return textured() ? plain * triangle.texels[level].at(uv) : plain; };
    std::array<vec4, picture_levels> colours{plain, colour_at(1), plain};
    const float alpha = colours[1].a;  // the other levels are not asked for in holes
    if (material.alpha == model::AlphaMode::mask && alpha < material.alpha_cutoff) return;
    if (material.alpha == model::AlphaMode::blend && alpha < threshold_of(view.left + x, view.low + y)) return;
    colours[0] = colour_at(0);
    colours[2] = colour_at(2);
    sample.depth = depth;
    sample.owner = picture.owner;
    for (std::size_t k = 0; k < picture_levels; ++k) sample.rgb[k] = bytes_of(colours[k]);
    if (!picture.keeps_sources) return;
    const float at = chance_of(view.left + x, view.low + y);
    picture.sources[static_cast<std::size_t>(y) * view.width + x] = triangle.sources[at < w.x ? 0 : at < w.x + w.y ? 1 : 2];
}

/// How finer levels of one picture make those of another, whose pixels are 2^octaves as large.
void mix_levels(const FormSample& from, int octaves, FormSample& to) {
    for (std::size_t k = 0; k < picture_levels; ++k) {
        const std::size_t a = std::min(k + static_cast<std::size_t>(octaves / level_octaves), picture_levels - 1);
        const std::size_t b = std::min(a + 1, picture_levels - 1);
        const int part = octaves % level_octaves;
        for (std::size_t c = 0; c < 3; ++c)
            to.rgb[k][c] =
                static_cast<std::uint8_t>((from.rgb[a][c] * (level_octaves - part) + from.rgb[b][c] * part) / level_octaves);
    }
}

}  // namespace

Direction direction_of(double azimuth_rad, double elevation_rad) {
    const double ce = std::cos(elevation_rad), se = std::sin(elevation_rad), ca = std::cos(azimuth_rad),
                 sa = std::sin(azimuth_rad);
    const vec3 towards(ce * sa, se, ce * ca), right(ca, 0, -sa);
    return {right, glm::cross(towards, right), towards};
}

FormView view_of(const Box& box, const Direction& direction, const dvec3& middle, std::uint32_t pixels) {
    FormView view{direction, middle};
    if (box.empty()) return view;
    const dvec3 half = box.half(), size = 2.0 * half, along = glm::abs(dvec3(direction.towards));
    const double across = glm::dot(glm::abs(dvec3(direction.right)), half), rise = glm::dot(glm::abs(dvec3(direction.up)), half);
    const double outline = along.x * size.y * size.z + along.y * size.z * size.x + along.z * size.x * size.y;
    // Something without an outline from here (a card from its edge) still has a length.
    const double wide = std::max(std::sqrt(std::max(outline, 0.0)), 0.25 * std::max(across, rise));
    if (!(wide > 1e-30) || !std::isfinite(wide)) return view;
    view.exponent = static_cast<int>(std::ceil(std::log2(wide / pixels)));
    const double pixel_m = std::ldexp(1.0, view.exponent);
    const dvec3 centre = box.centre() - middle;
    const auto range = [&](const vec3& axis, double extent, std::int64_t& first, std::uint32_t& count) {
        const double at = glm::dot(centre, dvec3(axis)) / pixel_m, reach = 1.1 * extent / pixel_m + 1.0;
        first = static_cast<std::int64_t>(std::ceil(at - reach));
        count = static_cast<std::uint32_t>(std::clamp(std::floor(at + reach) - std::ceil(at - reach) + 1.0, 1.0, 1.0 * max_side));
    };
    if (!(glm::length(centre) / pixel_m < 1e15)) return view;
    range(direction.right, across, view.left, view.width);
    range(direction.up, rise, view.low, view.height);
    return view;
}

void FormPicture::clear(const FormView& of, bool by_the_sun) {
    view = of;
    lit = by_the_sun;
    // Blocks are copied, because std::vector::assign takes five times as long: it stores a sample in pieces.
    static_assert(std::is_trivially_copyable_v<FormSample>);
    constexpr std::size_t block = 256;
    samples.resize(static_cast<std::size_t>(view.width) * view.height);
    std::fill_n(samples.begin(), std::min(block, samples.size()), FormSample{});
    for (std::size_t done = block; done < samples.size(); done += block)
        std::copy_n(samples.begin(), std::min(block, samples.size() - done), samples.begin() + static_cast<std::ptrdiff_t>(done));
    sources.assign(keeps_sources ? samples.size() : 0, {});
}

namespace {

/// From vertices to a picture's samples.
struct ToPicture {
    mat3 turned;
    vec3 origin;
    mat3 cofactor;
    bool mirrored = false;

    ToPicture(const FormView& view, const mat3& linear, const dvec3& at) : cofactor(cofactors(linear)) {
        const Direction& from = view.direction;
        const double pixel_m = std::ldexp(1.0, view.exponent);
        const mat3 to_view =
            glm::transpose(mat3(from.right / static_cast<float>(pixel_m), from.up / static_cast<float>(pixel_m), from.towards));
        turned = to_view * linear;
        const dvec3 away = at - view.middle;
        origin =
            vec3(glm::dot(away, dvec3(from.right)) / pixel_m - static_cast<double>(view.left),
                 glm::dot(away, dvec3(from.up)) / pixel_m - static_cast<double>(view.low), glm::dot(away, dvec3(from.towards)));
        mirrored = glm::dot(linear[0], cofactor[0]) < 0;
    }
    [[nodiscard]] Painter::Corner corner(const model::Vertex& v) const {
        return {turned * vec3(v.position[0], v.position[1], v.position[2]) + origin, &v};
    }
};

}  // namespace

void draw_form(const model::Model& model, const model::Representation& rep, FormPicture& picture) {
    if (picture.samples.empty()) return;
    const model::Placement& placement = model.placements[rep.placement];
    const ToPicture to(picture.view, placement.linear, placement.origin);
    for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
        const model::Part& part = model.parts[p];
        const Painter painter{model, model.materials[part.material], picture, to.cofactor, to.mirrored, true};
        const auto corner = [&](std::uint32_t i) {
            return to.corner(model.vertices[part.first_vertex + model.indices[part.first_index + i]]);
        };
        for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3) painter.draw({corner(i), corner(i + 1), corner(i + 2)});
    }
}

void draw_geometry(const model::Model& looks, const std::vector<model::Vertex>& vertices, const std::vector<GeometryPart>& parts,
                   FormPicture& picture) {
    if (picture.samples.empty()) return;
    const ToPicture to(picture.view, mat3(1.0F), dvec3(0.0));
    for (const GeometryPart& part : parts) {
        const Painter painter{looks, looks.materials[part.material], picture, to.cofactor, to.mirrored, false};
        const auto corner = [&](std::size_t i) { return to.corner(vertices[part.indices[i]]); };
        for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3) painter.draw({corner(i), corner(i + 1), corner(i + 2)});
    }
}

void draw_picture(const FormPicture& from, FormPicture& picture) {
    const FormView &a = from.view, &b = picture.view;
    const int octaves = b.exponent - a.exponent;
    if (from.samples.empty() || octaves < 0 || octaves > max_octaves) return;
    const std::int64_t ratio = std::int64_t{1} << octaves;
    for (std::uint32_t y = 0; y < b.height; ++y) {
        const std::int64_t ay = (b.low + y) * ratio - a.low;
        if (ay < 0 || ay >= a.height) continue;
        for (std::uint32_t x = 0; x < b.width; ++x) {
            const std::int64_t ax = (b.left + x) * ratio - a.left;
            if (ax < 0 || ax >= a.width) continue;
            const FormSample& seen = from.samples[static_cast<std::size_t>(ay * a.width + ax)];
            FormSample& sample = picture.samples[static_cast<std::size_t>(y) * b.width + x];
            if (!(seen.depth > sample.depth)) continue;
            sample.depth = seen.depth;
            sample.owner = seen.owner;
            mix_levels(seen, octaves, sample);
            if (picture.keeps_sources && from.keeps_sources)
                picture.sources[static_cast<std::size_t>(y) * b.width + x] =
                    from.sources[static_cast<std::size_t>(ay * a.width + ax)];
        }
    }
}

}  // namespace surefoot::bake
