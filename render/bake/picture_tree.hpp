// Pictures of the full detail of all clusters from one direction: each is put together from its children's, bottom-up.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "render/bake/form_picture.hpp"

namespace surefoot::bake {

/// Calls body(0) to body(count - 1) in any order, on any threads; each result is of its index alone.
using ForAll = std::function<void(std::size_t, const std::function<void(std::size_t)>&)>;

/// A cluster's full detail may be the whole model. Drawn from its children's pictures, a leaf is drawn once a direction.
class PictureTree {
public:
    explicit PictureTree(const model::Model& model);

    /// What is done with a cluster's picture, on any thread, once for each cluster. False: stop.
    using Use = std::function<bool(model::Index node, const FormPicture& full)>;
    /// From where, about how many samples across each cluster (view_of), whether by the sun, and whether samples keep their
    /// sources.
    struct View {
        Direction from;
        std::uint32_t pixels = 64;
        bool lit = true;
        bool keeps_sources = false;
    };
    /// All clusters. False: use() stopped it. One call at a time.
    bool look(const View& view, const ForAll& for_all, const Use& use);

    [[nodiscard]] std::size_t clusters() const { return clusters_; }
    [[nodiscard]] const dvec3& middle() const { return middle_; }

private:
    [[nodiscard]] std::vector<model::Index> clusters_below(model::Index root) const;
    void draw(model::Index node, const View& view);

    const model::Model& model_;
    dvec3 middle_{0.0};
    std::vector<model::Index> task_roots_;          ///< clusters below which nothing else is a task's
    std::vector<std::vector<model::Index>> upper_;  ///< the other clusters, by height; low ones first
    std::vector<FormPicture> pictures_;             ///< by node: of clusters whose parent is still to come
    std::size_t clusters_ = 0;
};

}  // namespace surefoot::bake
