#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>

#include "tests/fixtures/greeting_server.hpp"

// The Java face on a desktop JVM, against a server of the tests' own.
namespace wayfuse {
namespace {

std::string run_java(const std::string& words) {
  std::string text;
  FILE* pipe = popen(
      (WAYFUSE_JAVA " -Xcheck:jni -cp " WAYFUSE_JARS " -Djava.library.path=" WAYFUSE_JNI_FOLDER " " + words + " 2>&1").c_str(),
      "r");
  std::array<char, 4096> part;
  while (pipe && std::fgets(part.data(), part.size(), pipe)) text += part.data();
  if (pipe) pclose(pipe);
  return text;
}

TEST(WayfuseInJava, TracksFromSensorEventsToAPosition) {
  RawServer server(greet_and_fuse);
  const std::string said = run_java("PhoneCheck " + url_of(server));
  EXPECT_NE(said.find("all is well"), std::string::npos) << said;
  EXPECT_EQ(said.find("WARNING in native method"), std::string::npos) << said;
}

TEST(WayfuseInJava, ThePrintedExampleShowsAMovingDot) {
  RawServer server(greet_and_fuse);
  const std::string said = run_java("MovingDot " + url_of(server) + " key 1 4");
  EXPECT_NE(said.find("3.00 m, 4.00 m, floor 2"), std::string::npos) << said;
}

}  // namespace
}  // namespace wayfuse
