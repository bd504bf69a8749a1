// The one place where Debian's tinygltf is compiled; pictures are decoded by image.cpp, and read only when asked for.
#define TINYGLTF_IMPLEMENTATION
#include "render/import/tinygltf.hpp"
