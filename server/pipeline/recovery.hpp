#pragma once

namespace wayfuse {

/// When to believe that the filter is lost rather than the fix wrong [SAFETY C16].
struct RecoverySettings {
  bool restart = true;
  double gate_sigmas = 4.0;        ///< of the innovation's own covariance
  int misses = 4;                  ///< in a row
};

}  // namespace wayfuse
