#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/pipeline/tracker.hpp"
#include "server/tracking/back_propagation.hpp"

namespace wayfuse {

struct PipelineParts;

/// Two networks, one an axis, that add the filter's expected residual to its estimate [P4], and where they come from.
struct Corrector {
  BackPropagation x;
  BackPropagation y;
  struct Provenance {
    int walks = 0;                 ///< recorded walks with truth it was trained on
    int samples = 0;
    double rmse_before_m = 0.0;    ///< of the filter on them, each walk against a radio map without it
    double rmse_after_m = 0.0;     ///< the same, corrected
    std::uint64_t radio_map_version = 0;
    bool operator==(const Provenance&) const = default;
  } from;

  /// What a building stores; the other direction refuses what it cannot be.
  std::string to_json() const;
  static Result<Corrector> parse(std::string_view json);
};

/// Trains on the survey's own walks (reference points that share a walk's name, in time order): every walk is replayed through
/// the pipeline over a radio map made without it, and the networks learn truth minus estimate. Absent, with the reason, when there are
/// fewer than 3 walks or 30 updates.
Result<Corrector> train_corrector(const Site& site,
                                  const std::function<std::shared_ptr<const PipelineParts>(std::shared_ptr<const Site>)>& prepare,
                                  const BackPropagationSettings& settings);

}  // namespace wayfuse
