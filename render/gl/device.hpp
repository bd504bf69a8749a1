// The drawing device: opens a context (or none), loads a model, and draws items slice by slice.
// The frame thread owns it after bind(); only this room includes GL. `null` records and charges the virtual cost clock.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/model/cost.hpp"
#include "render/model/daylight.hpp"
#include "render/model/model.hpp"
#include "render/model/resolution.hpp"
#include "render/model/view.hpp"
#include "rt/base/modes.hpp"
#include "rt/base/result.hpp"
#include "rt/base/shown.hpp"
#include "rt/base/thread_annotations.hpp"

namespace surefoot::gl {

class WindowEvents;

enum class BackendKind { egl, device, window, kms, osmesa, null };  ///< backends.hpp has them by name

/// An item to be drawn: one representation of a node.
struct DrawItem {
    model::Index node = 0;
    model::Index rep = 0;
};

/// Sides of the shadow map, in texels.
constexpr std::uint32_t shadow_map_px = 512;

/// A depth picture as the sun sees it: parallel, its depths 1 at the side of the sun and above 0 at all that casts.
struct ShadowView {
    dvec3 origin{0.0};       ///< world
    mat4 from_origin{1.0F};  ///< from positions relative to `origin` to -1..1, -1..1 and 0..1
    vec3 towards{0, 1, 0};   ///< the sun, unit
    float texel_m = 0;       ///< side of a texel
    float depth_m = 1;       ///< from depth 0 to depth 1
};

/// Where the shadow map stands, as programs read it. Lets all be in the sun at first.
struct ShadowPlace {
    mat4 from_eye = mat4(vec4(0), vec4(0), vec4(0), vec4(0.5F, 0.5F, 2, 1));  ///< to 0..1, 0..1 and a depth
    vec3 towards{0, 1, 0};
    float texel = 0;  ///< in depth
};

/// Sides of a layer of the image cache, in texels.
constexpr std::uint32_t picture_layer_px = 256;

/// Captures that wait for the next picture at most.
constexpr std::uint32_t max_captures = 64;

/// Where a picture of the cache lies: a square of texels in one layer.
struct PicturePlace {
    std::uint16_t layer = 0, column = 0, row = 0, texels = 0;
};

/// A picture of the image cache: all that lies in a box, seen from `eye`, on a plane across `forward`.
struct CachePicture {
    PicturePlace place;
    dvec3 eye{0.0};                                        ///< world
    dvec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};  ///< unit, across each other
    double plane_m = 1;                                    ///< depth of the plane along forward
    dvec2 low_m{0.0};                                      ///< on the plane: lower left corner of the square, along right and up
    double side_m = 1;                                     ///< on the plane
    Box box;                                               ///< world: cuts what is captured; its front faces show the picture
    double grown_m = 0;  ///< the box is so much larger at each face; what is before the smaller one stays before the picture
};

/// A corner of a mesh that shows a picture.
struct MeshCorner {
    vec3 place{0};  ///< relative to the eye of the picture
    vec2 at{0};     ///< in texels of its square
};

/// A picture on a mesh of its own depths. Texels that it shows must be covered whole: they are drawn opaque.
struct PictureMesh {
    PicturePlace place;
    dvec3 eye{0.0};  ///< of the picture, in the world
    std::span<const MeshCorner> corners;
    std::span<const std::uint16_t> indices;  ///< three a triangle, both sides are seen
};

/// What programs may read of the moment that a picture shows.
struct PictureMoment {
    model::Daylight light;  ///< `background` is the colour itself
    double time_s = 0;      ///< of what moves
    dvec3 eye{0.0};         ///< in the world, m
    float pixel_rad = 0;    ///< angle of a pixel in the middle
    ShadowPlace shadow = {};
    vec3 box_low{0}, box_high{0};  ///< of a capture: what it is cut to, relative to the eye
    model::EffectMask hidden = 0;  ///< effects that are left out
    mat4 to_direction{1.0F};       ///< from -1..1, -1..1, 1, 1 of the picture to a direction in the world; for what is behind all
};

/// A uniform of a program: its GLSL name, of `float`, `vec3` or `mat4`, and what writes its 1, 3 or 16 floats. On the frame
/// thread.
struct UniformSource {
    const char* name;
    int components;
    void (*write)(const PictureMoment& moment, float* to);
};

