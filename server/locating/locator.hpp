#pragma once

#include <optional>

#include "wayfuse/proto/fix.hpp"
#include "wayfuse/proto/scan.hpp"

namespace wayfuse {

/// An absolute place from one scan. Made for one radio map; thread: confined to one session.
class Locator {
 public:
  virtual ~Locator() = default;
  /// Absent when the scan holds no transmitter the map knows: that is normal, not a fault.
  virtual std::optional<Fix> locate(const RssScan& scan) = 0;
};

}  // namespace wayfuse
