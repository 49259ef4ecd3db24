#pragma once

#include <string>
#include <vector>

#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/scan.hpp"

namespace wayfuse {

/// A surveyed point with every raw scan taken there. Nothing is averaged before it is stored.
struct ReferencePoint {
  Place place;
  double sigma_m = 0.0;            ///< how well the surveyor knew the place, 0 = exactly
  std::string device_model;        ///< as the phone names itself; never a person or an address
  std::string walk;                ///< names the survey walk it belongs to; empty = a standing point
  UnixTime surveyed_at;
  std::vector<RssScan> scans;      ///< at least one
  bool operator==(const ReferencePoint&) const = default;
};

}  // namespace wayfuse
