// A strict reader of Prometheus' text format 0.0.4, for tests: what it refuses, a scraper may refuse or, worse, misread.
#pragma once

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace surefoot::test {

struct Exposed {
    struct Family {
        std::string help, type;
    };
    std::map<std::string, Family> families;
    std::map<std::string, double> samples;                   ///< by name and labels as written
    std::map<std::string, std::string> family_of;            ///< of a sample
    std::map<std::string, std::set<std::string>> values_of;  ///< of "family/label"
    std::vector<std::string> problems;

    [[nodiscard]] double at(const std::string& sample) const {
        const auto found = samples.find(sample);
        return found == samples.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
    }
};

class ExpositionReader {
public:
    static Exposed read(const std::string& text) {
        ExpositionReader r;
        if (text.empty() || text.back() != '\n') r.problem("does not end with a newline");
        for (std::size_t at = 0; at < text.size();) {
            const std::size_t end = std::min(text.find('\n', at), text.size());
            r.line(text.substr(at, end - at));
            at = end + 1;
        }
        r.end_family();
        return std::move(r.out_);
    }

private:
    static bool name_ok(std::string_view name, bool colons) {
        if (name.empty() || (name[0] >= '0' && name[0] <= '9')) return false;
        for (const char c : name)
            if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || (colons && c == ':')))
                return false;
        return true;
    }
    static bool number(std::string_view text, double& value) {
        if (text == "+Inf" || text == "-Inf") {
            value = text[0] == '-' ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
            return true;
        }
        if (text == "NaN") {
            value = std::numeric_limits<double>::quiet_NaN();
            return true;
        }
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        return error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
    }
    void problem(const std::string& what) { out_.problems.push_back(what + ": " + line_); }

    void line(const std::string& text) {
        line_ = text;
        if (text.empty()) return problem("empty line");
        if (text.starts_with("# HELP ")) return help(text.substr(7));
        if (text.starts_with("# TYPE ")) return type(text.substr(7));
        if (text[0] == '#') return problem("a comment that says nothing");
        sample(text);
    }
    void help(const std::string& rest) {
        end_family();
        const std::size_t space = rest.find(' ');
        name_ = rest.substr(0, space);
        if (!name_ok(name_, true)) problem("no metric name");
        if (out_.families.contains(name_)) problem("a family twice");
        if (space == std::string::npos || rest.size() < space + 10) problem("a HELP that says nothing");
        out_.families[name_].help = space == std::string::npos ? "" : rest.substr(space + 1);
    }
    void type(const std::string& rest) {
        const std::size_t space = rest.find(' ');
        if (rest.substr(0, space) != name_) return problem("TYPE does not follow its HELP");
        if (!out_.families[name_].type.empty() || any_) problem("TYPE twice, or after a sample");
        const std::string type = space == std::string::npos ? "" : rest.substr(space + 1);
        if (type != "counter" && type != "gauge" && type != "histogram" && type != "summary") problem("an unknown type");
        if ((type == "counter") != name_.ends_with("_total")) problem("_total is for counters, and for all of them");
        out_.families[name_].type = type;
    }
    void sample(const std::string& text) {
        const std::size_t brace = text.find('{');
        const std::size_t name_end = std::min(brace, text.find(' '));
        if (name_end == std::string::npos) return problem("no value");
        const std::string name = text.substr(0, name_end);
        std::map<std::string, std::string> labels;
        std::size_t value_at = name_end;
        if (brace == name_end && !read_labels(text, value_at, labels)) return problem("labels that are none");
        double value = 0;
        if (value_at >= text.size() || text[value_at] != ' ' || !number(std::string_view(text).substr(value_at + 1), value))
            return problem("a value that is none");
        const std::string key = text.substr(0, value_at);
        if (out_.samples.contains(key)) problem("a sample twice");
        out_.samples[key] = value;
        out_.family_of[key] = name_;
        for (const auto& [label, of] : labels) out_.values_of[name_ + "/" + label].insert(of);
        any_ = true;
        const std::string& type = out_.families[name_].type;
        if (type == "histogram") return bucket(name, labels, value);
        if (type == "summary" && (name == name_ + "_sum" || name == name_ + "_count")) return;
        if (labels.contains("quantile") != (type == "summary")) problem("quantile is for summaries, and for all of them");
        if (name != name_) problem("a sample of another family");
        if (type == "counter" && !(value >= 0)) problem("a counter below zero");
    }
    static bool read_labels(const std::string& text, std::size_t& at, std::map<std::string, std::string>& labels) {
        for (++at;;) {
            const std::size_t equals = text.find('=', at);
            if (equals == std::string::npos || equals + 1 >= text.size() || text[equals + 1] != '"') return false;
            const std::string label = text.substr(at, equals - at);
            if (!name_ok(label, false) || label.starts_with("__") || labels.contains(label)) return false;
            std::string value;
            for (at = equals + 2; at < text.size() && text[at] != '"'; ++at) {
                if (text[at] == '\\' && ++at < text.size() && text[at] != '\\' && text[at] != '"' && text[at] != 'n')
                    return false;
                if (at < text.size()) value += text[at];
            }
            if (at >= text.size()) return false;
            labels[label] = value;
            ++at;
            if (at < text.size() && text[at] == '}') {
                ++at;
                return true;
            }
            if (at >= text.size() || text[at++] != ',') return false;
        }
    }
    void bucket(const std::string& name, std::map<std::string, std::string> labels, double value) {
        const std::string suffix = name.starts_with(name_) ? name.substr(name_.size()) : "?";
        if (suffix == "_bucket") {
            double le = 0;
            if (!labels.contains("le") || !number(labels["le"], le)) return problem("a bucket without an edge");
            if (buckets_ > 0 && !(le > le_)) problem("edges do not rise");
            if (buckets_ > 0 && !(value >= count_)) problem("a histogram is not cumulative");
            ++buckets_;
            le_ = le;
            count_ = value;
        } else if (suffix == "_sum") {
            if (buckets_ == 0 || !std::isinf(le_)) problem("no +Inf bucket before the sum");
            sum_seen_ = true;
        } else if (suffix == "_count") {
            if (!sum_seen_ || value != count_) problem("count is not that of the +Inf bucket");
            buckets_ = 0;
            sum_seen_ = false;
        } else {
            problem("no part of a histogram");
        }
    }
    void end_family() {
        if (!name_.empty() && !any_) problem("a family without samples before");
        if (buckets_ != 0) problem("a histogram that does not end");
        any_ = false;
        name_.clear();
    }
    Exposed out_;
    std::string line_, name_;
    bool any_ = false, sum_seen_ = false;
    int buckets_ = 0;
    double le_ = 0, count_ = 0;
};

/// Nothing that must not go back has gone back from one scrape to the next, and no series has vanished.
inline void expect_monotone(const Exposed& before, const Exposed& after) {
    for (const auto& [key, value] : before.samples) {
        const std::string& type = before.families.at(before.family_of.at(key)).type;
        if (type == "gauge" || key.find("{quantile=") != std::string::npos) continue;
        EXPECT_TRUE(after.samples.contains(key)) << key << " has vanished";
        EXPECT_GE(after.at(key), value) << key;
    }
}

}  // namespace surefoot::test
