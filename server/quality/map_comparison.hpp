#pragma once

#include <span>
#include <string>
#include <vector>

#include "db/radio_map_record.hpp"
#include "server/buildings/building_shelf.hpp"
#include "server/quality/walk_quality.hpp"

namespace wayfuse {

struct QualityWalk {
  std::uint64_t id = 0;
  RecordedTrack track;
};

/// Replays the walks over a building's map. The same walk gets the same random numbers on every map: differences are the maps'.
/// Deterministic. Fault: the pipeline cannot be prepared.
Result<std::vector<MapQuality>> measure(const Building& building, const std::string& pipeline, std::span<const QualityWalk> walks, UnixTime now);

/// Name and settings of a pipeline in a few letters: figures measured with another one are old.
std::string measured_with(const PipelineSpec& spec);

enum class Verdict : std::uint8_t { kBetter, kSame, kWorse, kUnknown };
std::string_view to_string(Verdict verdict);  ///< `better`, `same`, `worse`, `unknown`

/// A candidate against the map in force, walk by walk.
struct MapComparison {
  Verdict verdict = Verdict::kUnknown;
  std::vector<std::string> reasons;    ///< what decided, in words with numbers
  PooledQuality candidate;
  PooledQuality live;
  PairedDifference mean_m;             ///< candidate minus live, 95 % interval over walks; negative = the candidate is better
};

/// The gate. `worse`: the mean error rose by more than `noise_m` or 5 % and the interval lies above 0 (or it rose four times as
/// much, whatever the interval); a floor hit or an answer in a hundred was lost; or the 95 % circle holds less than 90 % and 5
/// points less than before. `better`: down by as much, as surely. One walk has no interval. `unknown`: nothing to measure by on both
/// sides. Walks that only one side has are left out.
MapComparison compare(std::span<const MapQuality> candidate, std::span<const MapQuality> live);

}  // namespace wayfuse
