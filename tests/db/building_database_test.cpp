#include "db/building_database.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <map>

#include "db/packing.hpp"
#include "tests/db/survey_world.hpp"

namespace wayfuse {
namespace {

using testing::sample_batch;
using testing::sample_building;
using testing::TemporaryFolder;

BuildingDatabase fresh(const TemporaryFolder& folder) {
  Result<BuildingDatabase> made = BuildingDatabase::create(folder / "building-7.sqlite", sample_building(), {});
  EXPECT_TRUE(made.has_value()) << to_string(made.fault());
  return std::move(*made);
}

std::vector<ReferencePoint> points_of(BuildingDatabase& database) {
  std::vector<ReferencePoint> points;
  Result<std::vector<StoredPoint>> page = database.points({.floor = {}, .after_id = 0, .most = 1'000'000});
  EXPECT_TRUE(page.has_value()) << to_string(page.fault());
  for (StoredPoint& stored : *page) points.push_back(std::move(stored.point));
  return points;
}

TEST(BuildingDatabase, GivesBackTheDescriptionItWasMadeWith) {
  const TemporaryFolder folder;
  {
    BuildingDatabase made = fresh(folder);
    EXPECT_EQ(made.building().value(), sample_building());
  }
  Result<BuildingDatabase> opened = BuildingDatabase::open(folder / "building-7.sqlite", {});
  ASSERT_TRUE(opened) << to_string(opened.fault());
  EXPECT_EQ(opened->building().value(), sample_building());
}

TEST(BuildingDatabase, UpdatesTheDescriptionButNeitherIdNorSurvey) {
  const TemporaryFolder folder;
  BuildingDatabase database = fresh(folder);
  ASSERT_TRUE(database.store({sample_batch(1)}).at(0));
  BuildingRecord changed = sample_building();
  changed.name = "Rathaus Süd";
  changed.georeference.reset();
  changed.floors.erase(changed.floors.begin());
  changed.survey_version = 99;
  ASSERT_TRUE(database.update(changed));
  changed.survey_version = 1;
  EXPECT_EQ(database.building().value(), changed);
}

TEST(BuildingDatabase, KeepsEveryRawSampleBitByBit) {
  const TemporaryFolder folder;
  SurveyBatch batch = sample_batch(3, 40);
  batch.points[0].scans[0].readings[0].rss_dbm = -0.0;
  batch.points[0].scans[0].readings[1].rss_dbm = std::nextafter(-71.0, 0.0);
  batch.points[1].scans[0].readings.clear();  // heard nothing: that is evidence too
  {
    BuildingDatabase database = fresh(folder);
    const Result<SurveyAck> ack = database.store({batch}).at(0);
    ASSERT_TRUE(ack) << to_string(ack.fault());
    EXPECT_EQ(*ack, (SurveyAck{"batch-3", 40, 1}));
  }
  Result<BuildingDatabase> opened = BuildingDatabase::open(folder / "building-7.sqlite", {});
  ASSERT_TRUE(opened);
  const std::vector<ReferencePoint> stored = points_of(*opened);
  EXPECT_EQ(stored, batch.points);
  EXPECT_TRUE(std::signbit(stored[0].scans[0].readings[0].rss_dbm));
}

TEST(BuildingDatabase, AnswersARetryWithoutStoringItAgain) {
  const TemporaryFolder folder;
  BuildingDatabase database = fresh(folder);
  const Result<SurveyAck> first = database.store({sample_batch(1)}).at(0);
  ASSERT_TRUE(database.store({sample_batch(2)}).at(0));
  const Result<SurveyAck> again = database.store({sample_batch(1)}).at(0);
  ASSERT_TRUE(again);
  EXPECT_EQ(*again, *first);
  EXPECT_EQ(database.count_points().value(), 4u);
  EXPECT_EQ(database.building()->survey_version, 2u);
}

TEST(BuildingDatabase, RefusesAKnownKeyWithAnotherBodyAlone) {
  const TemporaryFolder folder;
  BuildingDatabase database = fresh(folder);
  ASSERT_TRUE(database.store({sample_batch(1)}).at(0));
  SurveyBatch forged = sample_batch(2);
  forged.idempotency_key = "batch-1";
  const auto answers = database.store({sample_batch(3), forged, sample_batch(4)});
  EXPECT_TRUE(answers[0]);
  ASSERT_FALSE(answers[1]);
  EXPECT_EQ(answers[1].fault().code, FaultCode::kIdempotencyConflict);
  EXPECT_EQ(answers[1].fault().field, "idempotency_key");
  EXPECT_TRUE(answers[2]);
  EXPECT_EQ(database.count_points().value(), 6u);
}

TEST(BuildingDatabase, TellsBodiesApartByTheSmallestDifference) {
  const TemporaryFolder folder;
  BuildingDatabase database = fresh(folder);
  ASSERT_TRUE(database.store({sample_batch(1)}).at(0));
  const auto differs = [&](auto change) {
    SurveyBatch other = sample_batch(1);
    change(other.points[1]);
    const Result<SurveyAck> answer = database.store({other}).at(0);
    return !answer && answer.fault().code == FaultCode::kIdempotencyConflict;
  };
  EXPECT_TRUE(differs([](ReferencePoint& p) { p.place.point.x_m = std::nextafter(p.place.point.x_m, 1e9); }));
  EXPECT_TRUE(differs([](ReferencePoint& p) { p.place.floor.value += 1; }));
  EXPECT_TRUE(differs([](ReferencePoint& p) { p.device_model += "a"; }));
  EXPECT_TRUE(differs([](ReferencePoint& p) { p.walk += "a"; }));
  EXPECT_TRUE(differs([](ReferencePoint& p) { p.surveyed_at += Duration(1); }));
  EXPECT_TRUE(differs([](ReferencePoint& p) { p.scans[0].time += Duration(1); }));
  EXPECT_TRUE(differs([](ReferencePoint& p) { p.scans[0].readings[0].age += Duration(1); }));
  EXPECT_TRUE(differs([](ReferencePoint& p) { p.scans[0].readings.pop_back(); }));
  EXPECT_TRUE(differs([](ReferencePoint& p) { p.scans.push_back({}); }));
}

TEST(BuildingDatabase, RefusesValuesOutOfRangeAndKeepsItsNeighbours) {
  const TemporaryFolder folder;
  BuildingDatabase database = fresh(folder);
  const auto refused = [&](auto change, const std::string& field) {
    SurveyBatch bad = sample_batch(50);
    change(bad.points[1]);
    const auto answers = database.store({bad});
    EXPECT_FALSE(answers[0]) << field;
    if (answers[0]) return;
    EXPECT_EQ(answers[0].fault().code, FaultCode::kOutOfRange) << to_string(answers[0].fault());
    EXPECT_THAT(to_string(answers[0].fault()), ::testing::HasSubstr(field));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  refused([&](ReferencePoint& p) { p.scans[0].readings[4].rss_dbm = -312; }, "points[1].scans[0].readings[4].rss_dbm: -312");
  refused([&](ReferencePoint& p) { p.scans[0].readings[0].rss_dbm = nan; }, "rss_dbm");
  refused([&](ReferencePoint& p) { p.scans[0].readings[0].age = Duration(-1); }, "age");
  refused([&](ReferencePoint& p) { p.scans[0].readings[0].bssid.value = std::uint64_t{1} << 48; }, "bssid");
  refused([&](ReferencePoint& p) { p.scans[0].readings[0].range_m = infinite; }, "range_m");
  refused([&](ReferencePoint& p) { p.place.point.x_m = nan; }, "x_m");
  refused([&](ReferencePoint& p) { p.place.point.y_m = infinite; }, "y_m");
  refused([&](ReferencePoint& p) { p.place.floor.value = 5000; }, "floor");
  refused([&](ReferencePoint& p) { p.sigma_m = -1; }, "sigma_m");
  refused([&](ReferencePoint& p) { p.device_model = std::string(257, 'x'); }, "name");
  refused([&](ReferencePoint& p) { p.scans.resize(65); }, "ordinal");
  EXPECT_EQ(database.count_points().value(), 0u);
  EXPECT_EQ(database.building()->survey_version, 0u);
  SurveyBatch bad = sample_batch(50);
  bad.points[0].sigma_m = nan;
  const auto answers = database.store({sample_batch(1), bad, sample_batch(2)});
  EXPECT_TRUE(answers[0] && !answers[1] && answers[2]);
  EXPECT_EQ(database.count_points().value(), 4u);
  EXPECT_EQ(database.building()->survey_version, 2u);
}

TEST(BuildingDatabase, PagesThroughPointsByFloor) {
  const TemporaryFolder folder;
  BuildingDatabase database = fresh(folder);
  const SurveyBatch batch = sample_batch(9, 100);
  ASSERT_TRUE(database.store({batch}).at(0));
  std::vector<ReferencePoint> expected;
  for (const ReferencePoint& point : batch.points) {
    if (point.place.floor.value == 1) expected.push_back(point);
  }
  ASSERT_GT(expected.size(), 20u);
  std::vector<ReferencePoint> paged;
  PointQuery query{.floor = FloorOrdinal{1}, .after_id = 0, .most = 7};
  while (true) {
    const auto page = database.points(query);
    ASSERT_TRUE(page);
    if (page->empty()) break;
    EXPECT_LE(page->size(), 7u);
    for (const StoredPoint& stored : *page) paged.push_back(stored.point);
    query.after_id = page->back().id;
  }
  EXPECT_EQ(paged, expected);
}

TEST(BuildingDatabase, CountsTransmittersAsTheRawScansDo) {
  const TemporaryFolder folder;
  BuildingDatabase database = fresh(folder);
  std::map<std::uint64_t, std::pair<std::uint64_t, double>> expected;  // readings, strongest: counted from the batches
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SurveyBatch batch = sample_batch(seed, 10);
    ASSERT_TRUE(database.store({batch}).at(0));
    for (const ReferencePoint& point : batch.points) {
      for (const RssScan& scan : point.scans) {
        for (const ScanReading& reading : scan.readings) {
          auto [row, isnew] = expected.try_emplace(reading.bssid.value, 0, reading.rss_dbm);
          ++row->second.first;
          row->second.second = std::max(row->second.second, reading.rss_dbm);
        }
      }
    }
  }
  const auto transmitters = database.transmitters();
  ASSERT_TRUE(transmitters);
  ASSERT_EQ(transmitters->size(), expected.size());
  for (const TransmitterRecord& transmitter : *transmitters) {
    const auto& [readings, strongest] = expected.at(transmitter.bssid.value);
    EXPECT_EQ(transmitter.readings, readings);
    EXPECT_EQ(transmitter.strongest_dbm, strongest);
    EXPECT_TRUE(transmitter.frequency_mhz == 2437 || transmitter.frequency_mhz == 5180);
  }
}

TEST(BuildingDatabase, ASecondWriterIsToldWhoHasIt) {
  const TemporaryFolder folder;
  const BuildingDatabase first = fresh(folder);
  const Result<BuildingDatabase> second = BuildingDatabase::open(folder / "building-7.sqlite", {});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.fault().code, FaultCode::kStoreBusy);
  EXPECT_THAT(second.fault().cause, ::testing::HasSubstr("process " + std::to_string(::getpid())));
}

TEST(BuildingDatabase, RefusesADescriptionThatCannotBeKept) {
  const TemporaryFolder folder;
  const auto refused = [&](auto change) {
    BuildingRecord building = sample_building();
    change(building);
    const auto made = BuildingDatabase::create(folder / "building-7.sqlite", building, {});
    EXPECT_FALSE(made);
    std::filesystem::remove(folder / "building-7.sqlite");
    return made ? std::string() : made.fault().field + made.fault().cause;
  };
  EXPECT_THAT(refused([](BuildingRecord& b) { b.id.value = 0; }), ::testing::HasSubstr("id"));
  EXPECT_THAT(refused([](BuildingRecord& b) { b.name.clear(); }), ::testing::HasSubstr("name"));
  EXPECT_THAT(refused([](BuildingRecord& b) { std::swap(b.floors[0], b.floors[1]); }), ::testing::HasSubstr("floors[1].ordinal"));
  EXPECT_THAT(refused([](BuildingRecord& b) { b.georeference->origin.latitude_deg = 91; }), ::testing::HasSubstr("latitude_deg"));
}

TEST(BuildingDatabase, ErasesPointsAndWhatWasHeardAtThem) {
  const TemporaryFolder folder;
  BuildingDatabase database = fresh(folder);
  ASSERT_TRUE(database.store({sample_batch(1, 30)}).at(0));
  const std::vector<TransmitterRecord> before = database.transmitters().value();
  ASSERT_TRUE(database.store({sample_batch(2, 30)}).at(0));
  EXPECT_EQ(database.erase({}).value(), 0u) << "no condition, no point";
  EXPECT_EQ(database.erase({.walk = "walk-none", .idempotency_key = "batch-2"}).value(), 0u);
  EXPECT_EQ(database.building()->survey_version, 2u);
  EXPECT_EQ(database.erase({.idempotency_key = "batch-2"}).value(), 30u);
  EXPECT_EQ(points_of(database), sample_batch(1, 30).points);
  EXPECT_EQ(database.building()->survey_version, 3u);
  const std::vector<TransmitterRecord> after = database.transmitters().value();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i].bssid, before[i].bssid);
    EXPECT_EQ(after[i].readings, before[i].readings);
    EXPECT_EQ(after[i].strongest_dbm, before[i].strongest_dbm);
    EXPECT_EQ(after[i].frequency_mhz, before[i].frequency_mhz);
  }
  EXPECT_EQ(database.store({sample_batch(2, 30)}).at(0).value(), (SurveyAck{"batch-2", 30, 2})) << "a retry brings nothing back";
  EXPECT_EQ(database.count_points().value(), 30u);
}

