// libFuzzer target: Any bytes as a glTF file.
#include "tests/fuzz/readers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    surefoot::fuzz::gltf(std::as_bytes(std::span(data, size)));
    return 0;
}
