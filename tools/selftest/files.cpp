// Rows: files cut at every byte and corrupted at random. The reader answers with a value that is sound, or with an error that
// names place and fault; what crashes or hangs ends the program, and shows under the sanitizers of the tests.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "config/settings.hpp"
#include "input/hid/decoder.hpp"
#include "input/replay/recording.hpp"
#include "render/gl/backends.hpp"
#include "render/import/ostf.hpp"
#include "render/measure/calibrate.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/path.hpp"
#include "rt/base/random.hpp"
#include "tools/selftest/cut_fixture.hpp"
#include "tools/selftest/families.hpp"
#include "tools/selftest/fixtures.hpp"

namespace surefoot::selftest {

namespace {

/// What a reader made of some bytes.
struct Answer {
    bool taken = false;
    bool sound = true;  ///< taken: what was read can be worked with; refused: place and fault are named
};

Answer refusal(const Error& error) { return {false, !error.place.empty() && !error.what.empty()}; }

struct Reader {
    Bytes fixture;
    std::function<Answer(const Bytes&)> read;
    double whole = 0;                         ///< cut before this share of its bytes the file must be refused
    std::function<void(Bytes&)> reseal = {};  ///< puts checksums right: tried for every second corruption
};

/// One to four changes: a byte anywhere, a number at its ends, a run overwritten, taken out or doubled.
void corrupt(Bytes& bytes, Random& random) {
    const std::uint32_t changes = 1 + random.below(4);
    for (std::uint32_t c = 0; c < changes && !bytes.empty(); ++c) {
        const auto at = static_cast<std::ptrdiff_t>(random.below(static_cast<std::uint32_t>(bytes.size())));
        const auto left = static_cast<std::uint32_t>(static_cast<std::ptrdiff_t>(bytes.size()) - at);
        const auto run = static_cast<std::ptrdiff_t>(1 + random.below(std::min(left, 16U)));
        switch (random.below(6)) {
            case 0:
                bytes[static_cast<std::size_t>(at)] ^= static_cast<std::byte>(1U << random.below(8));
                break;
            case 1:
                std::fill_n(bytes.begin() + at, run, static_cast<std::byte>(random.below(2) * 255));
                break;
            case 2: {
                constexpr std::array<std::string_view, 8> ends = {"nan", "-1", "1e999", "0", "4294967296", "\"", "\n", "-"};
                const std::string_view text = ends[random.below(8)];
                for (std::size_t i = 0; i < text.size() && static_cast<std::size_t>(at) + i < bytes.size(); ++i)
                    bytes[static_cast<std::size_t>(at) + i] = static_cast<std::byte>(text[i]);
                break;
            }
            case 3:
                bytes.erase(bytes.begin() + at, bytes.begin() + at + run);
                break;
            case 4: {
                const Bytes again(bytes.begin() + at, bytes.begin() + at + run);
                bytes.insert(bytes.begin() + at, again.begin(), again.end());
                break;
            }
            default:
                bytes[static_cast<std::size_t>(at)] = static_cast<std::byte>(random.below(256));
        }
    }
}

void attack(const Reader& reader, const Effort& effort, Outcome& out) {
    const Bytes& good = reader.fixture;
    out.at_most("bytes of the fixture", static_cast<double>(good.size()), max_fixture_bytes);
    out.exactly("the fixture itself is taken", reader.read(good).taken ? 1 : 0, 1);
    std::uint64_t unsound = 0, cut_taken = 0, changed_taken = 0;
    const std::size_t step = effort.share < 0.02 ? 7 : 1;
    for (std::size_t length = 0; length < good.size() && !effort.stopped(); length += step) {
        const Answer answer = reader.read(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)));
        unsound += answer.sound ? 0 : 1;
        cut_taken += answer.taken && static_cast<double>(length) < reader.whole * static_cast<double>(good.size()) ? 1 : 0;
    }
    Random random(55);
    const std::uint64_t wanted = effort.count(100'000, 500);
    std::uint64_t done = 0;
    for (; done < wanted && !effort.stopped(); ++done) {
        Bytes bytes = good;
        corrupt(bytes, random);
        const bool sealed = reader.reseal && done % 2 == 1;
        if (sealed) reader.reseal(bytes);
        const Answer answer = reader.read(bytes);
        unsound += answer.sound ? 0 : 1;
        changed_taken += reader.reseal && !sealed && answer.taken && bytes != good ? 1 : 0;
        if (done < 2000) out.digest_of(answer.taken ? 1 : 0);
    }
    out.none_of("answers that cannot be worked with, or errors without place and fault", unsound);
    if (reader.whole > 0) out.none_of("cut files that were taken", cut_taken);
    if (reader.reseal) out.none_of("changed files that were taken against their checksum", changed_taken);
    if (step > 1 || done < 100'000) {
        out.scaled = (step > 1 ? "every " + std::to_string(step) + "th truncation, " : std::string("every truncation, ")) +
                     std::to_string(done) + " corruptions of 100000";
    }
}

void walk_files(const Effort& effort, Outcome& out) {
    auto fixture = walk_fixture();
    if (!fixture) return out.none_of("fixtures that cannot be made (" + fixture.error().text() + ")", 1);
    MemoryFile file;
    const auto read = [&](const Bytes& bytes) -> Answer {
        file.set(bytes);
        auto model = model::read_walk(file.name());
        if (!model) return refusal(model.error());
        prepare::PrepareOptions options;
        options.max_candidates = 1U << 12U;
        CutFixture cut_fixture(std::move(*model), options);
        Pose pose;
        pose.position = {2, 1, 8};
        const prepare::PreparedFrame& frame = cut_fixture.prepare({pose, 0, 0}, {64, 64});
        return {true,
                unsound(frame, cut_fixture.costs()) + illegal(frame, cut_fixture.select(select::usual_selector, 1000)) == 0};
    };
    attack({*fixture, read, 1, reseal_walk}, effort, out);
}

/// A texture named as a pipe that nobody writes to: an importer that opens it waits for ever.
void pipe_as_texture(const Reader& reader, Outcome& out) {
    std::array<int, 2> ends{-1, -1};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return out.none_of("pipes that cannot be made", 1);
    std::string text(reinterpret_cast<const char*>(reader.fixture.data()), reader.fixture.size());
    const std::string before = "shape.0\n2\n";  // the texture's name follows; here it is empty
    const std::size_t at = text.find(before + "\n");
    if (at != std::string::npos) text.insert(at + before.size(), std::to_string(ends[0]));
    const Answer answer = reader.read(bytes_of(text));
    out.exactly("a pipe's name as a texture's is answered", at != std::string::npos && answer.taken && answer.sound ? 1 : 0, 1);
    ::close(ends[0]);
    ::close(ends[1]);
}

void ostf_files(const Effort& effort, Outcome& out) {
    auto fixture = ostf_fixture();
    if (!fixture) return out.none_of("fixtures that cannot be made (" + fixture.error().text() + ")", 1);
    MemoryFile file;
    const auto read = [&](const Bytes& bytes) -> Answer {
        file.set(bytes);
        auto scene = importer::import_ostf(file.name(), {});
        return scene ? Answer{true, scene->triangles() > 0} : refusal(scene.error());
    };
    pipe_as_texture({*fixture, read}, out);
    attack({*fixture, read}, effort, out);
}

/// One element more than the buffer view holds: an importer that does not compare reads what lies behind it.
void accessor_beyond(const Reader& reader, Outcome& out) {
    std::string text(reinterpret_cast<const char*>(reader.fixture.data()), reader.fixture.size());
    const std::string count = R"("count":3)";
    std::uint64_t taken = 0, tried = 0;
    for (std::size_t at = text.find(count); at != std::string::npos; at = text.find(count, at + 1), ++tried) {
        std::string more = text;
        more[at + count.size() - 1] = '4';
        taken += reader.read(bytes_of(more)).taken ? 1 : 0;
    }
    out.none_of("accessors beyond their view that are read", taken);
    out.exactly("accessors", static_cast<double>(tried), 2);
}

void gltf_files(const Effort& effort, Outcome& out) {
    MemoryFile file;
    const auto read = [&](const Bytes& bytes) -> Answer {
        file.set(bytes);
        auto scene = importer::import_gltf(file.name(), {});
        if (!scene) return refusal(scene.error());
        bool sound = scene->triangles() > 0;
        for (const importer::Mesh& mesh : scene->meshes) {
            for (const importer::Primitive& p : mesh.primitives) {
                for (const vec3& v : p.positions) sound = sound && std::isfinite(v.x + v.y + v.z);
                for (const std::uint32_t i : p.indices) sound = sound && i < p.positions.size();
            }
        }
        return {true, sound};
    };
    accessor_beyond({glb_fixture(), read}, out);
    attack({glb_fixture(), read, 1}, effort, out);
}

void path_files(const Effort& effort, Outcome& out) {
    MemoryFile file;
    const auto read = [&](const Bytes& bytes) -> Answer {
        file.set(bytes);
        auto path = read_path(file.name());
        if (!path) return refusal(path.error());
        bool sound = !path->samples.empty();
        double before = -std::numeric_limits<double>::infinity();
        for (const PathSample& s : path->samples) {
            sound = sound && s.time_s > before && std::isfinite(glm::length(s.pose.position)) &&
                    std::abs(glm::length(s.pose.orientation) - 1) < 1e-9 && s.pose.fov_y_rad > 0 && s.pose.fov_y_rad < 3.1416;
            before = s.time_s;
        }
        return {true, sound};
    };
    attack({path_fixture(), read}, effort, out);
}

void cost_files(const Effort& effort, Outcome& out) {
    auto fixture = costs_fixture();
    if (!fixture) return out.none_of("fixtures that cannot be made (" + fixture.error().text() + ")", 1);
    MemoryFile file;
    const auto read = [&](const Bytes& bytes) -> Answer {
        file.set(bytes);
        auto costs = measure::read_costs(file.name(), "");
        if (!costs) return refusal(costs.error());
        bool sound = !costs->grids.empty();
        for (const float n : {0.0F, 1.0F, 1e3F, 1e9F}) {
            const model::ItemCost cost = costs->item(n, n, costs->grid_for(model::effect_sun));
            sound = sound && cost.submit_us >= 0 && cost.raster_us >= 0 && std::isfinite(cost.submit_us + cost.raster_us);
        }
        return {true, sound};
    };
    attack({*fixture, read, 1, reseal_costs}, effort, out);
}

void settings_files(const Effort& effort, Outcome& out) {
    const config::Schema schema({named(select::selectors()), select::usual_selector}, {named(gl::backends()), gl::usual_backend});
    const auto read = [&](const Bytes& bytes) -> Answer {
        const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        config::Configuration configuration(schema);
        const auto loaded = config::load_text(configuration, text, "fixture.toml", "kiosk");
        if (!loaded) return refusal(loaded.error());
        const config::Settings& s = configuration.values;
        return {true, s.rate_hz >= 1 && s.rate_hz <= 1000 && s.budget_ms >= 0 && s.budget_ms <= 1000 && s.workers >= 0};
    };
    attack({settings_fixture(), read}, effort, out);
}

void recordings(const Effort& effort, Outcome& out) {
    const auto read = [&](const Bytes& bytes) -> Answer {
        const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        auto recording = input::parse_recording(text, "fixture.hid");
        if (!recording) return refusal(recording.error());
        auto layout = input::read_descriptor(recording->descriptor, "fixture.hid");
        if (!layout) return refusal(layout.error());
        const input::HidDevice device = input::describe_device(std::move(*layout), {recording->vendor, recording->product});
        input::ReportDecoder decoder(device);
        input::DeviceState state;
        bool sound = true;
        for (std::size_t i = 0; i < recording->reports.size(); ++i)
            (void)decoder.decode(recording->report(i), static_cast<std::int64_t>(i) + 1, state);
        for (std::size_t c = 0; c < device.controls.size(); ++c) {
            const input::ControlInfo& info = device.controls[c];
            if (!state.has_value.test(c) || info.kind != input::ControlKind::axis) continue;
            sound = sound && state.value[c] >= info.logical_min && state.value[c] <= info.logical_max;
        }
        return {true, sound};
    };
    attack({recording_fixture(), read}, effort, out);
}

void picture_files(const Bytes& fixture, double whole, const Effort& effort, Outcome& out) {
    const auto read = [](const Bytes& bytes) -> Answer {
        auto image = image::decode_image(bytes, "fixture");
        if (!image) return refusal(image.error());
        return {true, image->rgba.size() == 4ULL * image->width * image->height && image->width > 0 && image->height > 0};
    };
    attack({fixture, read, whole}, effort, out);
}

void png_files(const Effort& effort, Outcome& out) {
    picture_files(png_fixture(16, 16), 0.9, effort, out);  // the end mark holds nothing
}

void jpeg_files(const Effort& effort, Outcome& out) { picture_files(jpeg_fixture(16, 16, true), 1, effort, out); }

}  // namespace

