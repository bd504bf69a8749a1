// One streaming pass over an OSTF file: the tree of objects and where each leaf's triangles start (Selcuk 1997, appendix A).
#include <array>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string_view>

#include <fmt/format.h>

#include "render/import/ostf.hpp"
#include "rt/base/text.hpp"

namespace surefoot::importer {
namespace {

constexpr std::size_t chunk_bytes = 1U << 20U;
/// Names and numbers are short: a longer line is no OSTF, and would have to be kept whole.
constexpr std::size_t longest_line = 1U << 16U;
constexpr std::size_t deepest = 4096;
/// Normal, coordinate, colour, texture coordinate: one line each, three vertices.
constexpr std::uint64_t lines_a_triangle = 12;

struct CloseFile {
    void operator()(std::FILE* file) const { (void)std::fclose(file); }
};

/// Lines that are not blank, one at a time, from a window of fixed size.
class LineStream {
public:
    explicit LineStream(const std::string& file) : file_(std::fopen(file.c_str(), "rb")) {}
    [[nodiscard]] bool opened() const { return file_ != nullptr; }
    [[nodiscard]] std::uint64_t line() const { return line_; }
    [[nodiscard]] std::uint64_t offset() const { return offset_; }  ///< where the last line begins
    [[nodiscard]] std::uint64_t consumed() const { return consumed_; }
    [[nodiscard]] bool too_long() const { return too_long_; }

    /// False at the end of the file.
    bool next(std::string_view& text) {
        while (raw(text)) {
            std::size_t first = 0, last = text.size();
            while (first < last && static_cast<unsigned char>(text[first]) <= ' ') ++first;
            while (last > first && static_cast<unsigned char>(text[last - 1]) <= ' ') --last;
            text = text.substr(first, last - first);
            if (!text.empty()) return true;
        }
        return false;
    }

private:
    bool raw(std::string_view& text) {
        const char* end = find_end();
        if (end == nullptr) {
            if (!refill()) return last_line(text);
            end = find_end();
            if (end == nullptr && buffer_.size() - begin_ >= longest_line) {
                too_long_ = true;
                return false;
            }
            if (end == nullptr) return raw(text);
        }
        const char* start = buffer_.data() + begin_;
        take(text, static_cast<std::size_t>(end - start), 1);
        return true;
    }
    const char* find_end() const {
        if (begin_ == buffer_.size()) return nullptr;
        return static_cast<const char*>(std::memchr(buffer_.data() + begin_, '\n', buffer_.size() - begin_));
    }
    bool last_line(std::string_view& text) {
        if (begin_ == buffer_.size()) return false;
        take(text, buffer_.size() - begin_, 0);
        return true;
    }
    void take(std::string_view& text, std::size_t size, std::size_t newline) {
        text = std::string_view(buffer_.data() + begin_, size);
        begin_ += size + newline;
        offset_ = consumed_;
        consumed_ += size + newline;
        ++line_;
    }
    bool refill() {
        buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
        begin_ = 0;
        const std::size_t kept = buffer_.size();
        buffer_.resize(kept + chunk_bytes);
        const std::size_t got = std::fread(buffer_.data() + kept, 1, chunk_bytes, file_.get());
        buffer_.resize(kept + got);
        return got > 0;
    }

    std::unique_ptr<std::FILE, CloseFile> file_;
    std::vector<char> buffer_;
    std::size_t begin_ = 0;
    std::uint64_t line_ = 0, offset_ = 0, consumed_ = 0;
    bool too_long_ = false;
};

bool starts_number(std::string_view text) {
    const char c = text.front();
    return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.' || text.starts_with("nan") || text.starts_with("inf");
}

/// Three numbers and no more: the first line of a leaf without a texture's name.
bool is_normal_line(std::string_view text) {
    int numbers = 0;
    const char *at = text.data(), *end = text.data() + text.size();
    while (at != end) {
        double value = 0;
        const auto [last, code] = std::from_chars(*at == '+' ? at + 1 : at, end, value);
        if (code == std::errc::invalid_argument) return false;
        ++numbers;
        at = last;
        if (at != end && *at != ' ' && *at != '\t') return false;
        while (at != end && (*at == ' ' || *at == '\t')) ++at;
    }
    return numbers == 3;
}

class Indexer {
public:
    Indexer(const std::string& file, const Progress& progress) : lines_(file), progress_(progress) { index_.file = file; }

