#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "wayfuse/proto/result.hpp"
#include "wayfuse/sdk/heading_estimator.hpp"

namespace wayfuse {

/// One row a heading estimator.
struct HeadingEstimatorRow {
  std::string_view name;
  std::string_view summary;
  std::unique_ptr<HeadingEstimator> (*make)();
};

/// Every estimator there is, the project's own best first.
std::span<const HeadingEstimatorRow> heading_estimators();
/// Fault kUnknownName names the estimators there are.
Result<std::unique_ptr<HeadingEstimator>> make_heading_estimator(std::string_view name);

}  // namespace wayfuse
