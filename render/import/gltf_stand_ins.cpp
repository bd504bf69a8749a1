// Which glTF nodes are stand-ins: MSFT_lod, and names in extras.

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "render/import/gltf_parts.hpp"

namespace surefoot::importer {
namespace {

std::string name_of(const tinygltf::Model& model, std::size_t node) {
    return model.nodes[node].name.empty() ? fmt::format("node {}", node) : model.nodes[node].name;
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
        if (const auto lod = from.extensions.find("MSFT_lod"); lod != from.extensions.end()) {
            const bool has_ids = lod->second.IsObject() && lod->second.Has("ids") && lod->second.Get("ids").IsArray();
            if (!has_ids) left_out(node, "MSFT_lod", "it has no list of ids");
            for (std::size_t i = 0; has_ids && i < lod->second.Get("ids").ArrayLen(); ++i) {
                const tinygltf::Value& id = lod->second.Get("ids").Get(static_cast<int>(i));
                const int other = id.IsNumber() ? id.GetNumberAsInt() : -1;
                add(node, other, id.IsNumber() ? fmt::format("node {}", other) : "?", false);
            }
        }
        if (!from.extras.IsObject() || !from.extras.Has("stand_ins")) return;
        const tinygltf::Value& names = from.extras.Get("stand_ins");
        if (!names.IsArray()) return of_name(node, names);
        for (std::size_t i = 0; i < names.ArrayLen(); ++i) of_name(node, names.Get(static_cast<int>(i)));
    }
    [[nodiscard]] const std::vector<StandInClaim>& claims() const { return claims_; }

private:
    void of_name(std::size_t node, const tinygltf::Value& value) {
        const std::string name = value.IsString() ? value.Get<std::string>() : "";
        if (name.empty()) return left_out(node, "extras.stand_ins", "it is no name");
        const auto found = std::find_if(model_.nodes.begin(), model_.nodes.end(),
                                        [&](const tinygltf::Node& other) { return other.name == name; });
        add(node, found == model_.nodes.end() ? -1 : static_cast<int>(found - model_.nodes.begin()), name, true);
    }

    void add(std::size_t node, int stand_in, const std::string& name, bool same_frame) {
        if (stand_in < 0 || static_cast<std::size_t>(stand_in) >= model_.nodes.size())
            return left_out(node, name, "there is no such node");
        if (is_below(model_, node, static_cast<std::size_t>(stand_in))) return left_out(node, name, "the object is a part of it");
        const int mesh = model_.nodes[node].mesh;
        if (mesh < 0) return left_out(node, name, "the object has no mesh of its own");
        // A chain of stand-ins would hide what it begins with.
        for (const StandInClaim& other : claims_) {
            if (is_below(model_, node, static_cast<std::size_t>(other.stand_in)))
                return left_out(node, name, "its object is a stand-in itself");
            if (is_below(model_, static_cast<std::size_t>(other.object), static_cast<std::size_t>(stand_in)))
                return left_out(node, name, "it has a stand-in of its own");
        }
        // A mesh has one set of stand-ins, whatever number of nodes places it.
        const auto first = first_with_.try_emplace(mesh, node).first->second;
        claims_.push_back({static_cast<int>(node), stand_in, same_frame, first == node});
    }

    void left_out(std::size_t node, const std::string& name, const std::string& why) {
        warnings_.push_back(fmt::format("Stand-in '{}' of '{}' is left out: {}", name, name_of(model_, node), why));
    }

    const tinygltf::Model& model_;
    std::vector<std::string>& warnings_;
    std::vector<StandInClaim> claims_;
    std::map<int, std::size_t> first_with_;  ///< by mesh: the first node that has stand-ins
};

}  // namespace

std::vector<StandInClaim> stand_in_claims(const tinygltf::Model& model, std::vector<std::string>& warnings) {
    Finder finder(model, warnings);
    for (std::size_t node = 0; node < model.nodes.size(); ++node) finder.of_node(node);
    return finder.claims();
}

}  // namespace surefoot::importer
