// Errors as values: every error names the place, the problem, and the remedy.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace surefoot {

/// The kind of a failure. Programs and labels of metrics use it, and never the words of a sentence.
enum class ErrorKind : std::uint8_t {
    failed,         ///< no kind of its own
    misuse,         ///< an option, argument or setting that cannot be taken
    not_found,      ///< a file, device, name or command that is not there
    unreadable,     ///< it is there and cannot be read
    unwritable,     ///< it cannot be created, written or replaced
    damaged,        ///< content that breaks its format: bytes, lines, checksums
    unsupported,    ///< valid, and this version or this driver cannot do it
    out_of_limits,  ///< too large, too many, too small
    no_memory,
    no_device,     ///< graphics, input or GPIO hardware that does not answer
    no_real_time,  ///< the machine refuses what real time needs
    stopped,       ///< the user ended it
};
/// "not_found": the name of a kind in JSON and metrics.
std::string_view name_of(ErrorKind kind);

/// "." if the sentence still needs its full stop, else nothing.
std::string_view full_stop_after(std::string_view sentence);

/// What went wrong, for a person who has to correct it. Printed as "place: What happened. What to do."
struct Error {
    std::string place;   ///< file, and line, key or byte offset where known
    std::string what;    ///< a whole sentence, without its full stop
    std::string remedy;  ///< what the user can do: a whole sentence, without its full stop; may be empty
    ErrorKind kind = ErrorKind::failed;

    [[nodiscard]] std::string text() const;
};

/// A value or an Error. std::expected is not usable here: clang 14 refuses libstdc++ 12's.
template <class T>
class [[nodiscard]] Result {
public:
    Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}      // NOLINT: implicit by design
    Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT: implicit by design

    [[nodiscard]] bool ok() const { return state_.index() == 0; }
    explicit operator bool() const { return ok(); }

    [[nodiscard]] T& value() & { return std::get<0>(state_); }
    [[nodiscard]] const T& value() const& { return std::get<0>(state_); }
    [[nodiscard]] T&& value() && { return std::get<0>(std::move(state_)); }
    [[nodiscard]] const Error& error() const { return std::get<1>(state_); }

    T& operator*() & { return value(); }
    const T& operator*() const& { return value(); }
    T&& operator*() && { return std::move(*this).value(); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }

private:
    std::variant<T, Error> state_;
};

/// Success without a value, or an Error.
template <>
class [[nodiscard]] Result<void> {
public:
    Result() = default;
    Result(Error error) : error_(std::move(error)) {}  // NOLINT: implicit by design

    [[nodiscard]] bool ok() const { return !error_.has_value(); }
    explicit operator bool() const { return ok(); }
    [[nodiscard]] const Error& error() const { return *error_; }

private:
    std::optional<Error> error_;
};

}  // namespace surefoot