TEST(BuildingDatabase, ErasesByWalkDeviceAgeAndNumber) {
  const TemporaryFolder folder;
  BuildingDatabase database = fresh(folder);
  const SurveyBatch batch = sample_batch(1, 60);
  ASSERT_TRUE(database.store({batch}).at(0));
  std::vector<ReferencePoint> left = batch.points;
  const auto drop = [&](auto fits) { return static_cast<std::uint64_t>(std::erase_if(left, fits)); };
  EXPECT_EQ(database.erase({.walk = "walk-2"}).value(), drop([](const ReferencePoint& p) { return p.walk == "walk-2"; }));
  EXPECT_EQ(database.erase({.device_model = "Pixel 1"}).value(), drop([](const ReferencePoint& p) { return p.device_model == "Pixel 1"; }));
  const UnixTime middle = left[left.size() / 2].surveyed_at;
  EXPECT_EQ(database.erase({.surveyed_before = middle}).value(), drop([&](const ReferencePoint& p) { return p.surveyed_at < middle; }));
  const std::uint64_t first = database.points({}).value().at(0).id;
  EXPECT_EQ(database.erase({.point_id = first}).value(), 1u);
  left.erase(left.begin());
  EXPECT_GT(left.size(), 3u);
  EXPECT_EQ(points_of(database), left);
}

