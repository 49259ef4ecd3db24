#pragma once

#include <array>
#include <vector>

#include "wayfuse/proto/fingerprint.hpp"
#include "wayfuse/proto/random.hpp"

namespace wayfuse::papers {

/// How radio waves fade in an experiment. Written apart from the server's locators, in linear power, so that it cannot flatter them.
struct RadioSettings {
  double level_at_1m_dbm = -40.0;
  double exponent = 2.0;
  double shadow_db = 0.0;          ///< of the place: the same at every visit
  double shadow_length_m = 4.0;    ///< over which it changes
  double fade_db = 0.0;            ///< of the moment: drawn anew for every reading
  double wall_db = 0.0;            ///< lost in each wall crossed
  double deaf_below_dbm = -200.0;  ///< weaker readings are not heard
  double rounding_db = 0.0;        ///< 1 = whole decibels as phones report
};

struct Wall {
  BuildingPoint from;
  BuildingPoint to;
};

/// Transmitters among walls; levels at any point, scans with fading.
class RadioWorld {
 public:
  RadioWorld(const RadioSettings& settings, std::vector<BuildingPoint> transmitters, std::vector<Wall> walls, Random& random);

  std::size_t size() const { return transmitters_.size(); }
  const std::vector<BuildingPoint>& transmitters() const { return transmitters_; }
  static Bssid bssid(std::size_t transmitter) { return Bssid{0x001122330000u + transmitter}; }

  /// From now on the air behaves otherwise: [P3]'s drifting and jumping exponents, and a person in front of a node.
  void set_exponent(double exponent) { settings_.exponent = exponent; }
  void block(std::size_t transmitter, double loss_db) { blocked_db_[transmitter] = loss_db; }

  double mean_dbm(std::size_t transmitter, BuildingPoint at) const;
  RssScan scan(BuildingPoint at, PhoneTime time, Random& random) const;
  /// Standing scans at every point.
  std::vector<ReferencePoint> survey(const std::vector<BuildingPoint>& points, int scans_each, Random& random) const;

 private:
  // Shadowing of one transmitter: a sum of plane waves of random direction, length and phase.
  struct Wave {
    double kx, ky, phase;
  };
  static constexpr std::size_t kWaves = 48;
  double shadow_db(std::size_t transmitter, BuildingPoint at) const;

  RadioSettings settings_;
  std::vector<BuildingPoint> transmitters_;
  std::vector<Wall> walls_;
  std::vector<std::array<Wave, kWaves>> shadows_;
  std::vector<double> blocked_db_;
};

/// Points every `spacing_m` from one corner to the other, both included.
std::vector<BuildingPoint> grid(BuildingPoint from, BuildingPoint to, double spacing_m);
bool crosses(const Wall& wall, BuildingPoint a, BuildingPoint b);

}  // namespace wayfuse::papers
