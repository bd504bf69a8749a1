// The fuzz targets on seeded mutations, in every build: no crash, no claim broken, little memory, little time.
#include <malloc.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <new>

#include "rt/base/file.hpp"
#include "rt/base/random.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/input/hid_corpus.hpp"

// Peak of the memory that this thread allocates by new; the tests bound it. Sanitizers bring their own new.
#ifndef SUREFOOT_SANITIZED
namespace {
thread_local std::size_t allocated_now = 0, allocated_peak = 0;
void* counted(std::size_t bytes) {
    void* p = std::malloc(bytes);
    if (p == nullptr) throw std::bad_alloc();
    allocated_now += malloc_usable_size(p);
    allocated_peak = allocated_now > allocated_peak ? allocated_now : allocated_peak;
    return p;
}
void uncounted(void* p) noexcept {
    allocated_now -= malloc_usable_size(p);
    std::free(p);
}
}  // namespace
void* operator new(std::size_t bytes) { return counted(bytes); }
void* operator new[](std::size_t bytes) { return counted(bytes); }
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
    void* p = std::malloc(bytes);
    allocated_now += malloc_usable_size(p);
    allocated_peak = allocated_now > allocated_peak ? allocated_now : allocated_peak;
    return p;
}
void operator delete(void* p) noexcept { uncounted(p); }
void operator delete[](void* p) noexcept { uncounted(p); }
void operator delete(void* p, std::size_t) noexcept { uncounted(p); }
void operator delete[](void* p, std::size_t) noexcept { uncounted(p); }
#endif