ZoneRecord sample_zone(const std::string& name) {
  ZoneRecord zone;
  zone.name = name;
  zone.floor = {-1};
  zone.region = Polygon{{{{0, 0}, {5, 0}, {5, 5}}, {{1, 0.5}, {2, 0.5}, {2, 1}}}};
  zone.exit_tolerance_m = 1.5;
  zone.tolerance_timeout = std::chrono::seconds(5);
  zone.exit_delay = std::nullopt;
  zone.timeout = std::chrono::seconds(60);
  return zone;
}

TEST(BuildingDatabase, KeepsZones) {
  const TemporaryFolder folder;
  BuildingDatabase database = fresh(folder);
  ZoneRecord lab = database.put_zone(sample_zone("Lab")).value();
  const ZoneRecord hall = database.put_zone(sample_zone("Hall")).value();
  EXPECT_NE(lab.id, hall.id);
  lab.timeout.reset();
  lab.floor = {0};
  ASSERT_TRUE(database.put_zone(lab));
  EXPECT_THAT(database.zones().value(), ::testing::ElementsAre(lab, hall));
  ASSERT_TRUE(database.remove_zone(hall.id));
  EXPECT_EQ(database.remove_zone(hall.id).fault().code, FaultCode::kNotFound);
  EXPECT_EQ(database.put_zone(hall).fault().code, FaultCode::kNotFound);
  EXPECT_GT(database.put_zone(sample_zone("New")).value().id, hall.id) << "a number is never given twice";
}

