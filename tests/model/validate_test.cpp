// validate(): one wrong thing at a time, and the error names the array and the element.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "tests/model/two_triangles.hpp"

namespace surefoot::model {
namespace {

TEST(Validate, AcceptsTheSmallestModel) {
    const auto valid = validate(two_triangles());
    EXPECT_TRUE(valid.ok()) << valid.error().text();
}

struct Wrong {
    const char* name;
    const char* place;
    std::function<void(Model&)> make;
};

class ValidateRefuses : public testing::TestWithParam<Wrong> {};

TEST_P(ValidateRefuses, AndNamesThePlace) {
    Model model = two_triangles();
    GetParam().make(model);
    const auto valid = validate(model);
    ASSERT_FALSE(valid.ok());
    EXPECT_EQ(valid.error().place, GetParam().place) << valid.error().text();
}

/// Small in a file, and yet 2^32 parts to draw: every representation draws all of them.
void share_parts(Model& m) {
    m.parts.assign(0x10000, m.parts[0]);
    Representation all = m.reps[3];
    all.part_count = all.triangles = 0x10000;
    m.reps.resize(0x10008, all);
}

void add_light(Model& m) {
    m.sun_seen.resize(m.vertices.size());
    m.lamp_light.resize(m.vertices.size());
}

/// The material and its forms need the effect, and its finding calls for it.
void call_for(Model& m, EffectMask effect) {
    m.materials[0].effects |= effect;
    for (Representation& rep : m.reps) rep.effects |= effect;
    for (EffectFinding& finding : m.effects) finding.called_for = finding.called_for || finding.bit == effect;
}

TEST(Validate, AcceptsLightAtEveryVertex) {
    Model model = two_triangles();
    add_light(model);
    call_for(model, effect_shadow);
    call_for(model, effect_lamps);
    const auto valid = validate(model);
    EXPECT_TRUE(valid.ok()) << valid.error().text();
}

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    OneWrongThing, ValidateRefuses,
    testing::Values(Wrong{"NoNodes", "nodes", [](Model& m) { m.nodes.clear(); }},
                    Wrong{"IndexBeyondVertices", "parts[0]", [](Model& m) { m.indices[2] = 3; }},
                    Wrong{"IndicesOverflow", "parts[0]", [](Model& m) { m.parts[0].first_index = 0xffffffffU; }},
                    Wrong{"NotTriples", "parts[0]", [](Model& m) { m.parts[0].index_count = 2; }},
                    Wrong{"MaterialOutOfRange", "parts[0]", [](Model& m) { m.parts[0].material = 1; }},
                    Wrong{"NanVertex", "vertices[2]", [](Model& m) { m.vertices[2].position[1] = nan; }},
                    Wrong{"FlatPlacement", "placements[0]", [](Model& m) { m.placements[0].linear[2] = vec3(0.0F); }},
                    Wrong{"TextureTooLarge", "textures[0]", [](Model& m) { m.textures[0].width = 0x7fffffffU; }},
                    Wrong{"TexelsMissing", "textures[0]", [](Model& m) { m.texels.pop_back(); }},
                    Wrong{"TooManyLevels", "textures[0]", [](Model& m) { m.textures[0].levels = 3; }},
                    Wrong{"TextureOutOfRange", "materials[0]", [](Model& m) { m.materials[0].texture = 9; }},
                    Wrong{"UnknownEffect", "materials[0]", [](Model& m) { m.materials[0].effects |= 1U << 20U; }},
                    Wrong{"SkyOnAMaterial", "materials[0]", [](Model& m) { call_for(m, effect_sky); }},
                    Wrong{"NegativeError", "reps[1]", [](Model& m) { m.reps[1].error_m = -1; }},
                    Wrong{"NanArea", "reps[2]", [](Model& m) { m.reps[2].area_m2[1] = nan; }},
                    Wrong{"WrongTriangles", "reps[2]", [](Model& m) { m.reps[2].triangles = 2; }},
                    Wrong{"PartsOutOfRange", "reps[3]", [](Model& m) { m.reps[3].part_count = 2; }},
                    Wrong{"ErrorsRise", "nodes[0]", [](Model& m) { m.reps[0].error_m = 1; }},
                    Wrong{"NothingEverywhere", "nodes[0]", [](Model& m) { m.reps[1].everywhere = false; }},
                    Wrong{"LeafOnlyFromAfar", "nodes[2]", [](Model& m) { m.reps[3].everywhere = false; }},
                    Wrong{"OwnParent", "nodes[1]", [](Model& m) { m.nodes[1].parent = 1; }},
                    Wrong{"ChildBeforeParent", "nodes[1]",
                          [](Model& m) { m.nodes[1].first_child = 1, m.nodes[1].child_count = 1; }},
                    Wrong{"ChildrenOverflow", "nodes[0]", [](Model& m) { m.nodes[0].child_count = 0xffffffffU; }},
                    Wrong{"OrphanNode", "nodes", [](Model& m) { m.nodes[0].child_count = 1; }},
                    Wrong{"ChildSticksOut", "nodes[2]", [](Model& m) { m.nodes[2].box.max.x = 5; }},
                    Wrong{"EmptyBox", "nodes[0]", [](Model& m) { m.nodes[0].box = {}; }},
                    Wrong{"ImportanceTooGreat", "nodes[1]", [](Model& m) { m.nodes[1].importance = 1.5F; }},
                    Wrong{"NameOutOfRange", "nodes[1]", [](Model& m) { m.nodes[1].name = 14; }},
                    Wrong{"NamesNotEnded", "names", [](Model& m) { m.names.back() = 'x'; }},
                    Wrong{"FindingMissing", "effects", [](Model& m) { m.effects.pop_back(); }},
                    Wrong{"EffectNotCalledFor", "effects", [](Model& m) { m.effects[0].called_for = false; }},
                    Wrong{"MorePartsThanDrawingNumbers", "model", share_parts},
                    Wrong{"SunSeenTooShort", "light", [](Model& m) { add_light(m), m.sun_seen.pop_back(); }},
                    Wrong{"SunSeenTooLong", "light", [](Model& m) { add_light(m), m.sun_seen.push_back({}); }},
                    Wrong{"LampLightTooShort", "light", [](Model& m) { add_light(m), m.lamp_light.pop_back(); }},
                    Wrong{"LampLightTooLong", "light", [](Model& m) { add_light(m), m.lamp_light.push_back({}); }},
                    Wrong{"ShadowsNowhere", "light", [](Model& m) { call_for(m, effect_shadow); }},
                    Wrong{"LampsNowhere", "light", [](Model& m) { call_for(m, effect_lamps); }},
                    Wrong{"NanDay", "light", [](Model& m) { m.light.day = nan; }},
                    Wrong{"DayZero", "light", [](Model& m) { m.light.day = 0; }},
                    Wrong{"NanLatitude", "light", [](Model& m) { m.light.latitude_deg = nan; }},
                    Wrong{"BeyondThePole", "light", [](Model& m) { m.light.latitude_deg = -90.5; }},
                    Wrong{"NanLamps", "light", [](Model& m) { m.light.max_lamp_light = nan; }},
                    Wrong{"NoLampLight", "light", [](Model& m) { m.light.max_lamp_light = 0; }},
                    Wrong{"EndlessLamps", "light", [](Model& m) { m.light.max_lamp_light = INFINITY; }},
                    Wrong{"NegativeRoomLight", "light", [](Model& m) { m.light.night_room_light = -0.1F; }},
                    Wrong{"NanRoomLight", "light", [](Model& m) { m.light.night_room_light = nan; }},
                    Wrong{"NanFog", "light", [](Model& m) { m.light.fog_visibility_m = nan; }},
                    Wrong{"NegativeFog", "light", [](Model& m) { m.light.fog_visibility_m = -1; }},
                    Wrong{"SunNotUnit", "sun_direction", [](Model& m) { m.sun_direction = dvec3(0.0); }}),
    [](const auto& wrong) { return wrong.param.name; });

}  // namespace
}  // namespace surefoot::model
