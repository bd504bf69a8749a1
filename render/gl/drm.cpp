// Loading libdrm and libgbm (drm.hpp).
#include "render/gl/drm.hpp"

namespace surefoot::gl {

namespace {

Error incomplete(const char* library, const char* package) {
    return Error{library, "The library lacks functions", std::string("Install a current ") + package + " (Debian 12 or newer)",
                 ErrorKind::unsupported};
}

}  // namespace

Result<Drm> load_drm() {
    auto library = Library::open("libdrm.so.2", "libdrm2");
    if (!library) return library.error();
    Drm drm;
    bool found = true;
#define SUREFOOT_DRM_LOAD(name, function) found = library->get(drm.name, #function) && found;
    SUREFOOT_DRM_FUNCTIONS(SUREFOOT_DRM_LOAD)
#undef SUREFOOT_DRM_LOAD
    if (!found) return incomplete("libdrm.so.2", "libdrm2");
    return drm;
}

Result<Gbm> load_gbm() {
    auto library = Library::open("libgbm.so.1", "libgbm1");
    if (!library) return library.error();
    Gbm gbm;
    const bool found =
        library->get(gbm.CreateDevice, "gbm_create_device") && library->get(gbm.DestroyDevice, "gbm_device_destroy") &&
        library->get(gbm.CreateSurface, "gbm_surface_create") && library->get(gbm.DestroySurface, "gbm_surface_destroy") &&
        library->get(gbm.LockFrontBuffer, "gbm_surface_lock_front_buffer") &&
        library->get(gbm.ReleaseBuffer, "gbm_surface_release_buffer") && library->get(gbm.BufferHandle, "gbm_bo_get_handle") &&
        library->get(gbm.BufferStride, "gbm_bo_get_stride");
    if (!found) return incomplete("libgbm.so.1", "libgbm1");
    return gbm;
}

}  // namespace surefoot::gl
