#include "sdk/src/attitude/catalogue.hpp"

#include <string>

#include "sdk/src/attitude/block_heading.hpp"
#include "sdk/src/attitude/complementary_heading.hpp"

namespace wayfuse {
namespace {

template <typename Estimator>
std::unique_ptr<HeadingEstimator> make() {
  return std::make_unique<Estimator>();
}

constexpr HeadingEstimatorRow kRows[] = {
    {"block_marg", "the project's own: strap-down, corrected in blocks by a Kalman filter, gated compass, hard iron", make<BlockHeading>},
    {"complementary", "[P1] gyroscope and compass blended with W = 0.7, quaternion tilt, valid at any tilt", make<ComplementaryHeading>},
    {"complementary_as_printed", "[P1] eqs. 4-10 to the letter: arcsine tilt from the raw accelerometer", make<PrintedComplementaryHeading>},
    {"compass", "[P2, P5] every sample alone from gravity and magnetic field, no gyroscope", make<CompassHeading>},
};

}  // namespace

std::span<const HeadingEstimatorRow> heading_estimators() { return kRows; }

Result<std::unique_ptr<HeadingEstimator>> make_heading_estimator(std::string_view name) {
  std::string names;
  for (const HeadingEstimatorRow& row : kRows) {
    if (row.name == name) return row.make();
    names += (names.empty() ? "" : ", ") + std::string(row.name);
  }
  return Fault{FaultCode::kUnknownName, "heading_estimator", "'" + std::string(name) + "' is none of: " + names};
}

}  // namespace wayfuse