std::span<const Row> files_rows() {
    static constexpr std::string_view sound = "an answer that can be worked with, or an error with place and fault";
    static constexpr std::string_view checked =
        "an answer that can be worked with, or an error with place and fault; nothing changed is taken against its checksum";
    static constexpr std::array<Row, 9> table = {{
        {"F1", "files",
         ".walk of two objects: every truncation, random corruptions, every second one with its checksums put right", checked,
         walk_files},
        {"F2", "files", "OSTF of two objects: every truncation, random corruptions, a pipe named as its texture", sound,
         ostf_files},
        {"F3", "files", "glTF (GLB) of two nodes: every truncation, random corruptions, accessors beyond their views", sound,
         gltf_files},
        {"F4", "files", "path of twenty poses: every truncation, random corruptions", sound, path_files},
        {"F5", "files",
         "cost table of two classes: every truncation, random corruptions, every second one with its checksum put right", checked,
         cost_files},
        {"F6", "files", "settings with a profile: every truncation, random corruptions", sound, settings_files},
        {"N21a", "files", "PNG picture: every truncation, random corruptions", sound, png_files},
        {"N21b", "files", "progressive JPEG picture: every truncation, random corruptions", sound, jpeg_files},
        {"F7", "files", "recording of a pad: every truncation, random corruptions, decoded", sound, recordings},
    }};
    return table;
}

}  // namespace surefoot::selftest
