// A card of the kernel: its screens, and one of them driven by atomic modesetting.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "render/gl/drm.hpp"
#include "render/gl/kms_modes.hpp"
#include "render/gl/kms_screen.hpp"

namespace surefoot::gl {

/// CLOCK_MONOTONIC, which stamps flips.
std::int64_t card_now_ns();

/// Owns the card's file. Its ScreenPort drives one connector; pictures are XRGB8888.
class KmsCard final : public ScreenPort {
public:
    /// `rotation_deg`: 0, 90, 180 or 270. An Error where the card cannot be opened, has no atomic modesetting or cannot reach the
    /// connector.
    static Result<std::unique_ptr<KmsCard>> open(const Drm& drm, const Screen& screen, const ScreenMode& mode, int rotation_deg);
    ~KmsCard() override;
    KmsCard(const KmsCard&) = delete;
    KmsCard& operator=(const KmsCard&) = delete;

    [[nodiscard]] int file() const { return file_; }
    /// The refreshes of its mode; one of them where the card counts them.
    [[nodiscard]] rt::Refreshes refreshes() const;
    /// The plane turns pictures as wanted. Where it cannot, a half turn is left to who draws.
    [[nodiscard]] bool turns() const { return turns_; }

    /// Whether the plane enlarges smaller pictures of this size in plain buffers to the screen, as large as fits. The card says
    /// so in a trial. Buffers then have this size. The card must be taken; turned pictures are not enlarged.
    bool enlarge(std::uint32_t width, std::uint32_t height);
    /// An id for a buffer of the mode's size, turned where the plane turns it, or of the size that enlarge() took. 0 where the
    /// card refuses; the errno is in `error`.
    ShownBuffer add_buffer(std::uint32_t handle, std::uint32_t stride, std::uint32_t width, std::uint32_t height, int& error);
    void remove_buffer(ShownBuffer buffer);

    int take() override;
    int set_mode(ShownBuffer buffer) override;
    int flip(ShownBuffer buffer) override;
    Flip wait_flip(std::int64_t timeout_ns) override;
    [[nodiscard]] bool counts_refreshes() const override { return counts_refreshes_; }
    bool connected(bool probe) override;
    bool has_mode() override;
    bool link_failed() override;
    std::string holders() override;

private:
    /// Ids of the kernel's objects and of their properties; 0: absent.
    struct Plane {
        std::uint32_t id = 0, framebuffer = 0, crtc = 0, rotation = 0;
        std::array<std::uint32_t, 4> source{}, shown{};  ///< x, y, width, height
    };
    struct Crtc {
        std::uint32_t id = 0, index = 0, mode = 0, active = 0;
    };
    KmsCard(const Drm& drm, Screen screen, const ScreenMode& mode) : drm_(drm), screen_(std::move(screen)), mode_(mode) {}

    Result<void> find_objects(int rotation_deg);
    Result<void> find_crtc();
    [[nodiscard]] std::vector<std::uint32_t> crtcs_of_others() const;
    [[nodiscard]] std::uint64_t offered_rotations() const;
    Result<void> find_planes(int rotation_deg);
    [[nodiscard]] std::uint32_t property(std::uint32_t object, std::uint32_t type, const char* name) const;
    [[nodiscard]] std::uint64_t property_value(std::uint32_t object, std::uint32_t type, const char* name) const;
    bool add_to(drmModeAtomicReq* request, ShownBuffer buffer) const;
    int commit_mode(ShownBuffer buffer, std::uint32_t flags) const;
    int try_buffer(std::uint32_t width, std::uint32_t height);

    const Drm drm_;
    Screen screen_;
    ScreenMode mode_;
    int file_ = -1;
    drmModeModeInfo timings_{};
    Crtc crtc_;
    Plane plane_;
    std::vector<Plane> other_planes_;   ///< of this CRTC: a pointer, overlays
    std::uint32_t connector_crtc_ = 0;  ///< a property
    std::uint64_t turned_ = 0;          ///< of the plane's rotation
    bool turns_ = true, swaps_sides_ = false;
    std::uint32_t enlarged_width_ = 0,
                  enlarged_height_ = 0;           ///< of pictures that the plane enlarges; 0: it shows them as they are
    std::uint32_t link_status_ = 0;               ///< of the connector
    std::array<std::uint32_t, 4> adjustments_{};  ///< of the CRTC: colours and a variable rate
    std::uint32_t mode_blob_ = 0;
    bool counts_refreshes_ = false;
    std::uint64_t flips_ = 0;
};

}  // namespace surefoot::gl
