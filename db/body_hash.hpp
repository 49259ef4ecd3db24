#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "wayfuse/proto/fingerprint.hpp"

namespace wayfuse {

/// BLAKE2b-256 over a batch's points, every bit of every field: tells a retry from another body, and a sound row from a
/// flipped bit. Per point add(point), then one add(time, readings) a scan with its packed readings.
class BodyHash {
 public:
  BodyHash();
  ~BodyHash();
  void add(const ReferencePoint& point);  ///< everything but the scans; their number
  void add(PhoneTime scan_time, std::string_view packed_readings);
  std::string finish();                   ///< 32 bytes

 private:
  void add(std::string_view bytes);
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace wayfuse
