#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "sdk/src/simulator/tracked_phone.hpp"

namespace wayfuse::simulator {

/// Shows a fleet's errors while it walks: redrawn in place on a terminal, a line now and then elsewhere.
class LiveTable {
 public:
  explicit LiveTable(std::FILE* out);

  void show(const std::vector<std::unique_ptr<TrackedPhone>>& phones, double progress, const std::string& clock);

 private:
  std::FILE* out_;
  bool terminal_;
  std::size_t lines_ = 0;
  int tenth_shown_ = -1;
};

/// `[#####.....]  50 %`
std::string progress_bar(double progress);

/// The fleet's errors over all phones.
struct FleetErrors {
  ErrorLog fused, wifi_alone, reckoned;
  std::uint64_t samples_lost = 0;
};
FleetErrors errors_of(const std::vector<std::unique_ptr<TrackedPhone>>& phones);
/// The closing table.
void print_errors(std::FILE* out, const FleetErrors& errors, bool compared);
/// ... and its verdict; returns whether fusion was better than both of its sources.
bool print_summary(std::FILE* out, const FleetErrors& errors, bool compared);

}  // namespace wayfuse::simulator
