#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "tests/fixtures/greeting_server.hpp"
#include "tests/sdk_c/c_calls.h"

// The C interface, driven from C (c_calls.c) through the shared library, against a server of the tests' own.
namespace wayfuse {
namespace {

/// What the C side waits on instead of looking again and again.
class Bell {
 public:
  c_bell in_c() {
    return {this, [](void* itself) { static_cast<Bell*>(itself)->ring(); },
            [](void* itself, int times) { return static_cast<Bell*>(itself)->wait(times) ? 1 : 0; }};
  }

 private:
  void ring() {
    const std::lock_guard lock(mutex_);
    ++rung_;
    changed_.notify_all();
  }
  bool wait(int times) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), [&] { return rung_ >= times; });
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  int rung_ = 0;
};

TEST(WayfuseInC, RefusesNullEverywhere) {
  EXPECT_STREQ(c_null_is_refused(), nullptr);
}

TEST(WayfuseInC, ChecksOptionsOfAnyAge) {
  EXPECT_STREQ(c_options_are_checked(), nullptr);
}

TEST(WayfuseInC, NamesBadInput) {
  RawServer server(greet_and_fuse);
  EXPECT_STREQ(c_bad_input_is_named(url_of(server).c_str()), nullptr);
}

TEST(WayfuseInC, TracksFromSensorsToAPosition) {
  RawServer server(greet_and_fuse);
  Bell bell;
  EXPECT_STREQ(c_tracks(url_of(server).c_str(), bell.in_c()), nullptr);
}

TEST(WayfuseInC, SurveysAWalkAndAPoint) {
  RawServer server(greet_and_fuse);
  Bell bell;
  EXPECT_STREQ(c_surveys(url_of(server).c_str(), bell.in_c()), nullptr);
}

TEST(WayfuseInC, ManyPhonesComeAndGo) {
  RawServer server(greet_and_fuse);
  for (int i = 0; i < 20; ++i) {
    wayfuse_options options;
    wayfuse_options_init(&options, sizeof options);
    const std::string url = url_of(server);
    options.url = {url.data(), url.size()};
    options.building = 1;
    wayfuse_phone* phone = nullptr;
    ASSERT_EQ(wayfuse_phone_create(&options, &phone), WAYFUSE_OK);
    ASSERT_EQ(wayfuse_phone_start(phone), WAYFUSE_OK);
    std::thread other([&] { wayfuse_phone_network_changed(phone); });
    for (int n = 0; n < i; ++n) wayfuse_phone_feed_gnss(phone, wayfuse_now_us(), 47, 8, 5);
    other.join();
    ASSERT_EQ(wayfuse_phone_destroy(phone), WAYFUSE_OK);
  }
}

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> part;
  while (pipe && std::fgets(part.data(), part.size(), pipe)) text += part.data();
  if (pipe) pclose(pipe);
  return text;
}

TEST(Examples, ShowAMovingDotAsTheyArePrinted) {
  for (const char* program : {WAYFUSE_EXAMPLE_C, WAYFUSE_EXAMPLE_CPP}) {
    RawServer server(greet_and_fuse);
    const std::string said = output_of(std::string(program) + " " + url_of(server) + " key 1 4 2>&1");
    EXPECT_NE(said.find("3.00 m, 4.00 m, floor 2"), std::string::npos) << program << ": " << said;
  }
}

TEST(Libwayfuse, ExportsTheHeaderAndNothingElse) {
  std::set<std::string> declared;
  const std::string header =
      output_of("grep -oE 'wayfuse_[a-z0-9_]+\\(' " WAYFUSE_SOURCE_DIR "/sdk/include/wayfuse/sdk/wayfuse.h");
  for (std::size_t at = 0, end; (end = header.find("(\n", at)) != std::string::npos; at = end + 2)
    declared.insert(header.substr(at, end - at));
  std::set<std::string> exported;
  const std::string symbols = output_of("nm -D --defined-only --format=posix " WAYFUSE_SHARED_LIBRARY " | cut -d' ' -f1");
  for (std::size_t at = 0, end; (end = symbols.find('\n', at)) != std::string::npos; at = end + 1)
    exported.insert(symbols.substr(at, end - at));
  EXPECT_EQ(exported, declared);
  EXPECT_GE(exported.size(), 25u);
}

TEST(Libwayfuse, KeepsItsSizeBudget) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitized library is larger";
#endif
  // 1.5 MB stripped, OpenSSL not counted (it is a library of the system): the budget for a phone's download.
  const std::string stripped = WAYFUSE_BINARY_DIR "/libwayfuse.stripped";
  ASSERT_EQ(std::system(("strip -o " + stripped + " " WAYFUSE_SHARED_LIBRARY).c_str()), 0);
  const std::string size = output_of("stat -c %s " + stripped);
  EXPECT_LE(std::stol(size), 1'500'000) << size;
}

}  // namespace
}  // namespace wayfuse
