// libdrm and libgbm, loaded at run time: what a screen without a window system is driven by.
#pragma once

#include <gbm.h>
#include <xf86drm.h>
#include <xf86drmMode.h>

#include "render/gl/api.hpp"

namespace surefoot::gl {

// X(member, function of libdrm)
#define SUREFOOT_DRM_FUNCTIONS(X)                        \
    X(AtomicAddProperty, drmModeAtomicAddProperty)       \
    X(AtomicAlloc, drmModeAtomicAlloc)                   \
    X(AtomicCommit, drmModeAtomicCommit)                 \
    X(AtomicFree, drmModeAtomicFree)                     \
    X(AddFB2, drmModeAddFB2)                             \
    X(CreatePropertyBlob, drmModeCreatePropertyBlob)     \
    X(CrtcGetSequence, drmCrtcGetSequence)               \
    X(DestroyPropertyBlob, drmModeDestroyPropertyBlob)   \
    X(FreeConnector, drmModeFreeConnector)               \
    X(FreeEncoder, drmModeFreeEncoder)                   \
    X(FreeObjectProperties, drmModeFreeObjectProperties) \
    X(FreePlane, drmModeFreePlane)                       \
    X(FreePlaneResources, drmModeFreePlaneResources)     \
    X(FreeProperty, drmModeFreeProperty)                 \
    X(FreeResources, drmModeFreeResources)               \
    X(GetConnector, drmModeGetConnector)                 \
    X(GetConnectorCurrent, drmModeGetConnectorCurrent)   \
    X(GetEncoder, drmModeGetEncoder)                     \
    X(GetPlane, drmModeGetPlane)                         \
    X(GetPlaneResources, drmModeGetPlaneResources)       \
    X(GetProperty, drmModeGetProperty)                   \
    X(GetResources, drmModeGetResources)                 \
    X(Ioctl, drmIoctl)                                   \
    X(IsMaster, drmIsMaster)                             \
    X(ObjectGetProperties, drmModeObjectGetProperties)   \
    X(RmFB, drmModeRmFB)                                 \
    X(SetClientCap, drmSetClientCap)                     \
    X(SetMaster, drmSetMaster)

/// Pointers to the functions of libdrm.
struct Drm {
#define SUREFOOT_DRM_MEMBER(name, function) decltype(&function) name = nullptr;
    SUREFOOT_DRM_FUNCTIONS(SUREFOOT_DRM_MEMBER)
#undef SUREFOOT_DRM_MEMBER
};

/// Pointers to the functions of libgbm.
struct Gbm {
    decltype(&gbm_create_device) CreateDevice = nullptr;
    decltype(&gbm_device_destroy) DestroyDevice = nullptr;
    decltype(&gbm_surface_create) CreateSurface = nullptr;
    decltype(&gbm_surface_destroy) DestroySurface = nullptr;
    decltype(&gbm_surface_lock_front_buffer) LockFrontBuffer = nullptr;
    decltype(&gbm_surface_release_buffer) ReleaseBuffer = nullptr;
    decltype(&gbm_bo_get_handle) BufferHandle = nullptr;
    decltype(&gbm_bo_get_stride) BufferStride = nullptr;
};

Result<Drm> load_drm();
Result<Gbm> load_gbm();

}  // namespace surefoot::gl
