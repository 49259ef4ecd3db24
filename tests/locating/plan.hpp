#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "wayfuse/proto/fingerprint.hpp"

namespace wayfuse {

/// A place drawn as text, one character every `spacing_m`, first row north: `.` a reference point, `A`..`Z` a reference point
/// with a transmitter above it, anything else nothing. The first column is x = 0, the last row y = 0.
///
/// Levels fall by 30 dB a decade of distance from -30 dBm at 1 m: a test's world, not a model of the locators.
class Plan {
 public:
  Plan(std::vector<std::string> rows, double spacing_m, int floor = 0) : rows_(std::move(rows)), spacing_m_(spacing_m), floor_(floor) {
    each([&](char c, BuildingPoint at) {
      if (c >= 'A' && c <= 'Z') transmitters_.push_back({Bssid{0x1000u + static_cast<unsigned>(c) + 64u * static_cast<unsigned>(floor)}, at});
    });
  }

  static double level_dbm(double d_m) { return -30.0 - 30.0 * std::log10(std::hypot(d_m, 1.0)); }

  RssScan scan_at(BuildingPoint at, PhoneTime time = {}) const {
    RssScan scan{time, {}};
    for (const auto& [bssid, place] : transmitters_) {
      const double level = level_dbm(distance_m(at, place));
      if (level > -95.0) scan.readings.push_back({bssid, level, Duration{0}, 2412, {}, {}});
    }
    return scan;
  }

  std::vector<ReferencePoint> survey(int scans_each = 3) const {
    std::vector<ReferencePoint> points;
    each([&](char c, BuildingPoint at) {
      if (c != '.' && !(c >= 'A' && c <= 'Z')) return;
      ReferencePoint point;
      point.place = {at, FloorOrdinal{floor_}};
      for (int i = 0; i < scans_each; ++i) point.scans.push_back(scan_at(at));
      points.push_back(point);
    });
    return points;
  }

 private:
  void each(const auto& visit) const {
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      for (std::size_t column = 0; column < rows_[row].size(); ++column) {
        visit(rows_[row][column], BuildingPoint{static_cast<double>(column) * spacing_m_,
                                                static_cast<double>(rows_.size() - 1 - row) * spacing_m_});
      }
    }
  }
  struct Transmitter {
    Bssid bssid;
    BuildingPoint place;
  };
  std::vector<std::string> rows_;
  double spacing_m_;
  int floor_;
  std::vector<Transmitter> transmitters_;
};

}  // namespace wayfuse