/// Texture units: the pictures of materials, the shadow map, and the image cache.
constexpr int material_unit = 0, shadow_unit = 1, picture_unit = 2;
/// A sampler of a program, and the texture unit that it reads.
struct SamplerSource {
    const char* name;
    int unit;
};

/// GLSL of one state class. render/effects makes it, so that this room knows no effect.
struct ProgramSource {
    std::string vertex, fragment;
    std::string name{};  ///< of the state class, for people: "texture sun"
    /// In place of `fragment` where pixels have several samples: its alpha is the covered share of the pixel. Empty: `fragment`.
    std::string fragment_samples{};
    /// In place of `vertex` in captures of the image cache: cuts off what is outside of `box_low` to `box_high`.
    std::string vertex_in_box{};
    std::vector<UniformSource> uniforms{};  ///< those that it declares, but `view_projection`
    std::vector<SamplerSource> samplers{};
};
using ProgramFactory = std::function<ProgramSource(model::EffectMask)>;

/// The null device charges each item `costs` x `scale`: equal numbers at any speed and worker count.
struct NullOptions {
    const model::CostModel* costs = nullptr;
    double cost_scale = 1;
    double noise = 0;  ///< relative, seeded
    std::uint64_t seed = 1;
    double enlarge_us = 0;    ///< charged for a frame below full resolution
    double rest_pass_us = 0;  ///< charged for a pass over the picture at rest
    double behind_us = 0;     ///< charged with the first pass, for what is behind everything
};

/// What a device can do at rest: nothing, a second picture, or also the mean of several samples.
enum class RestSupport : std::uint8_t { none, picture, samples };

/// Parts of items that are drawn together. Blended ones come last.
enum class Parts : std::uint8_t { all, opaque, blended };

/// Groups of effects that can be switched each by itself.
constexpr std::size_t max_switches = 4;

/// The screen of the kms back end.
struct ScreenOptions {
    std::string name;           ///< of the connector, "HDMI-A-1"; empty: the first that is connected
    std::string mode;           ///< "1920x1080@60"; empty: the one that the screen prefers
    int rotation_deg = 0;       ///< 0, 90, 180 or 270
    bool keyboard_off = false;  ///< of the text console below
    /// Called every second while the screen cannot be had. held: another program has it. True: wait on. Empty: never wait.
    std::function<bool(const Error& why, bool held)> on_wait{};
    /// Software renderers draw into buffers of GBM too. For tests: they crash where the card goes away.
    bool software_by_gbm = false;
};

/// Settings of a device.
struct DeviceOptions {
    BackendKind kind = BackendKind::egl;
    model::Viewport viewport;
    int rasterisers = 0;                  ///< threads of software GL, as given to prepare_process(); 0: the measured default
    std::uint32_t max_items = 1U << 16U;  ///< draw commands a frame; arrays are sized once
    std::string window_title = "Surefoot";
    ScreenOptions screen;
    bool fullscreen = false;  ///< the window fills the screen at first
    std::array<float, 3> sky = model::usual_sky;
    NullOptions null;           ///< of the null backend
    bool rest = false;          ///< has targets for a picture at rest
    std::uint32_t samples = 1;  ///< of a pixel: 1, 2 or 4; see Device::samples()
    rt::TextureFilter filter = rt::TextureFilter::automatic;
    bool smaller = false;            ///< frames below full resolution show the mip levels of the whole one; prepared by load()
    bool processor_enlarges = true;  ///< on a software driver: smaller frames are enlarged by the processor, not by a pass
    /// Groups of effects that hide_effects() leaves out; at most max_switches. load() compiles programs without each union of
    /// them.
    std::vector<model::EffectMask> switches;
    /// Pictures have what the model calls for behind everything (model::background_effects). It may be among the switches.
    bool background = true;
    bool second_filter = false;        ///< prepares set_filter(), where `filter` is automatic and the driver is software
    std::uint32_t picture_layers = 0;  ///< of the image cache, 256 KiB each; 0: load() makes nothing of it
    /// Triangles of draw_picture_meshes() that a frame draws without waiting; 0: load() makes nothing for meshes.
    std::uint32_t mesh_triangles = 0;
};