TEST(BuildingDatabase, RefusesZonesThatAreNone) {
  const TemporaryFolder folder;
  BuildingDatabase database = fresh(folder);
  const auto field_of = [&](auto change) {
    ZoneRecord zone = sample_zone("Lab");
    change(zone);
    const Result<ZoneRecord> answer = database.put_zone(zone);
    return answer ? std::string("stored") : answer.fault().field + answer.fault().cause;
  };
  EXPECT_THAT(field_of([](ZoneRecord& z) { z.region.rings.clear(); }), ::testing::HasSubstr("region"));
  EXPECT_THAT(field_of([](ZoneRecord& z) { z.region.rings[1].pop_back(); }), ::testing::HasSubstr("region.rings[1]"));
  EXPECT_THAT(field_of([](ZoneRecord& z) { z.region.rings[0][0].x_m = std::nan(""); }), ::testing::HasSubstr("region.rings[0]"));
  EXPECT_THAT(field_of([](ZoneRecord& z) { z.exit_delay = Duration(-1); }), ::testing::HasSubstr("exit_delay"));
  EXPECT_THAT(field_of([](ZoneRecord& z) { z.exit_tolerance_m = -1; }), ::testing::HasSubstr("exit_tolerance_m"));
  EXPECT_THAT(field_of([](ZoneRecord& z) { z.name.clear(); }), ::testing::HasSubstr("name"));
  EXPECT_TRUE(database.zones()->empty());
}

