#include <gtest/gtest.h>

#include <fstream>
#include <numbers>

#include "sdk/src/recording/import/import.hpp"
#include "tests/fixtures/scratch_folder.hpp"

namespace wayfuse {
namespace {

class Import : public testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& text) {
    const std::string path = (folder_.path() / name).string();
    std::ofstream(path) << text;
    return path;
  }
  template <typename Event>
  static std::vector<Event> all(const ImportedRecording& recording) {
    std::vector<Event> found;
    for (const RecordedEvent& event : recording.events) {
      if (const auto* body = std::get_if<Event>(&event)) found.push_back(*body);
    }
    return found;
  }
  static PhoneTime at_ms(std::int64_t ms) { return PhoneTime(std::chrono::milliseconds(ms)); }

  ScratchFolder folder_;
};

// Half a second of a log in the shape the application writes: app time, sensor time (since boot: 100 s more), values.
constexpr const char* kLog =
    "% LogFile created by the GetSensorData App for Android.\n"
    "ACCE;10.020;110.000;0.1;0.2;9.8;3\n"
    "GYRO;10.020;110.000;0.01;0.02;0.03;3\n"
    "ACCE;10.035;110.020;0.1;0.2;9.7;3\n"   // 15 ms late: the least delay of this sensor
    "MAGN;10.036;110.020;20;1;-40;3\n"
    "PRES;10.036;110.020;1012.5;3\n"
    "AHRS;10.036;110.020;1;2;3;0.1;0.2;0.3;3\n"
    "WIFI;10.500;108.000;a;name;00:1b:2c:00:00:02;2437;-61\n"
    "WIFI;10.500;110.400;other;00:1b:2c:00:00:01;-70\n"   // an older application: no frequency
    "GNSS;10.600;1700000000.0;47.3769;8.5417;410;90;6.5;1.2;9;7\n"
    "POSI;10.700;1;47.37690000;8.54170000;2;0\n"
    "POSI;12.700;2;47.37699000;8.54170000;2;0\n";

