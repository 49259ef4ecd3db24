#include "tests/evaluation/walks/agreement.hpp"

#include <cmath>

namespace wayfuse {
namespace {

double dot(BuildingPoint a, BuildingPoint b) { return a.x_m * b.x_m + a.y_m * b.y_m; }

void count(Agreement::Mean& mean, double m2) {
  mean.sum_m2 += m2;
  ++mean.count;
}

}  // namespace

void Agreement::add(std::span<const HalvesOfScan> scans) {
  if (scans.empty()) return;
  ++walks;
  BuildingPoint one, other;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const HalvesOfScan& each = scans[i];
    count(scan, (dot(each.one, each.one) + dot(each.other, each.other)) / 2.0);
    count(scan_shared, dot(each.one, each.other));
    one = {one.x_m + each.one.x_m, one.y_m + each.one.y_m};
    other = {other.x_m + each.other.x_m, other.y_m + each.other.y_m};
    for (std::size_t k = i; k < scans.size(); ++k) {
      const auto lag = static_cast<std::size_t>(std::lround(std::abs(seconds(scans[k].heard - each.heard)) / kLag_s));
      if (lag < kLags) count(lagged[lag], (dot(each.one, scans[k].other) + dot(each.other, scans[k].one)) / 2.0);
    }
  }
  if (scans.size() < kFewestScans) return;
  const double n = static_cast<double>(scans.size());
  count(walk, (dot(one, one) + dot(other, other)) / 2.0 / (n * n));
  count(walk_shared, dot(one, other) / (n * n));
}

}  // namespace wayfuse
