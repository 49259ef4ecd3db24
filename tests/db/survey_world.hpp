#pragma once

#include <filesystem>
#include <string>

#include "db/building_database.hpp"
#include "wayfuse/proto/random.hpp"

/// What the store's tests store: buildings, points and batches made from a seed.
namespace wayfuse::testing {

/// A folder of its own, gone with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Two floors, the lower one with a hole and a walkable area, georeferenced.
BuildingRecord sample_building(std::uint64_t id = 7);

/// A point with everything a point can hold: fractional RSS, ranges, cached ages, several scans.
ReferencePoint sample_point(Random& random, int scans = 2, int readings = 12);

/// A batch whose content follows from `seed` alone.
SurveyBatch sample_batch(std::uint64_t seed, std::size_t points = 2, int readings = 12);

}  // namespace wayfuse::testing