TEST_F(Import, GetSensorDataBringsEverySensorToOneClock) {
  const auto recording = import_recording("getsensordata", file("log.txt", kLog), {});
  ASSERT_TRUE(recording) << to_string(recording.fault());
  const auto samples = all<MargSample>(*recording);
  ASSERT_EQ(samples.size(), 4u);   // the last two sensors spoke together
  // The accelerometer's least delay is 10.035 - 110.020: its first row was read 5 ms later than that.
  EXPECT_EQ(samples[0].time, at_ms(10'015));
  EXPECT_EQ(samples[0].acceleration_mps2, (Vector3{0.1, 0.2, 9.8}));
  EXPECT_EQ(samples[1].time, at_ms(10'020));
  EXPECT_EQ(samples[1].turn_rate_radps, (Vector3{0.01, 0.02, 0.03}));
  EXPECT_EQ(samples[2].time, at_ms(10'035));
  EXPECT_EQ(samples[3].time, at_ms(10'036));
  EXPECT_EQ(samples[3].field_ut, (Vector3{20, 1, -40}));
  EXPECT_EQ(samples[3].pressure_hpa, 1012.5);
}

TEST_F(Import, GetSensorDataGivesEveryReadingItsAge) {
  const auto recording = import_recording("getsensordata", file("log.txt", kLog), {});
  ASSERT_TRUE(recording);
  const auto scans = all<RssScan>(*recording);
  ASSERT_EQ(scans.size(), 1u);
  EXPECT_EQ(scans[0].time, at_ms(10'500));
  ASSERT_EQ(scans[0].readings.size(), 2u);   // the youngest first
  EXPECT_EQ(scans[0].readings[0].bssid.value, 0x001b2c000001u);
  EXPECT_EQ(scans[0].readings[0].frequency_mhz, 0);
  EXPECT_EQ(scans[0].readings[0].age, std::chrono::milliseconds(85));   // 10.5 - (110.4 - 99.985)
  EXPECT_EQ(scans[0].readings[1].frequency_mhz, 2437);
  EXPECT_EQ(scans[0].readings[1].age, std::chrono::milliseconds(2485));
}

TEST_F(Import, GetSensorDataPlacesTruthInTheBuildingsFrame) {
  ImportSettings settings;
  settings.georeference = Georeference{{47.3769, 8.5417}, 0.5 * std::numbers::pi};   // the y axis points east
  const auto turned = import_recording("getsensordata", file("log.txt", kLog), settings);
  ASSERT_TRUE(turned);
  const auto marks = all<TruthMark>(*turned);
  ASSERT_EQ(marks.size(), 2u);
  EXPECT_EQ(marks[0].place.floor, FloorOrdinal{2});
  EXPECT_NEAR(marks[1].place.point.x_m, -10.0, 0.02);   // 9e-5 degrees north: 10 m, against the x axis
  EXPECT_NEAR(marks[1].place.point.y_m, 0.0, 0.01);
  EXPECT_TRUE(turned->complaints.empty());
  const auto alone = import_recording("getsensordata", file("log.txt", kLog), {});
  ASSERT_EQ(alone->complaints.size(), 1u);
  EXPECT_NE(alone->complaints[0].find("no georeference"), std::string::npos);
  const auto fixes = all<GnssFix>(*alone);
  ASSERT_EQ(fixes.size(), 1u);
  EXPECT_EQ(fixes[0].sigma_m, 6.5);
  EXPECT_NEAR(fixes[0].course_azimuth_rad.value(), 0.5 * std::numbers::pi, 1e-12);
}

TEST_F(Import, NamesTheRowThatIsBroken) {
  std::string log = kLog;
  for (int i = 0; i < 30; ++i) log += "ACCE;11.0;111.0;0;0;9.8;3\n";
  const struct {
    const char* row;
    const char* cause;
  } broken[] = {{"ACCE;11.0;111.0;0;x;9.8;3", "sensor's values"},
                {"WIFI;11;111;name;00:1b:2c:00:00:02;2437;-312", "-312 is outside -120..0"},
                {"WIFI;11;111;name;nonsense;2437;-61", "not a BSSID"},
                {"POSI;11;3;147.0;8.5;0;0", "outside the earth"},
                {"GNSS;11;12;north", "latitude"},
                {"hello", "unknown kind"}};
  for (const auto& [row, cause] : broken) {
    const std::string path = file("broken.txt", log + row + "\n");
    const auto recording = import_recording("getsensordata", path, {});
    ASSERT_TRUE(recording) << row;
    ASSERT_FALSE(recording->complaints.empty()) << row;
    EXPECT_NE(recording->complaints[0].find(path + ":43: "), std::string::npos) << recording->complaints[0];
    EXPECT_NE(recording->complaints[0].find(cause), std::string::npos) << recording->complaints[0];
  }
}

TEST_F(Import, RefusesAFileThatIsMostlyBroken) {
  for (const char* format : {"getsensordata", "ilc20", "broad", "oxford-steps"}) {
    const auto refused = import_recording(format, file("other.txt", "hello\nworld\n"), {});
    ASSERT_FALSE(refused) << format;
    EXPECT_NE(to_string(refused.fault()).find("other.txt"), std::string::npos) << to_string(refused.fault());
  }
  EXPECT_EQ(import_recording("tyrex", folder_.path().string(), {}).fault().code, FaultCode::kNotFound);
  const auto unknown = import_recording("matlab", "x", {});
  EXPECT_NE(unknown.fault().cause.find("getsensordata"), std::string::npos);
}

TEST_F(Import, Ilc20KeepsWayPointsAsTruthOnTheFloorItsLabelNames) {
  const std::string path = file("trace.txt",
                                "#\tstartTime:1\tModel:PBCM10\tFloorName:F3\n"
                                "1574661000000\tTYPE_WAYPOINT\t1.5\t2.5\n"
                                "1574661000010\tTYPE_ACCELEROMETER\t0.1\t0.2\t9.8\t3\n"
                                "1574661000500\tTYPE_WIFI\tname\t00:1b:2c:00:00:01\t-61\t2437\t1574660998500\n");
  const auto recording = import_recording("ilc20", path, {});
  ASSERT_TRUE(recording) << to_string(recording.fault());
  EXPECT_EQ(recording->header.device_model, "PBCM10");
  ASSERT_EQ(recording->events.size(), 3u);
  EXPECT_EQ(all<TruthMark>(*recording)[0].place, (Place{{1.5, 2.5}, {2}}));
  EXPECT_EQ(all<RssScan>(*recording)[0].readings[0].age, std::chrono::seconds(2));
  ImportSettings settings;
  settings.floor = FloorOrdinal{-1};
  EXPECT_EQ(all<TruthMark>(*import_recording("ilc20", path, settings))[0].place.floor, FloorOrdinal{-1});
}

TEST_F(Import, MotionTrialsSayWhatARecordingCannotHold) {
  const auto steps = import_recording("oxford-steps", file("walk.csv", "1000000,0.1,0.2,9.8,0,0,0\n21000000,0.1,0.2,9.9,0,1,0\n"), {});
  ASSERT_TRUE(steps) << to_string(steps.fault());
  EXPECT_EQ(steps->events.size(), 2u);
  EXPECT_EQ(time_of(steps->events[1]), PhoneTime{Duration{21'000}});
  EXPECT_NE(steps->complaints.at(0).find("step counts"), std::string::npos);
  const auto broken = import_recording("oxford-steps", file("bad.csv", "1000000,0.1,0.2,9.8,0,0,0\n21000000,0.1,zero\n"), {});
  ASSERT_FALSE(broken);
  EXPECT_NE(to_string(broken.fault()).find("bad.csv:2"), std::string::npos);
}

}  // namespace
}  // namespace wayfuse
