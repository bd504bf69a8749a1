// A card's plane that enlarges pictures, or whose driver refuses that. libdrm is made up: one connector, one plane.
#include "render/gl/kms_card.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <string>
#include <vector>

namespace surefoot::gl {
namespace {

constexpr std::uint32_t encoder_id = 20, connector_id = 30, crtc_id = 40, plane_id = 50, blob_id = 60, buffer_id = 70;
constexpr const char* property_names[] = {"FB_ID",  "CRTC_ID", "type",   "SRC_X",  "SRC_Y",   "SRC_W", "SRC_H",
                                          "CRTC_X", "CRTC_Y",  "CRTC_W", "CRTC_H", "MODE_ID", "ACTIVE"};

/// The driver: what it was told, and whether its plane enlarges.
struct MadeUpCard {
    bool enlarges = true;
    std::map<std::string, std::uint64_t> commit;  ///< the plane's, of the last one
    std::vector<std::uint32_t> flags;             ///< of all commits
    int buffers = 0, dumb = 0;                    ///< that are there now

    std::uint32_t connectors[1] = {connector_id}, crtcs[1] = {crtc_id}, encoders[1] = {encoder_id}, planes[1] = {plane_id};
    std::uint32_t property_ids[std::size(property_names)] = {};
    std::uint64_t values[std::size(property_names)] = {};
    drmModeModeInfo modes[1] = {};
    drmModeRes resources{};
    drmModeConnector connector{};
    drmModeEncoder encoder{};
    drmModePlane plane{};
    drmModePlaneRes plane_list{};
    drmModeObjectProperties properties{};
    drmModePropertyRes property{};

    MadeUpCard() {
        for (std::uint32_t i = 0; i < std::size(property_names); ++i) {
            property_ids[i] = 100 + i;
            if (std::string(property_names[i]) == "type") values[i] = DRM_PLANE_TYPE_PRIMARY;
        }
        modes[0].clock = 148'500;
        modes[0].hdisplay = 1920, modes[0].vdisplay = 1080;
        modes[0].htotal = 2200, modes[0].vtotal = 1125;
        modes[0].vrefresh = 60;
        resources.count_connectors = resources.count_crtcs = 1;
        resources.connectors = connectors, resources.crtcs = crtcs;
        connector.connector_id = connector_id, connector.encoder_id = encoder_id;
        connector.count_modes = connector.count_encoders = 1;
        connector.modes = modes, connector.encoders = encoders;
        encoder.encoder_id = encoder_id, encoder.crtc_id = crtc_id, encoder.possible_crtcs = 1;
        plane.plane_id = plane_id, plane.possible_crtcs = 1;
        plane_list.count_planes = 1, plane_list.planes = planes;
        properties.count_props = std::size(property_names);
        properties.props = property_ids, properties.prop_values = values;
    }
};
MadeUpCard* card_now = nullptr;

int commit_atomic(int, drmModeAtomicReq*, std::uint32_t flags, void*) {
    card_now->flags.push_back(flags);
    const auto& plane = card_now->commit;
    const bool as_it_is = plane.at("SRC_W") >> 16U == plane.at("CRTC_W") && plane.at("SRC_H") >> 16U == plane.at("CRTC_H");
    if (as_it_is || card_now->enlarges) return 0;
    errno = EINVAL;
    return -1;
}

int control(int, unsigned long request, void* argument) {
    if (request == DRM_IOCTL_MODE_CREATE_DUMB) {
        auto* plain = static_cast<drm_mode_create_dumb*>(argument);
        plain->handle = 1;
        plain->pitch = plain->width * 4;
        ++card_now->dumb;
    }
    if (request == DRM_IOCTL_MODE_DESTROY_DUMB) --card_now->dumb;
    return 0;
}

Drm made_up_drm() {
    Drm drm;
    drm.SetClientCap = [](int, std::uint64_t, std::uint64_t) { return 0; };
    drm.GetResources = [](int) { return &card_now->resources; };
    drm.FreeResources = [](drmModeRes*) {};
    drm.GetConnectorCurrent = [](int, std::uint32_t) { return &card_now->connector; };
    drm.FreeConnector = [](drmModeConnector*) {};
    drm.GetEncoder = [](int, std::uint32_t) { return &card_now->encoder; };
    drm.FreeEncoder = [](drmModeEncoder*) {};
    drm.GetPlaneResources = [](int) { return &card_now->plane_list; };
    drm.FreePlaneResources = [](drmModePlaneRes*) {};
    drm.GetPlane = [](int, std::uint32_t) { return &card_now->plane; };
    drm.FreePlane = [](drmModePlane*) {};
    drm.ObjectGetProperties = [](int, std::uint32_t, std::uint32_t) { return &card_now->properties; };
    drm.FreeObjectProperties = [](drmModeObjectProperties*) {};
    drm.GetProperty = [](int, std::uint32_t id) {
        card_now->property.prop_id = id;
        std::strncpy(card_now->property.name, property_names[id - 100], DRM_PROP_NAME_LEN - 1);
        return &card_now->property;
    };
    drm.FreeProperty = [](drmModePropertyRes*) {};
    drm.CreatePropertyBlob = [](int, const void*, std::size_t, std::uint32_t* id) {
        *id = blob_id;
        return 0;
    };
    drm.DestroyPropertyBlob = [](int, std::uint32_t) { return 0; };
    drm.AddFB2 = [](int, std::uint32_t, std::uint32_t, std::uint32_t, const std::uint32_t*, const std::uint32_t*,
                    const std::uint32_t*, std::uint32_t* id, std::uint32_t) {
        *id = buffer_id;
        ++card_now->buffers;
        return 0;
    };
    drm.RmFB = [](int, std::uint32_t) {
        --card_now->buffers;
        return 0;
    };
    drm.AtomicAlloc = []() { return reinterpret_cast<drmModeAtomicReq*>(card_now); };
    drm.AtomicFree = [](drmModeAtomicReq*) {};
    drm.AtomicAddProperty = [](drmModeAtomicReq*, std::uint32_t object, std::uint32_t id, std::uint64_t value) {
        if (object == plane_id) card_now->commit[property_names[id - 100]] = value;
        return 0;
    };
    drm.AtomicCommit = commit_atomic;
    drm.CrtcGetSequence = [](int, std::uint32_t, std::uint64_t*, std::uint64_t*) { return -1; };
    drm.Ioctl = control;
    return drm;
}

class KmsCards : public ::testing::Test {
protected:
    KmsCards() { card_now = &made_up_; }
    ~KmsCards() override { card_now = nullptr; }
    KmsCards(const KmsCards&) = delete;
    KmsCards& operator=(const KmsCards&) = delete;