namespace surefoot::input {
namespace {

#ifdef SUREFOOT_SANITIZED
constexpr int mutations = 20'000;  // the sanitizers take ten times as long
#else
constexpr int mutations = 100'000;
#endif

std::vector<std::vector<std::byte>> corpus(bool text) {
    std::vector<std::vector<std::byte>> all;
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(device_folder()))
        if (entry.path().extension() == ".hid") files.push_back(entry.path());
    std::sort(files.begin(), files.end());  // the folder's order is no seed
    for (const auto& file : files) {
        auto r = read_recording(file);
        if (!r) continue;
        all.push_back(text ? *read_file(file) : r->descriptor);
    }
    return all;
}

/// A few bytes changed, doubled, lost or taken from elsewhere.
void mutate(std::vector<std::byte>& b, Random& random) {
    static constexpr unsigned boundary_values[] = {0x00, 0x01, 0xff, 0x7f, 0x80, 0xa1, 0xc0, 0x81,
                                                   0x75, 0x95, 0x85, 0xa4, 0xb4, 0x27, 0x2b, 0xa9};
    for (std::uint32_t n = 1 + random.below(6); n > 0; --n) {
        if (b.empty()) b.push_back(std::byte{0});
        const auto at = static_cast<std::ptrdiff_t>(random.below(static_cast<std::uint32_t>(b.size())));
        switch (random.below(5)) {
            case 0:
                b[static_cast<std::size_t>(at)] ^= static_cast<std::byte>(1U << random.below(8));
                break;
            case 1:
                b[static_cast<std::size_t>(at)] = static_cast<std::byte>(boundary_values[random.below(16)]);
                break;
            case 2:
                b.insert(b.begin() + at, static_cast<std::byte>(boundary_values[random.below(16)]));
                break;
            case 3:
                b.erase(b.begin() + at);
                break;
            default: {
                const auto length = std::min<std::ptrdiff_t>(1 + random.below(16), std::ssize(b) - at);
                const std::vector<std::byte> piece(b.begin() + at, b.begin() + at + length);
                if (b.size() < 5000)
                    b.insert(b.begin() + static_cast<std::ptrdiff_t>(random.below(static_cast<std::uint32_t>(b.size()))),
                             piece.begin(), piece.end());
            }
        }
    }
}

TEST(HidFuzz, MutatedDescriptors) {
    const auto seeds = corpus(false);
    ASSERT_FALSE(seeds.empty());
    Random random(11);
    for (int i = 0; i < mutations; ++i) {
        auto bytes = seeds[random.below(static_cast<std::uint32_t>(seeds.size()))];
        mutate(bytes, random);
        fuzz::descriptor(bytes);
    }
}

TEST(HidFuzz, RandomReports) {
    const auto seeds = corpus(false);
    Random random(12);
    for (int i = 0; i < mutations / 10; ++i) {
        auto descriptor = seeds[random.below(static_cast<std::uint32_t>(seeds.size()))];
        if (random.below(2) == 0) mutate(descriptor, random);
        std::vector<std::byte> bytes{static_cast<std::byte>(descriptor.size() & 0xffU),
                                     static_cast<std::byte>(descriptor.size() >> 8U)};
        bytes.insert(bytes.end(), descriptor.begin(), descriptor.end());
        for (std::uint32_t n = random.below(200); n > 0; --n)
            bytes.push_back(static_cast<std::byte>(random.below(random.below(2) == 0 ? 4 : 256)));
        fuzz::reports(bytes);
    }
}

TEST(HidFuzz, MutatedRecordings) {
    const auto seeds = corpus(true);
    Random random(13);
    for (int i = 0; i < mutations / 10; ++i) {
        auto bytes = seeds[random.below(static_cast<std::uint32_t>(seeds.size()))];
        mutate(bytes, random);
        fuzz::recording(bytes);
    }
}

/// The same with real devices and malformed descriptors as seeds, where they are on this machine; each seed first as it is.
TEST_F(HidCorpus, MutatedDescriptorsBreakNothing) {
    const auto seeds = descriptors();
    ASSERT_GE(seeds.size(), corpus_devices + corpus_seeds);
    for (const auto& seed : seeds) {
#ifndef SUREFOOT_SANITIZED
        allocated_now = allocated_peak = 0;
#endif
        fuzz::descriptor(seed);
#ifndef SUREFOOT_SANITIZED
        EXPECT_LT(allocated_peak, std::size_t{1} << 20U);
#endif
    }
    Random random(14);
    for (int i = 0; i < mutations / 5; ++i) {
        auto bytes = seeds[random.below(static_cast<std::uint32_t>(seeds.size()))];
        mutate(bytes, random);
        fuzz::descriptor(bytes);
    }
}

/// Time and memory of the most expensive descriptors: 4096 bytes of fields, collections, usages, ranges.
TEST(HidFuzz, TheWorstDescriptorsStayWithinTimeAndMemory) {
    const auto repeat = [](const char* head, const char* body, const char* tail) {
        auto bytes = hex(head);
        const auto b = hex(body), t = hex(tail);
        while (bytes.size() + b.size() + t.size() <= max_descriptor_bytes) bytes.insert(bytes.end(), b.begin(), b.end());
        bytes.insert(bytes.end(), t.begin(), t.end());
        return bytes;
    };
    auto deep = hex("");
    for (int i = 0; i < 2048; ++i) deep.push_back(std::byte{0xa0});
    for (int i = 0; i < 2048; ++i) deep.push_back(std::byte{0xc0});
    const std::vector<std::byte> worst[] = {
        repeat("05 01 09 04 a1 01 75 01 95 01 25 01", "08 80", "c0"),  // most fields
        repeat("05 01 09 04 a1 01 75 01 95 01 25 01", "85 01 08 80 85 02 08 80 85 03 08 80", "c0"),
        repeat("05 09 09 04 a1 01 75 01 25 01", "08", "96 00 30 81 02 c0"),                    // most usages
        hex("05 01 09 04 a1 01 05 09 75 01 25 01 19 01 2a 00 30 96 00 20 81 02 c0"),           // most buttons
        hex("05 01 09 04 a1 01 75 08 15 00 25 7f 09 30 96 00 20 81 02 c0"),                    // most axes, of one name
        repeat("05 01 09 04 a1 01 05 07 75 10 95 01 26 00 30", "19 00 2a ff 2f 81 00", "c0"),  // most keys in arrays
        repeat("05 01 09 04 a1 01 75 08 95 08 25 7f", "a1 00 09 30 09 31 81 02", "c0"),        // unclosed: refused late
        repeat("05 09 09 04 a1 01 75 01 25 01", "19 01 2a 00 2f 80", "c0"),                    // widest arrays
        repeat("05 09 09 04 a1 01 74 96 00 30", "09 01 81 02", "c0"),                          // most elements, of no bits
        repeat("05 01 09 04 a1 01 75 01 95 01 25 01", "a0 08 80 c0", "c0"),
        deep,
    };
    for (const auto& bytes : worst) {
        double best_ms = 1e9;
        for (int repetition = 0; repetition < 5; ++repetition) {
            const auto start = std::chrono::steady_clock::now();
            fuzz::descriptor(bytes);
            best_ms =
                std::min(best_ms, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
        }
#ifndef SUREFOOT_SANITIZED
        allocated_now = allocated_peak = 0;
        fuzz::descriptor(bytes);
        const std::size_t describing = allocated_peak;
        Layout layout;
        (void)parse_descriptor(bytes, layout);
        const HidDevice d = describe_device(std::move(layout), {});
        allocated_now = allocated_peak = 0;
        const ReportDecoder decoder(d);
        std::printf("worst %zu: %.2f ms, %zu KiB, decoder %zu KiB\n", bytes.size(), best_ms, describing / 1024,
                    allocated_peak / 1024);
        EXPECT_LT(best_ms, 10.0);
        EXPECT_LT(describing + allocated_peak, std::size_t{1} << 20U);
#else
        (void)best_ms;
#endif
    }
}

}  // namespace
}  // namespace surefoot::input