/// Counts and times of one drawn frame.
struct FrameStats {
    std::uint32_t items = 0, draws = 0, batches = 0, state_changes = 0;
    std::uint64_t triangles = 0;
    std::uint32_t pictures = 0, captures = 0;  ///< of the image cache: drawn, and made anew; what a capture draws counts nowhere
    std::uint32_t meshes = 0;                  ///< of the image cache
    float resolution = 1;                      ///< the step that is drawn, of model::resolution_steps
    std::uint32_t samples = 1;                 ///< Device::samples()
    rt::TextureFilter filter = rt::TextureFilter::bilinear;  ///< that textures are read by
};

/// A picture in memory, RGBA8.
struct PixelImage {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgba;  ///< row 0 on top
};

/// One context and one render target. open() and load() may be slow and allocate; the other calls are for the frame.
class Device {
public:
    /// The thread that has the context: the one that opened the device, until another calls bind().
    [[no_unique_address]] ThreadRole draws;

    virtual ~Device() = default;
    [[nodiscard]] virtual std::string renderer() const = 0;  ///< GL_RENDERER, or "null"
    [[nodiscard]] virtual bool software() const = 0;
    /// The window that shows the pictures, with what its visitor does; null without one. It may outlive the device.
    [[nodiscard]] virtual std::shared_ptr<WindowEvents> window() const { return nullptr; }
    /// Samples of a pixel that frames are drawn with. Others than requested where the driver has no such number.
    [[nodiscard]] virtual std::uint32_t samples() const { return 1; }
    /// The filter that textures are read by, unless set_filter() asks for the other; never `automatic`.
    [[nodiscard]] virtual rt::TextureFilter filter() const { return rt::TextureFilter::bilinear; }
    /// Uploads geometry and textures; compiles and warms up the programs of the scene's state classes, and no others. The model
    /// must not change until the last draw or the next load. Its texels may go: they are not read again.
    virtual Result<void> load(const model::Model& model, const ProgramFactory& programs) REQUIRES(draws) = 0;
    [[nodiscard]] virtual std::vector<std::string> program_listing() const = 0;  ///< "mask: effects", for tests and `effects`
    [[nodiscard]] virtual std::string program_text(model::EffectMask mask) const = 0;

    /// Makes the context current on the calling thread; release() first on the thread that had it.
    virtual void bind() ASSERT_CAPABILITY(draws) = 0;
    virtual void release() RELEASE(draws) = 0;

    /// Whether set_filter() has an effect: see DeviceOptions::second_filter.
    [[nodiscard]] virtual bool switches_filter() const { return false; }

    /// The display's refreshes, where it counts and stamps them; elsewhere the period is 0.
    [[nodiscard]] virtual rt::Refreshes refreshes() const { return {0, 0}; }
    /// Whether present() waits until a screen shows the picture. It does at first; before the first frame.
    virtual void wait_for_flips(bool /*wait*/) {}
    /// What became of the screen since the last call, a line each. A few times a second, on a thread that does not draw.
    virtual std::vector<std::string> watch_screen() { return {}; }