TEST(BuildingDatabase, VerifiesEveryUploadAgainstItsHash) {
  const TemporaryFolder folder;
  {
    BuildingDatabase database = fresh(folder);
    for (std::uint64_t seed = 1; seed <= 4; ++seed) ASSERT_TRUE(database.store({sample_batch(seed, 10)}).at(0));
    const std::uint64_t point = database.points({}).value().at(0).id;
    ASSERT_EQ(database.erase({.point_id = point}).value(), 1u);
    const VerifyReport report = database.verify().value();
    EXPECT_THAT(report.wrong, ::testing::IsEmpty());
    EXPECT_EQ(report.uploads, 4u);
    EXPECT_EQ(report.uploads_proven, 3u) << "one has lost a point";
    EXPECT_EQ(report.points, 39u);
    EXPECT_EQ(report.transmitters, database.transmitters()->size());
  }
  // One bit of one reading's age: no page, layout or count notices it.
  std::fstream file(folder / "building-7.sqlite", std::ios::in | std::ios::out | std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  const ScanReading hurt = sample_batch(3, 10).points[5].scans[0].readings[2];
  Packer packed;
  packed.u16(hurt.frequency_mhz);
  packed.u32(static_cast<std::uint32_t>(hurt.age.count()));
  packed.u48(hurt.bssid.value);
  const std::size_t at = bytes.find(packed.bytes());
  ASSERT_NE(at, std::string::npos);
  file.seekp(static_cast<std::streamoff>(at + 2));
  file.put(static_cast<char>(bytes[at + 2] ^ 1));
  file.close();
  Result<BuildingDatabase> opened = BuildingDatabase::open(folder / "building-7.sqlite", {});
  ASSERT_TRUE(opened);
  EXPECT_THAT(opened->verify()->wrong, ::testing::ElementsAre("upload batch-3 is not what was sent: a bit has changed"));
}

TEST(BuildingDatabase, BacksUpWhileItIsOpen) {
  const TemporaryFolder folder;
  BuildingDatabase database = fresh(folder);
  ASSERT_TRUE(database.store({sample_batch(1)}).at(0));
  ASSERT_TRUE(database.back_up_to(folder / "copy.sqlite"));
  ASSERT_TRUE(database.store({sample_batch(2)}).at(0));
  EXPECT_EQ(database.back_up_to(folder / "copy.sqlite").fault().code, FaultCode::kConflict);
  Result<BuildingDatabase> copy = BuildingDatabase::open(folder / "copy.sqlite", {});
  ASSERT_TRUE(copy) << to_string(copy.fault());
  EXPECT_EQ(points_of(*copy), sample_batch(1).points);
}

}  // namespace
}  // namespace wayfuse
