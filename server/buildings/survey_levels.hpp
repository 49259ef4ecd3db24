#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "wayfuse/proto/fingerprint.hpp"

namespace wayfuse {

/// What the survey says a phone at some place should hear. Everything surveyed is in it, distrusted transmitters too.
///
/// Immutable and thread-safe. Cost of a question: the points within kAround_m.
class SurveyLevels {
 public:
  static constexpr double kAround_m = 5.0;

  explicit SurveyLevels(std::span<const ReferencePoint> survey);

  struct Expectation {
    Bssid bssid;
    double rss_dbm = 0.0;      ///< mean of the points around that heard it
    double share = 0.0;        ///< of the points around that heard it
  };
  /// Ascending by address; empty where fewer than `least` points lie around.
  std::vector<Expectation> expect(Place place, std::size_t least = 2) const;

  std::span<const Bssid> transmitters() const { return transmitters_; }  ///< ascending
  bool knows(Bssid bssid) const;
  /// Places where it was heard at `least_dbm` and more, one every `apart_m` at the most, strongest first.
  std::vector<Place> where_heard(Bssid bssid, double least_dbm, double apart_m, std::size_t most) const;

 private:
  struct Level {
    std::uint32_t transmitter;
    float rss_dbm;
  };
  struct Point {
    Place place;
    std::uint32_t begin;
    std::uint32_t end;         ///< its levels are begin .. end - 1
  };
  using Cell = std::pair<std::int32_t, std::pair<std::int32_t, std::int32_t>>;  // floor, column, row
  static Cell cell_of(Place place);

  std::vector<Bssid> transmitters_;
  std::vector<Point> points_;
  std::vector<Level> levels_;
  std::map<Cell, std::vector<std::uint32_t>> cells_;
};

}  // namespace wayfuse