    Result<OstfIndex> run() {
        if (!lines_.opened())
            return Error{index_.file, "The file cannot be opened", "Check the name and its permissions", ErrorKind::unreadable};
        std::error_code code;
        total_ = std::filesystem::file_size(index_.file, code);
        std::string_view text;
        while (have_line_ || lines_.next(text)) {
            if (have_line_) text = held_;
            have_line_ = false;
            if (auto read = tag(text); !read) return read.error();
        }
        if (lines_.too_long()) return wrong("A line is longer than 64 KiB; this is not an OSTF file");
        if (!open_.empty())
            return wrong(fmt::format("The file is truncated: '{}' has no END_TAG", index_.objects[open_.back()].name));
        if (index_.objects.empty()) return wrong("The file holds no object: there is no START_TAG");
        return std::move(index_);
    }

private:
    Error wrong(std::string what) const {
        return {fmt::format("{}:{}", index_.file, lines_.line()), std::move(what), "Export the model again", ErrorKind::damaged};
    }

    Result<void> tag(std::string_view text) {
        if (text == "START_TAG") return object();
        if (text != "END_TAG")
            return wrong(fmt::format("The line '{}' stands where START_TAG or END_TAG belongs", text.substr(0, 40)));
        if (open_.empty()) return wrong("An END_TAG has no START_TAG");
        open_.pop_back();
        return {};
    }

    Result<void> object() {
        if (open_.size() >= deepest) return wrong(fmt::format("Objects are nested deeper than {}", deepest));
        if (!open_.empty() && index_.objects[open_.back()].triangles > 0)
            return wrong(fmt::format("Object '{}' holds triangles and objects", index_.objects[open_.back()].name));
        if (index_.objects.size() >= none) return wrong("The file holds too many objects");
        OstfObject object;
        object.line = lines_.line();
        object.parent = open_.empty() ? none : open_.back();
        std::string_view text;
        if (!lines_.next(text)) return wrong("The file is truncated after START_TAG");
        object.name = text;
        if (!lines_.next(text)) return wrong(fmt::format("The file is truncated in '{}'", object.name));
        const auto triangles = surefoot::number_in<decltype(object.triangles)>(text);
        if (!triangles)
            return wrong(fmt::format("The text '{}' is not the number of triangles of '{}'", text.substr(0, 40), object.name));
        object.triangles = *triangles;
        if (object.triangles > total_ / (lines_a_triangle * 4))
            return wrong(
                fmt::format("Object '{}' announces {} triangles, more than the file can hold", object.name, object.triangles));
        open_.push_back(static_cast<Index>(index_.objects.size()));
        index_.objects.push_back(std::move(object));
        return index_.objects.back().triangles > 0 ? leaf(index_.objects.back()) : container();
    }

    /// A container may or may not have a line for a texture that it does not have.
    Result<void> container() {
        std::string_view text;
        if (!lines_.next(text)) return {};
        if (text == "START_TAG" || text == "END_TAG") hold(text);
        return {};
    }

    Result<void> leaf(OstfObject& object) {
        std::string_view text;
        if (!lines_.next(text)) return wrong(fmt::format("The file is truncated in '{}'", object.name));
        std::uint64_t skip = object.triangles * lines_a_triangle;
        if (is_normal_line(text)) {
            object.offset = lines_.offset();
            --skip;
        } else if (text == "START_TAG" || text == "END_TAG") {
            return wrong(fmt::format("Object '{}' ends before its {} triangles", object.name, object.triangles));
        } else {
            object.texture = text;
            object.offset = lines_.consumed();
        }
        for (std::uint64_t i = 0; i < skip; ++i) {
            if (!lines_.next(text))
                return wrong(
                    fmt::format("The file is truncated in '{}': {} lines of triangles are missing", object.name, skip - i));
            if (!starts_number(text))
                return wrong(fmt::format("The line '{}' stands among the triangles of '{}'", text.substr(0, 40), object.name));
            if ((i & 0xffffU) != 0) continue;
            if (progress_.stopped()) return Error{index_.file, "The import was stopped", "", ErrorKind::stopped};
            progress_.update("index", static_cast<double>(lines_.consumed()) / static_cast<double>(total_));
        }
        return {};
    }

    void hold(std::string_view text) {
        held_ = text;
        have_line_ = true;
    }

    LineStream lines_;
    const Progress& progress_;
    OstfIndex index_;
    std::vector<Index> open_;
    std::string held_;
    bool have_line_ = false;
    std::uint64_t total_ = 0;
};

}  // namespace

Result<OstfIndex> index_ostf(const std::string& file, const Progress& progress) { return Indexer(file, progress).run(); }

}  // namespace surefoot::importer
