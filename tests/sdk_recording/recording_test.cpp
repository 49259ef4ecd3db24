#include <gtest/gtest.h>

#include <sstream>

#include "wayfuse/sdk/recording.hpp"

namespace wayfuse {
namespace {

const RecordingHeader kHeader{"stand-in A", "test/1", "Demo office", UnixTime{std::chrono::seconds(1700000000)}};

std::vector<RecordedEvent> one_of_each() {
  return {MargSample{PhoneTime{Duration{1}}, Vector3{0.1, 0.2, 9.80665}, Vector3{1e-17, -3.25, 0}, std::nullopt, 1013.25},
          RssScan{PhoneTime{Duration{2}}, {{{0xaabbccddeeff}, -61.5, Duration{1234567}, 5180, 3.25, std::nullopt}}},
          GnssFix{PhoneTime{Duration{3}}, {47.3769, 8.5417}, 4.5, 1.25, std::nullopt},
          TruthMark{PhoneTime{Duration{4}}, {{1.5, -2.25}, {-1}}}};
}

std::string written(const std::vector<RecordedEvent>& events) {
  std::ostringstream out;
  RecordingWriter writer(out, kHeader);
  for (const RecordedEvent& event : events) writer.write(event);
  return out.str();
}

TEST(Recording, GivesBackWhatWasWritten) {
  std::istringstream in(written(one_of_each()));
  auto reader = RecordingReader::open(in);
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->header(), kHeader);
  for (const RecordedEvent& event : one_of_each()) {
    auto read = reader->next();
    ASSERT_TRUE(read && *read);
    EXPECT_TRUE(**read == event);
  }
  EXPECT_FALSE(reader->next()->has_value());
}

TEST(Recording, SkipsWhatItDoesNotKnow) {
  std::istringstream in(written({}) + "{\"type\":\"heartbeat\",\"time_us\":5,\"bpm\":70}\n\n" +
                        "{\"type\":\"truth\",\"time_us\":6,\"x_m\":1,\"y_m\":2,\"floor\":0,\"mood\":\"good\"}\n");
  auto reader = RecordingReader::open(in);
  ASSERT_TRUE(reader);
  auto event = reader->next();
  ASSERT_TRUE(event && *event);
  EXPECT_EQ(time_of(**event), PhoneTime{Duration{6}});
}

TEST(Recording, NamesTheBrokenLine) {
  std::istringstream in(written(one_of_each()) + "{\"type\":\"scan\",\"time_us\":7}\n");
  auto reader = RecordingReader::open(in);
  ASSERT_TRUE(reader);
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(reader->next());
  const auto broken = reader->next();
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.fault().code, FaultCode::kMalformed);
  EXPECT_EQ(broken.fault().field, "line 6");
  EXPECT_NE(broken.fault().cause.find("readings"), std::string::npos);
}

TEST(Recording, RefusesAnotherFileAndANewerOne) {
  for (const char* text : {"", "hello\n", "{\"type\":\"song\"}\n", "{\"type\":\"wayfuse-recording\",\"version\":99}\n"}) {
    std::istringstream in(text);
    EXPECT_FALSE(RecordingReader::open(in)) << text;
  }
}

}  // namespace
}  // namespace wayfuse
