#pragma once

#include <optional>

#include "wayfuse/proto/message.hpp"

namespace wayfuse {

/// When another scan would help one tracked phone [scan_hint]. Scans cost battery and a platform's allowance: many while the
/// position is in doubt, some while its owner walks, none while a good position rests.
///
/// A wish is told when it changes and three answers in a row agree on it. Thread: the connection's strand.
class ScanWishes {
 public:
  std::optional<ScanHint> after(const FusedPosition& position);
  std::optional<ScanHint> without_position();

 private:
  enum class Wish { kUnknown, kDoubt, kWalking, kResting };
  std::optional<ScanHint> settle(Wish wish);

  Wish told_ = Wish::kUnknown;
  Wish wished_ = Wish::kUnknown;
  int agreed_ = 0;   // answers in a row that wished it
};

}  // namespace wayfuse