    std::unique_ptr<KmsCard> open(int rotation_deg = 0) {
        Screen screen;
        screen.card = "/dev/null";
        screen.name = "HDMI-A-1";
        screen.connector = connector_id;
        ScreenMode mode{1920, 1080, 16'666'667, true, false};
        auto card = KmsCard::open(made_up_drm(), screen, mode, rotation_deg);
        EXPECT_TRUE(card.ok()) << card.error().text();
        return card ? std::move(*card) : nullptr;
    }
    /// Of the last commit: x, y, width, height on the screen, and the picture's width and height.
    [[nodiscard]] std::vector<std::uint64_t> placed() const {
        const auto& c = made_up_.commit;
        return {c.at("CRTC_X"), c.at("CRTC_Y"), c.at("CRTC_W"), c.at("CRTC_H"), c.at("SRC_W") >> 16U, c.at("SRC_H") >> 16U};
    }
    using Placed = std::vector<std::uint64_t>;

    MadeUpCard made_up_;
};

TEST_F(KmsCards, ThePlaneEnlargesASmallerPictureAsLargeAsFits) {
    const auto card = open();
    ASSERT_NE(card, nullptr);
    EXPECT_TRUE(card->enlarge(640, 480));
    EXPECT_EQ(made_up_.flags, std::vector<std::uint32_t>{DRM_MODE_ATOMIC_ALLOW_MODESET | DRM_MODE_ATOMIC_TEST_ONLY})
        << "a trial changes nothing on the screen";
    EXPECT_EQ(made_up_.buffers + made_up_.dumb, 0) << "nothing of the trial is left";
    ASSERT_EQ(card->set_mode(buffer_id), 0);
    EXPECT_EQ(placed(), (Placed{240, 0, 1440, 1080, 640, 480}));
    EXPECT_TRUE(card->enlarge(960, 540));
    ASSERT_EQ(card->set_mode(buffer_id), 0);
    EXPECT_EQ(placed(), (Placed{0, 0, 1920, 1080, 960, 540}));
}

TEST_F(KmsCards, WhereTheDriverRefusesBuffersHaveTheModesSize) {
    made_up_.enlarges = false;
    const auto card = open();
    ASSERT_NE(card, nullptr);
    EXPECT_FALSE(card->enlarge(640, 480));
    EXPECT_EQ(made_up_.flags.size(), 1U);
    EXPECT_EQ(made_up_.buffers + made_up_.dumb, 0);
    ASSERT_EQ(card->set_mode(buffer_id), 0);
    EXPECT_EQ(placed(), (Placed{0, 0, 1920, 1080, 1920, 1080}));
}

TEST_F(KmsCards, PicturesOfTheModesSizeLargerOnesAndTurnedOnesAreNotTried) {
    const auto card = open();
    ASSERT_NE(card, nullptr);
    for (const auto& [width, height] : {std::pair{1920U, 1080U}, {3840U, 2160U}, {1920U, 1200U}, {0U, 0U}})
        EXPECT_FALSE(card->enlarge(width, height)) << width;
    const auto turned = open(180);  // this plane has no rotation, so the drawing turns
    ASSERT_NE(turned, nullptr);
    EXPECT_FALSE(turned->enlarge(640, 480));
    EXPECT_TRUE(made_up_.flags.empty());
}

}  // namespace
}  // namespace surefoot::gl
