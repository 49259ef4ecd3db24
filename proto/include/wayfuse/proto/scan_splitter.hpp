#pragma once

#include <map>
#include <vector>

#include "wayfuse/proto/scan.hpp"

namespace wayfuse {

/// Readings of one scan that were heard at about the same time and so belong to one place.
struct HeardTogether {
  RssScan scan;                      ///< its time: when the newest of them was heard
  PhoneTime middle;                  ///< half way between the newest and the oldest
};

/// Cuts a walk's scans into readings heard within 2 s of each other; what the phone's cache repeats from an earlier scan counts
/// once. A radio takes up to 1.8 s to go through its channels, and a fingerprint cut into its channels matches nothing.
class ScanSplitter {
 public:
  std::vector<HeardTogether> split(const RssScan& scan);

 private:
  std::map<Bssid, PhoneTime> heard_;  // the newest reading given out
};

}  // namespace wayfuse
