#include "tests/fuzz/frame_fuzzing.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return wayfuse::fuzzing::run<wayfuse::ClientMessage>(data, size, wayfuse::Encoding::kJson);
}