    // ---- the frame; no own allocation, no throw ----
    /// The filter of the pictures that begin from now on. A change takes a call or two of the driver for each texture array.
    virtual void set_filter(rt::TextureFilter filter) REQUIRES(draws) { static_cast<void>(filter); }
    /// Leaves out each group of DeviceOptions::switches that `hidden` holds whole, and no other effect. Between pictures; it
    /// costs nothing by itself.
    virtual void hide_effects(model::EffectMask hidden) REQUIRES(draws) { static_cast<void>(hidden); }
    /// The light of the pictures that begin from now on; after load() it is the model's own.
    virtual void set_light(const model::Daylight& light) REQUIRES(draws) { static_cast<void>(light); }
    /// The time at which moving placements are drawn in the pictures that begin from now on; after load() it is 0.
    virtual void set_time(double time_s) REQUIRES(draws) { static_cast<void>(time_s); }
    /// Whether the model has surfaces that receive shadows of what moves (effect_moving_shadow).
    [[nodiscard]] virtual bool receives_shadows() const { return false; }
    /// The next begin_frame() draws the shadow map anew, with these items at their places of its time. They must live until
    /// then. Blended parts cast none.
    virtual void refresh_shadow(const ShadowView& view, std::span<const DrawItem> casters) REQUIRES(draws) {
        static_cast<void>(view), static_cast<void>(casters);
    }
    /// Whether the pictures that begin from now on show the shadows of the map. Not after load().
    virtual void show_shadow(bool shown) REQUIRES(draws) { static_cast<void>(shown); }
    /// `resolution`: share of the picture's width and height at which it is drawn, then enlarged once by finish_frame(). The step
    /// of model::resolution_steps that is not above it, or the least; NaN, zero and below mean 1.
    virtual void begin_frame(const Pose& pose, float resolution) REQUIRES(draws) = 0;
    void begin_frame(const Pose& pose) REQUIRES(draws) { begin_frame(pose, 1.0F); }
    /// Draws items sorted by state, as multi-draws. Blended items wait for end_items().
    virtual void draw(std::span<const DrawItem> items) REQUIRES(draws) = 0;
    /// Time that the frame spends beside its draws, as predicted: the null device charges it. Other devices take what it takes.
    virtual void charge_us(double us) REQUIRES(draws) { static_cast<void>(us); }
    /// Ends a slice: flush and fence. Returns its number, from 1.
    virtual std::uint32_t end_slice() REQUIRES(draws) = 0;
    /// Waits until at most `in_flight` slices are unfinished.
    virtual void wait_slices(std::uint32_t in_flight) REQUIRES(draws) = 0;
    /// Draws the kept blended items, back to front, as the last slice.
    virtual void end_items() REQUIRES(draws) = 0;
    /// Enlarges a frame below full resolution, and waits for all slices: the picture is whole.
    virtual void finish_frame() REQUIRES(draws) = 0;

    // ---- the image cache: pictures made while walking; the same rules ----
    /// Layers that load() made for it. 0: none were requested, or picture_reason() has the reason.
    [[nodiscard]] virtual std::uint32_t picture_layers() const { return 0; }
    /// Why there are fewer layers than DeviceOptions::picture_layers; else empty.
    [[nodiscard]] virtual std::string picture_reason() const { return {}; }
    /// The next begin_frame() or begin_rest() draws these items into a square of a layer, with its light, time and effects, but
    /// without moving shadows. Only parts of leaves that are not blended are drawn. Then pictures are drawn over them, in this
    /// order: back to front, seen from the eye of `picture`. They show what their squares have by then. All must live until then.
    /// False: nothing will be drawn. It has no layers, the place is outside of them, or max_captures already wait.
    virtual bool capture_picture(const CachePicture& picture, std::span<const DrawItem> items,
                                 std::span<const CachePicture> back_to_front) REQUIRES(draws) {
        static_cast<void>(picture), static_cast<void>(items), static_cast<void>(back_to_front);
        return false;
    }
    bool capture_picture(const CachePicture& picture, std::span<const DrawItem> items) REQUIRES(draws) {
        return capture_picture(picture, items, {});
    }
    /// The same, and its depths are read into `depths`, by rows from the lowest. A depth is nearest_depth_m() of the picture over
    /// the texel's own, or 0 where nothing is. Waits for the capture. What pictures show has none.
    virtual bool capture_depths(const CachePicture& picture, std::span<const DrawItem> items, std::span<float> depths)
        REQUIRES(draws) {
        static_cast<void>(picture), static_cast<void>(items), static_cast<void>(depths);
        return false;
    }
    /// Whether draw_picture_meshes() draws.
    [[nodiscard]] virtual bool draws_meshes() const { return false; }
    /// Draws pictures on meshes, opaque, as triangles are: with their own depth, which they write. Before draw_pictures(), in the
    /// current slice. The nearest first is the fastest. Meshes of over mesh_triangles, and those outside of layers, are left out.
    virtual void draw_picture_meshes(std::span<const PictureMesh> meshes) REQUIRES(draws) { static_cast<void>(meshes); }
    /// Draws pictures into the frame in this order: back to front. After all draw(), and before end_items(), in the current
    /// slice. Pictures that cannot be seen from the eye of the frame are left out: its box holds it, or their plane is behind it.
    virtual void draw_pictures(std::span<const CachePicture> back_to_front) REQUIRES(draws) { static_cast<void>(back_to_front); }

