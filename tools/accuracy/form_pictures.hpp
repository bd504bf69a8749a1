// Pictures of a model's forms: each form of a node beside full detail, with its error, look, cost and bytes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/gl/backends.hpp"
#include "render/model/model.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"

namespace surefoot::accuracy {

constexpr std::uint32_t form_picture_px = 192;  ///< side of a picture; a pixel is one of a walk at 1280x720

/// What is drawn.
struct FormPicturesRequest {
    std::string model_file, state_dir;
    std::string backend{gl::usual_backend};
    std::uint32_t max_nodes = 60;  ///< at most so many nodes, spread over the levels of the tree; 0: all
    std::string name;              ///< only nodes whose name contains this; empty: all
};

/// One form of a node. Costs are predicted for a walk at 1280x720, in us.
struct DrawnForm {
    std::string kind;  ///< of model::forms
    std::uint32_t triangles = 0;
    double error_m = 0;
    bool full_detail = false;
    model::PictureLoss loss;                 ///< zero where the model has none
    double close_us = 0, close_psnr_db = 0;  ///< from DrawnNode::close_m; infinite: equal to full detail
    double served_m = 0;                     ///< eye to box: where error_m is two pixels; 0: not drawn there
    double served_us = 0, full_us = 0;       ///< there, and of full detail there
    std::uint64_t bytes = 0;                 ///< vertices, indices, and the textures of a box with pictures
    std::string close, served, full;         ///< pictures as data URIs: close, at served_m, and full detail there; may be empty
    std::uint32_t served_px = 0;             ///< side of the last two
};

/// A node with its forms, coarse to fine.
struct DrawnNode {
    model::Index node = 0;
    std::string name, kind;
    std::uint32_t level = 0;      ///< of the tree, from 0
    std::uint64_t triangles = 0;  ///< of full detail
    double size_m = 0;            ///< the diagonal of its box
    double close_m = 0;           ///< eye to box: where the node fills the picture
    std::uint32_t same = 1;       ///< nodes of this level with these forms: instances of one mesh
    std::string full;             ///< full detail from close_m, a data URI
    double full_us = 0;           ///< its predicted cost
    std::vector<DrawnForm> forms;
};

/// All that the page shows.
struct FormPictures {
    std::string model, renderer, machine, uncalibrated;
    std::uint32_t nodes = 0, distinct = 0;  ///< of the model; with forms that no other node of the level has
    std::vector<DrawnNode> drawn;           ///< by level
};

/// Draws on the calling thread. Errors: of the model and the backend; no node of that name; stopped by the user.
Result<FormPictures> draw_forms(const FormPicturesRequest& request, const Progress& progress);

/// One row a form.
std::string forms_csv(const FormPictures& pictures);
/// Whether the page could be written to `dir` now. Call it before drawing.
Result<void> probe_forms_page(const std::string& dir);
/// index.html, which holds all pictures, and forms.csv.
Result<void> write_forms_page(const std::string& dir, const FormPictures& pictures);

}  // namespace surefoot::accuracy
