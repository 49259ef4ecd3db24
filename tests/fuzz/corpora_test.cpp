#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

// Every seed of every corpus runs through the function that libFuzzer calls. A promise broken there aborts.
#define WAYFUSE_FUZZER(name) extern "C" int replay_##name(const std::uint8_t* data, std::size_t size);
#include "fuzzers.inc"
#undef WAYFUSE_FUZZER

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;
using Target = int (*)(const std::uint8_t*, std::size_t);

struct Fuzzer {
  const char* name;
  Target target;
};
const Fuzzer kFuzzers[] = {
#define WAYFUSE_FUZZER(name) {#name, replay_##name},
#include "fuzzers.inc"
#undef WAYFUSE_FUZZER
};

Bytes contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(in), {});
}

// On the heap in exactly its size, so that a sanitizer sees a read beyond the end.
void run(Target target, const Bytes& seed) {
  const auto exact = std::make_unique<std::uint8_t[]>(seed.size());
  std::ranges::copy(seed, exact.get());
  EXPECT_EQ(target(exact.get(), seed.size()), 0);
}

TEST(FuzzCorpora, EverySeedKeepsThePromises) {
  for (const Fuzzer& fuzzer : kFuzzers) {
    const fs::path corpus = fs::path(WAYFUSE_SOURCE_DIR) / "tests/fuzz/corpus" / fuzzer.name;
    ASSERT_TRUE(fs::is_directory(corpus)) << corpus << ": a fuzz target has a corpus";
    std::size_t seeds = 0;
    for (const auto& entry : fs::directory_iterator(corpus)) {
      run(fuzzer.target, contents(entry.path()));
      ++seeds;
    }
    EXPECT_GT(seeds, 0u) << fuzzer.name;
  }
}

// The golden documents are seeds of the wire's parsers, in both encodings; both sides' parsers get all of them.
TEST(FuzzCorpora, GoldenDocumentsKeepThePromises) {
  for (const auto& entry : fs::directory_iterator(fs::path(WAYFUSE_SOURCE_DIR) / "proto/examples")) {
    const Bytes json = contents(entry.path());
    const Bytes cbor = nlohmann::json::to_cbor(nlohmann::json::parse(json));
    for (const Fuzzer& fuzzer : kFuzzers) {
      if (std::strncmp(fuzzer.name, "json_", 5) == 0) run(fuzzer.target, json);
      if (std::strncmp(fuzzer.name, "cbor_", 5) == 0) run(fuzzer.target, cbor);
    }
  }
}

}  // namespace
