// libdrm and libgbm, loaded at run time: what a screen without a window system is driven by.
#pragma once

#include <gbm.h>
#include <xf86drm.h>
#include <xf86drmMode.h>

#include "render/gl/api.hpp"

namespace surefoot::gl {

/// Pointers to the functions of libdrm.
struct Drm {
    decltype(&drmModeAtomicAddProperty) AtomicAddProperty = nullptr;
    decltype(&drmModeAtomicAlloc) AtomicAlloc = nullptr;
    decltype(&drmModeAtomicCommit) AtomicCommit = nullptr;
    decltype(&drmModeAtomicFree) AtomicFree = nullptr;
    decltype(&drmModeAddFB2) AddFB2 = nullptr;
    decltype(&drmModeCreatePropertyBlob) CreatePropertyBlob = nullptr;
    decltype(&drmCrtcGetSequence) CrtcGetSequence = nullptr;
    decltype(&drmModeDestroyPropertyBlob) DestroyPropertyBlob = nullptr;
    decltype(&drmModeFreeConnector) FreeConnector = nullptr;
    decltype(&drmModeFreeEncoder) FreeEncoder = nullptr;
    decltype(&drmModeFreeObjectProperties) FreeObjectProperties = nullptr;
    decltype(&drmModeFreePlane) FreePlane = nullptr;
    decltype(&drmModeFreePlaneResources) FreePlaneResources = nullptr;
    decltype(&drmModeFreeProperty) FreeProperty = nullptr;
    decltype(&drmModeFreeResources) FreeResources = nullptr;
    decltype(&drmModeGetConnector) GetConnector = nullptr;
    decltype(&drmModeGetConnectorCurrent) GetConnectorCurrent = nullptr;
    decltype(&drmModeGetEncoder) GetEncoder = nullptr;
    decltype(&drmModeGetPlane) GetPlane = nullptr;
    decltype(&drmModeGetPlaneResources) GetPlaneResources = nullptr;
    decltype(&drmModeGetProperty) GetProperty = nullptr;
    decltype(&drmModeGetResources) GetResources = nullptr;
    decltype(&drmIoctl) Ioctl = nullptr;
    decltype(&drmIsMaster) IsMaster = nullptr;
    decltype(&drmModeObjectGetProperties) ObjectGetProperties = nullptr;
    decltype(&drmModeRmFB) RmFB = nullptr;
    decltype(&drmSetClientCap) SetClientCap = nullptr;
    decltype(&drmSetMaster) SetMaster = nullptr;
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
