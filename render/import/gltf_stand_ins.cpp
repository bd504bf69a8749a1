// Which glTF nodes are stand-ins: MSFT_lod, and names in extras.

#include <algorithm>

#include <fmt/format.h>

#include "render/import/gltf_parts.hpp"

namespace surefoot::importer {
namespace {

std::string name_of(const tinygltf::Model& model, std::size_t node) {
    return model.nodes[node].name.empty() ? fmt::format("node {}", node) : model.nodes[node].name;
}

/// The texts of an extra that is one text or a list of them.
std::vector<std::string> texts_of(const tinygltf::Value& value) {
    std::vector<std::string> out;
    if (value.IsString()) out.push_back(value.Get<std::string>());
    for (std::size_t i = 0; value.IsArray() && i < value.ArrayLen(); ++i) {
        const tinygltf::Value& one = value.Get(static_cast<int>(i));
        if (one.IsString()) out.push_back(one.Get<std::string>());
    }
    return out;
}

bool is_below(const tinygltf::Model& model, std::size_t node, std::size_t root) {
    std::vector<bool> seen(model.nodes.size(), false);
    std::vector<std::size_t> open{root};
    while (!open.empty()) {
        const std::size_t at = open.back();
        open.pop_back();
        if (at == node) return true;
        if (seen[at]) continue;
        seen[at] = true;
        for (const int child : model.nodes[at].children)
            if (child >= 0 && static_cast<std::size_t>(child) < model.nodes.size())
                open.push_back(static_cast<std::size_t>(child));
    }
    return false;
}

class Finder {
public:
    Finder(const tinygltf::Model& model, std::vector<std::string>& warnings) : model_(model), warnings_(warnings) {}

    void of_node(std::size_t node) {
        const tinygltf::Node& from = model_.nodes[node];
        if (const auto lod = from.extensions.find("MSFT_lod"); lod != from.extensions.end() && lod->second.Has("ids")) {
            const tinygltf::Value& ids = lod->second.Get("ids");
            for (std::size_t i = 0; ids.IsArray() && i < ids.ArrayLen(); ++i) {
                const tinygltf::Value& id = ids.Get(static_cast<int>(i));
                add(node, id.IsNumber() ? id.GetNumberAsInt() : -1,
                    id.IsNumber() ? fmt::format("node {}", id.GetNumberAsInt()) : "?", false);
            }
        }
        if (!from.extras.IsObject() || !from.extras.Has("stand_ins")) return;
        for (const std::string& name : texts_of(from.extras.Get("stand_ins"))) {
            const auto found = std::find_if(model_.nodes.begin(), model_.nodes.end(),
                                            [&](const tinygltf::Node& other) { return other.name == name; });
            add(node, found == model_.nodes.end() ? -1 : static_cast<int>(found - model_.nodes.begin()), name, true);
        }
    }
    [[nodiscard]] const std::vector<StandInClaim>& claims() const { return claims_; }

private:
    void add(std::size_t node, int stand_in, const std::string& name, bool same_frame) {
        std::string why;
        if (stand_in < 0 || static_cast<std::size_t>(stand_in) >= model_.nodes.size())
            why = "there is no such node";
        else if (is_below(model_, node, static_cast<std::size_t>(stand_in)))
            why = "the object is a part of it";
        if (why.empty())
            claims_.push_back({static_cast<int>(node), stand_in, same_frame});
        else
            warnings_.push_back(fmt::format("Stand-in '{}' of '{}' is left out: {}", name, name_of(model_, node), why));
    }

    const tinygltf::Model& model_;
    std::vector<std::string>& warnings_;
    std::vector<StandInClaim> claims_;
};

}  // namespace

std::vector<StandInClaim> stand_in_claims(const tinygltf::Model& model, std::vector<std::string>& warnings) {
    Finder finder(model, warnings);
    for (std::size_t node = 0; node < model.nodes.size(); ++node) finder.of_node(node);
    return finder.claims();
}

}  // namespace surefoot::importer