    // ---- a picture at rest: drawn over several frames into a second target, while the shown picture stays; the same rules ----
    [[nodiscard]] virtual RestSupport rest_support() const REQUIRES(draws) { return RestSupport::none; }
    /// Begins the second picture. `offset_px`: by how much everything is moved on the picture, in pixels. The next begin_frame()
    /// or begin_rest() gives it up.
    virtual void begin_rest(const Pose& /*pose*/, const dvec2& /*offset_px*/) REQUIRES(draws) {}
    /// Draws these parts of the items as a slice.
    virtual void draw_rest(std::span<const DrawItem> /*items*/, Parts /*parts*/) REQUIRES(draws) {}
    /// The second picture is whole: adds it to the sum of samples, which the first one starts.
    virtual void add_sample(bool /*first*/) REQUIRES(draws) {}
    /// Makes the shown picture: the second one if `samples` is 1, else the mean of so many.
    virtual void show_rest(std::uint32_t /*samples*/) REQUIRES(draws) {}
    /// Ends a frame at rest: waits for all slices. The shown picture is whole.
    virtual void finish_rest_frame() REQUIRES(draws) {}

    /// Hands the shown picture to the window or screen, if there is one: as large as fits, in its own shape, with black beside
    /// it. The driver may wait for the display, and waits until the picture is shown where the display tells. Nothing on a lost
    /// device.
    virtual rt::Shown present() REQUIRES(draws) { return {rt::ShownBy::hand_over, 0, 0}; }

    [[nodiscard]] virtual FrameStats stats() const REQUIRES(draws) = 0;
    /// The context is lost: the GPU was reset or removed, or does not finish. Later frames were not shown. All calls are safe
    /// then, and draw nothing.
    [[nodiscard]] virtual bool lost() const REQUIRES(draws) { return false; }
    /// Pixels of the current frame, in full size; slow.
    virtual Result<PixelImage> read_pixels() REQUIRES(draws) = 0;

    /// A GL_TIME_ELAPSED query around the draws in between; slow (waits). False: no timer queries, and nothing to end.
    /// Software GL reports wrong times: see measure::TimerQueryCheck.
    virtual bool begin_timer() REQUIRES(draws) { return false; }
    virtual double end_timer_ms() REQUIRES(draws) { return 0; }

    /// Virtual time charged so far, us (null backend); 0 elsewhere.
    [[nodiscard]] virtual double charged_us() const REQUIRES(draws) { return 0; }
    /// Whether it charges time for draws.
    [[nodiscard]] virtual bool charges() const { return false; }
};

/// How the device draws, and by which filter `costs` were measured: unless they name it, by the one that is automatic here.
inline model::Quality quality_of(const Device& device, const model::CostModel& costs) {
    const auto automatic = device.software() ? rt::TextureFilter::bilinear : rt::TextureFilter::trilinear;
    return {device.samples(), device.filter(), costs.filter == rt::TextureFilter::automatic ? automatic : costs.filter};
}

/// What hide_effects(hidden) leaves out of a device with these switches.
model::EffectMask left_out(std::span<const model::EffectMask> switches, model::EffectMask hidden);

/// Sets how many threads software GL draws with, for the whole process; 0: the measured default. Call it before any other thread
/// exists: drivers read the number from the environment (LP_NUM_THREADS), which must not change while threads read it.
void prepare_process(int rasterisers);

/// Opens the library at run time (dlopen); an absent one is an Error with the Debian package to install.
/// Call it from a neutral thread (not FIFO, not pinned): driver threads inherit policy and cores from their creator.
Result<std::unique_ptr<Device>> open_device(const DeviceOptions& options);

Result<std::unique_ptr<Device>> open_null_device(const DeviceOptions& options, const NullOptions& null_options);

/// The number of software rasterisers that options.rasterisers stands for: 0 is the measured default.
int effective_rasterisers(int rasterisers);

/// Name prefixes of the driver's threads in /proc/self/task, for the census.
std::vector<std::string> driver_thread_prefixes();

}  // namespace surefoot::gl
