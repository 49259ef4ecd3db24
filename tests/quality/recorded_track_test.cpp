#include "server/quality/recorded_track.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "wayfuse/proto/codec.hpp"
#include "wayfuse/sdk/recording.hpp"

namespace wayfuse {
namespace {

PhoneTime at(double time_s) { return PhoneTime{from_seconds(time_s)}; }
RssScan scan_at(double time_s) { return {at(time_s), {{Bssid{1}, -50.0, Duration{0}, 2412, {}, {}}}}; }

// A phone lying still for 20 s, as its sensors felt it.
std::string still_recording(int marks) {
  std::ostringstream out;
  RecordingWriter writer(out, {"Model", "test/1", "Hall", UnixTime(std::chrono::seconds(1'700'000'000))});
  for (int i = 0; i < 1000; ++i) {
    MargSample sample{.time = at(0.02 * i), .acceleration_mps2 = Vector3{0, 0, 9.81}, .turn_rate_radps = Vector3{0, 0, 0},
                      .field_ut = Vector3{0, 20, -40}, .pressure_hpa = {}};
    writer.write(sample);
    if (i == 500) writer.write(scan_at(10.0));
  }
  for (int m = 0; m < marks; ++m) writer.write(TruthMark{at(1 + 17 * m), {{3, 4}, {0}}});
  return out.str();
}

TEST(ReadRecording, TurnsSensorsIntoWhatAPhoneWouldHaveReported) {
  const auto recording = read_recording(still_recording(2));
  ASSERT_TRUE(recording) << to_string(recording.fault());
  EXPECT_EQ(recording->device_model, "Model");
  EXPECT_EQ(recording->recorded_at, UnixTime(std::chrono::seconds(1'700'000'000)));
  EXPECT_EQ(recording->track.marks.size(), 2u);
  std::size_t reports = 0, scans = 0;
  double walked_m = 0.0;
  for (const SampleBody& body : recording->track.evidence) {
    scans += std::holds_alternative<RssScan>(body);
    if (const auto* motion = std::get_if<MotionReport>(&body)) ++reports, walked_m += motion->distance_m();
  }
  EXPECT_EQ(scans, 1u);
  EXPECT_GT(reports, 20u);
  EXPECT_EQ(walked_m, 0.0);
}

TEST(ReadRecording, TakesWhatThePhoneReportedPartByPart) {
  SurveyWalk first, second;
  first.idempotency_key = "a", second.idempotency_key = "b";
  first.walk = second.walk = "w";
  first.last = false, second.part = 1;
  first.device_model = "Model";
  first.marks = {{at(0), {{0, 0}, {0}}, 0.0}};
  second.marks = {{at(10), {{10, 0}, {0}}, 0.0}};
  second.scans = {scan_at(6)};
  const std::string lines = encode(ClientMessage(first), Encoding::kJson) + "\n" + encode(ClientMessage(second), Encoding::kJson) + "\n\n";
  const auto recording = read_recording(lines);
  ASSERT_TRUE(recording) << to_string(recording.fault());
  EXPECT_EQ(recording->track.marks.size(), 2u);
  EXPECT_EQ(recording->track.evidence.size(), 1u);
}

TEST(ReadRecording, NamesTheLineAndWhatIsMissing) {
  const auto fault = [](const std::string& content) { return read_recording(content).fault(); };
  EXPECT_EQ(fault("").field, "line 1");
  EXPECT_EQ(fault("{\"type\":\"goodbye\"}\n").field, "line 1: type");
  EXPECT_EQ(fault("no json\n").code, FaultCode::kMalformed);
  EXPECT_EQ(fault(still_recording(1)).field, "truth");
  std::string broken = still_recording(2);
  broken.insert(broken.find('\n') + 1, "{broken\n");
  EXPECT_EQ(fault(broken).field, "line 2");
  std::string deaf = still_recording(2);
  const auto scan = deaf.find("\"scan\"");
  deaf.replace(scan, 6, "\"skip\"");
  EXPECT_EQ(fault(deaf).field, "scan");
}

}  // namespace
}  // namespace wayfuse
