// The door to drawing: a device opens a context (or none), takes a model, and draws items slice by slice.
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
#include "render/model/model.hpp"
#include "render/model/view.hpp"
#include "rt/base/result.hpp"
#include "rt/base/thread_annotations.hpp"

namespace surefoot::gl {

enum class BackendKind { egl, device, window, osmesa, null };  ///< backends.hpp has them by name

struct DrawItem {
    model::Index node = 0;
    model::Index rep = 0;
};

/// GLSL of one state class; made by render/effects, so that gl knows no effect.
struct ProgramSource {
    std::string vertex, fragment;
    std::string name{};  ///< of the state class, for people: "texture sun"
};
using ProgramFactory = std::function<ProgramSource(model::EffectMask)>;

/// The null device charges each item by `costs` times `scale`; the same numbers at any speed and worker count.
struct NullOptions {
    const model::CostModel* costs = nullptr;
    double cost_scale = 1;
    double noise = 0;  ///< relative, seeded
    std::uint64_t seed = 1;
};

struct DeviceOptions {
    BackendKind kind = BackendKind::egl;
    model::Viewport viewport;
    int rasterisers = 0;                  ///< software GL threads, as prepare_process was told; 0: the measured default
    std::uint32_t max_items = 1U << 16U;  ///< draw commands a frame; arrays are sized once
    std::string window_title = "Surefoot";
    std::array<float, 3> sky{0.62F, 0.72F, 0.82F};
    NullOptions null;  ///< of the null backend
};

struct FrameStats {
    std::uint32_t items = 0, draws = 0, batches = 0, state_changes = 0;
    std::uint64_t triangles = 0;
};

struct PixelImage {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgba;  ///< row 0 on top
};

/// One context and one target. open() and load() may be slow and allocate; the rest is the frame's.
class Device {
public:
    /// The thread that has the context: the one that opened the device, until another calls bind().
    [[no_unique_address]] ThreadRole draws;

    virtual ~Device() = default;
    [[nodiscard]] virtual std::string renderer() const = 0;  ///< GL_RENDERER, or "null"
    [[nodiscard]] virtual bool software() const = 0;
    /// Uploads geometry and textures, compiles the programs of the scene's state classes (and only those), warms each up. The
    /// model stays as it is until the last draw, or the next load; but for its texels, which are not looked at again.
    virtual Result<void> load(const model::Model& model, const ProgramFactory& programs) REQUIRES(draws) = 0;
    [[nodiscard]] virtual std::vector<std::string> program_listing() const = 0;  ///< "mask: effects", for tests and `effects`
    [[nodiscard]] virtual std::string program_text(model::EffectMask mask) const = 0;

    /// Makes the context current on the calling thread; release() first on the thread that had it.
    virtual void bind() ASSERT_CAPABILITY(draws) = 0;
    virtual void release() RELEASE(draws) = 0;

    // ---- the frame; no own allocation, no throw ----
    virtual void begin_frame(const Pose& pose) REQUIRES(draws) = 0;
    /// State-sorted and multi-drawn within the call. Items with blend are kept and drawn back to front by end_items().
    virtual void draw(std::span<const DrawItem> items) REQUIRES(draws) = 0;
    /// Ends a slice: flush and fence. Returns its number, from 1.
    virtual std::uint32_t end_slice() REQUIRES(draws) = 0;
    /// Waits until at most `in_flight` slices are unfinished.
    virtual void wait_slices(std::uint32_t in_flight) REQUIRES(draws) = 0;
    /// Draws the kept blended items, back to front, as the last slice.
    virtual void end_items() REQUIRES(draws) = 0;
    /// Waits for everything; presents where there is something to present to.
    virtual void finish_frame() REQUIRES(draws) = 0;
    [[nodiscard]] virtual FrameStats stats() const REQUIRES(draws) = 0;
    /// The context is gone (the GPU was reset, taken away, or does not finish), and nothing drawn since was seen. Calls are
    /// harmless from then on, and draw nothing.
    [[nodiscard]] virtual bool lost() const REQUIRES(draws) { return false; }
    /// Of the current frame; slow.
    virtual Result<PixelImage> read_pixels() REQUIRES(draws) = 0;

    /// A GL_TIME_ELAPSED query around what is drawn in between; slow (waits). False, and nothing to end, where there is none.
    /// Software GL lies here: see measure::TimerQueryCheck.
    virtual bool begin_timer() REQUIRES(draws) { return false; }
    virtual double end_timer_ms() REQUIRES(draws) { return 0; }

    /// Virtual time charged so far, us (null backend); 0 elsewhere.
    [[nodiscard]] virtual double charged_us() const REQUIRES(draws) { return 0; }
};

/// Settles how many threads software GL draws with, for the whole process; 0: the measured default. Call it before any other
/// thread exists: drivers take the number from the environment (LP_NUM_THREADS), which may not change while threads read it.
void prepare_process(int rasterisers);

/// Opens the library at run time (dlopen); an absent one is an Error with the Debian package to install.
/// Call it from a neutral thread (not FIFO, not pinned): driver threads inherit policy and cores from their creator.
Result<std::unique_ptr<Device>> open_device(const DeviceOptions& options);

Result<std::unique_ptr<Device>> open_null_device(const DeviceOptions& options, const NullOptions& null_options);

/// The number of software rasterisers that options.rasterisers stands for: 0 is the measured default.
int effective_rasterisers(int rasterisers);

/// What the driver's own threads are called, by name prefix in /proc/self/task (for the census).
std::vector<std::string> driver_thread_prefixes();

}  // namespace surefoot::gl
