// Room for the pictures of a walk: in a full cache a picture is renewed in its own place, and none goes for nothing.
#include "render/cache/walk_cache.hpp"

#include <gtest/gtest.h>

#include "tests/cache/row.hpp"

namespace surefoot::cache {
namespace {

CacheOffer offer_of(Index box, std::uint32_t texels) {
    CacheOffer offer;
    offer.box = box;
    offer.prospect.picture.texels = texels;
    return offer;
}

class WalkCacheRoom : public ::testing::Test {
protected:
    void SetUp() override {
        auto boxes = SceneBoxes::make(row_of_leaves(), {});
        ASSERT_TRUE(boxes.ok());
        cache_ = WalkCache(std::move(*boxes), {.layers = 1, .kept_frames = 2});
    }
    bool take(Index box, std::uint32_t texels) {
        cache_.plan({});
        const bool taken = cache_.take(offer_of(box, texels));
        if (taken) cache_.captured(box);
        return taken;
    }
    void pass_frames(int count) {
        for (int i = 0; i < count; ++i) cache_.cover({}, 0);
    }
    WalkCache cache_;
};

TEST_F(WalkCacheRoom, APictureIsRenewedInItsOwnPlace) {
    ASSERT_TRUE(take(1, 256));
    EXPECT_TRUE(take(1, 256));
    EXPECT_FALSE(take(2, 64)) << "a set may rely on the first";
    EXPECT_TRUE(cache_.held(1).any());
    EXPECT_TRUE(take(1, 64));
    EXPECT_TRUE(take(2, 64));
}

/// A frame may end without having made what it took, as the first one at rest does.
TEST_F(WalkCacheRoom, APictureStaysWhereTheNewOneIsNotMade) {
    ASSERT_TRUE(take(1, 128));
    CacheOffer offer = offer_of(1, 128);
    offer.prospect.picture.plane_m = 7;
    ASSERT_TRUE(cache_.take(offer));
    EXPECT_TRUE(cache_.is_pending(1));
    EXPECT_EQ(cache_.held(1).picture.plane_m, 7);
    cache_.drop_pending();
    EXPECT_TRUE(cache_.held(1).any());
    EXPECT_NE(cache_.held(1).picture.plane_m, 7) << "its place holds the old one";
    EXPECT_FALSE(cache_.is_pending(1));
    ASSERT_TRUE(cache_.take(offer));
    cache_.forget();
    cache_.drop_pending();
    EXPECT_FALSE(cache_.held(1).any()) << "the old one is of another light";
    ASSERT_TRUE(take(2, 128));
    ASSERT_TRUE(cache_.take(offer_of(2, 64)));
    cache_.drop_pending();
    EXPECT_FALSE(cache_.held(2).any()) << "another may have its place";
    EXPECT_EQ(cache_.bytes(), 0U);
}

TEST_F(WalkCacheRoom, NothingGoesForAPictureThatHasNoRoom) {
    ASSERT_TRUE(take(1, 64));
    pass_frames(4);
    ASSERT_TRUE(take(2, 64));
    EXPECT_FALSE(take(3, 256));
    EXPECT_TRUE(cache_.held(1).any()) << "it would not have been enough";
    pass_frames(4);
    EXPECT_TRUE(take(3, 256));
    EXPECT_FALSE(cache_.held(1).any() || cache_.held(2).any());
}

}  // namespace
}  // namespace surefoot::cache
