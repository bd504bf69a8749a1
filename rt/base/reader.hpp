// A bounded little-endian reader over bytes: never reads past its end, never trusts a count.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

namespace surefoot {

/// After the first read beyond the end, failed() stays true and every value read is zero.
class ByteReader {
public:
    explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    template <class T>
    requires std::is_trivially_copyable_v<T> T read() {
        T value{};
        if (!take(sizeof(T))) return value;
        std::memcpy(&value, bytes_.data() + at_ - sizeof(T), sizeof(T));
        return value;
    }
    /// A view of the next n bytes; empty on failure.
    std::span<const std::byte> bytes(std::uint64_t n) {
        if (!take(n)) return {};
        return bytes_.subspan(at_ - n, n);
    }
    void skip(std::uint64_t n) { (void)take(n); }
    [[nodiscard]] bool failed() const { return failed_; }
    [[nodiscard]] std::uint64_t at() const { return at_; }
    [[nodiscard]] std::uint64_t left() const { return bytes_.size() - at_; }

private:
    bool take(std::uint64_t n) {
        if (failed_ || n > bytes_.size() - at_) {
            failed_ = true;
            return false;
        }
        at_ += n;
        return true;
    }
    std::span<const std::byte> bytes_;
    std::uint64_t at_ = 0;
    bool failed_ = false;
};

}  // namespace surefoot
