#include "tests/db/survey_world.hpp"

#include <stdlib.h>

#include <cmath>
#include <stdexcept>

namespace wayfuse::testing {

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "wayfuse-db-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("mkdtemp " + pattern);
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

BuildingRecord sample_building(std::uint64_t id) {
  BuildingRecord building;
  building.id.value = id;
  building.name = "Rathaus Nord";
  building.georeference = Georeference{{50.0413, 8.2387}, 0.31};
  building.magnetic_field = {0.066, 1.14, 48.9};
  building.pipeline = "p1";
  const Polygon outline{{{{0, 0}, {40, 0}, {40, 25}, {0, 25}}, {{10, 10}, {20, 10}, {20, 15}}}};
  building.floors.push_back({{-1}, "B1", outline, {outline, Polygon{{{{1.5, 1.25}, {3, 1}, {3, 4}}}}}});
  building.floors.push_back({{0}, "Erdgeschoss", {}, {}});
  return building;
}

ReferencePoint sample_point(Random& random, int scans, int readings) {
  ReferencePoint point;
  point.place = {{40 * random.uniform(), 25 * random.uniform()}, {static_cast<std::int32_t>(random.below(3)) - 1}};
  point.sigma_m = random.uniform();
  point.device_model = "Pixel " + std::to_string(random.below(4));
  if (random.below(2) == 0) point.walk = "walk-" + std::to_string(random.below(5));
  point.surveyed_at = UnixTime(Duration(1'700'000'000'000'000 + static_cast<std::int64_t>(random.below(1'000'000'000))));
  for (int s = 0; s < scans; ++s) {
    RssScan scan;
    scan.time = PhoneTime(Duration(static_cast<std::int64_t>(random.below(1'000'000'000))));
    for (int r = 0; r < readings; ++r) {
      ScanReading reading;
      reading.bssid.value = 0x0a0000000000 + random.below(400);
      reading.rss_dbm = -30.0 - static_cast<double>(random.below(60));
      if (random.below(8) == 0) reading.rss_dbm -= random.uniform();
      reading.age = Duration(static_cast<std::int64_t>(random.below(20'000'000)));
      reading.frequency_mhz = static_cast<std::uint16_t>(random.below(2) == 0 ? 2437 : 5180);
      if (random.below(6) == 0) reading.range_m = 30 * random.uniform();
      if (reading.range_m && random.below(2) == 0) reading.range_sigma_m = random.uniform();
      scan.readings.push_back(reading);
    }
    point.scans.push_back(std::move(scan));
  }
  return point;
}

SurveyBatch sample_batch(std::uint64_t seed, std::size_t points, int readings) {
  Random random(seed);
  SurveyBatch batch;
  batch.idempotency_key = "batch-" + std::to_string(seed);
  for (std::size_t p = 0; p < points; ++p) batch.points.push_back(sample_point(random, 1 + static_cast<int>(random.below(3)), readings));
  return batch;
}

}  // namespace wayfuse::testing
