// Presenting: the shown target goes to the window or the screen (gl_device.hpp).
#include "render/gl/gl_device.hpp"

namespace surefoot::gl {

/// A screen shows the sky until the first picture is there.
void GlDevice::prepare_presenting() {
    const PixelRows rows = context_->pixel_rows();
    if (rows.first != nullptr) {
        copier_ = RowCopier(options_.viewport.width, options_.viewport.height, rows.surface);
        copied_pixels_.resize(std::size_t{options_.viewport.width} * options_.viewport.height);
    }
    if (rows.first == nullptr && !context_->presents_at_once()) return;
    gl_.BindFramebuffer(GL_FRAMEBUFFER, targets_.steps.front().framebuffer);
    clear_target();
    present();
}

rt::Shown GlDevice::present() {
    if (lost_) return {};
    const PixelRows rows = context_->pixel_rows();
    if (rows.first != nullptr) {
        fill_pixel_rows(rows);
    } else if (context_->has_window()) {
        fill_window();
    } else {
        return {rt::ShownBy::hand_over, 0, 0};
    }
    const rt::Shown shown = context_->present();
    lost_ = lost_ || context_->lost();
    gl_.BindFramebuffer(GL_FRAMEBUFFER, targets_.steps.front().framebuffer);
    return shown;
}

void GlDevice::fill_window() {
    const Surface surface = context_->surface();
    const std::uint32_t width = options_.viewport.width, height = options_.viewport.height;
    copy_to_window(
        surface.width > 0 ? fit_picture(width, height, surface.width, surface.height) : fit_picture(width, height, width, height),
        surface.half_turn);
    if (context_->presents_at_once()) gl_.Finish();
}

void GlDevice::copy_to_window(const FittedPicture& fit, bool half_turn) {
    const auto width = static_cast<GLint>(options_.viewport.width), height = static_cast<GLint>(options_.viewport.height);
    gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, targets_.steps.front().framebuffer);
    gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    const Surface surface = context_->surface();
    if (static_cast<std::uint32_t>(fit.width) < surface.width || static_cast<std::uint32_t>(fit.height) < surface.height) {
        gl_.ClearColor(0, 0, 0, 1);
        gl_.Clear(GL_COLOR_BUFFER_BIT);
    }
    const GLint left = fit.x, right = fit.x + fit.width, low = fit.y, high = fit.y + fit.height;
    const GLenum filter = fit.width == width && fit.height == height ? GL_NEAREST : GL_LINEAR;
    if (half_turn)
        gl_.BlitFramebuffer(0, 0, width, height, right, high, left, low, GL_COLOR_BUFFER_BIT, filter);
    else
        gl_.BlitFramebuffer(0, 0, width, height, left, low, right, high, GL_COLOR_BUFFER_BIT, filter);
}

/// The targets' own order of channels, so reading only copies.
void GlDevice::fill_pixel_rows(const PixelRows& rows) {
    const Target& shown = targets_.steps.front();
    gl_.BindFramebuffer(GL_FRAMEBUFFER, shown.framebuffer);
    gl_.PixelStorei(GL_PACK_ALIGNMENT, 4);
    gl_.ReadPixels(0, 0, shown.width, shown.height, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV, copied_pixels_.data());
    copier_.copy(copied_pixels_, rows);
}

}  // namespace surefoot::gl
