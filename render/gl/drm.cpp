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
    const bool found =
        library->get(drm.AtomicAddProperty, "drmModeAtomicAddProperty") && library->get(drm.AtomicAlloc, "drmModeAtomicAlloc") &&
        library->get(drm.AtomicCommit, "drmModeAtomicCommit") && library->get(drm.AtomicFree, "drmModeAtomicFree") &&
        library->get(drm.AddFB2, "drmModeAddFB2") && library->get(drm.CreatePropertyBlob, "drmModeCreatePropertyBlob") &&
        library->get(drm.CrtcGetSequence, "drmCrtcGetSequence") &&
        library->get(drm.DestroyPropertyBlob, "drmModeDestroyPropertyBlob") &&
        library->get(drm.FreeConnector, "drmModeFreeConnector") && library->get(drm.FreeEncoder, "drmModeFreeEncoder") &&
        library->get(drm.FreeObjectProperties, "drmModeFreeObjectProperties") &&
        library->get(drm.FreePlane, "drmModeFreePlane") && library->get(drm.FreePlaneResources, "drmModeFreePlaneResources") &&
        library->get(drm.FreeProperty, "drmModeFreeProperty") && library->get(drm.FreeResources, "drmModeFreeResources") &&
        library->get(drm.GetConnector, "drmModeGetConnector") &&
        library->get(drm.GetConnectorCurrent, "drmModeGetConnectorCurrent") &&
        library->get(drm.GetEncoder, "drmModeGetEncoder") && library->get(drm.GetPlane, "drmModeGetPlane") &&
        library->get(drm.GetPlaneResources, "drmModeGetPlaneResources") && library->get(drm.GetProperty, "drmModeGetProperty") &&
        library->get(drm.GetResources, "drmModeGetResources") && library->get(drm.Ioctl, "drmIoctl") &&
        library->get(drm.IsMaster, "drmIsMaster") && library->get(drm.ObjectGetProperties, "drmModeObjectGetProperties") &&
        library->get(drm.RmFB, "drmModeRmFB") && library->get(drm.SetClientCap, "drmSetClientCap") &&
        library->get(drm.SetMaster, "drmSetMaster");
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
