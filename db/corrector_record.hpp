#pragma once

#include <cstdint>
#include <string>

namespace wayfuse {

/// What a pipeline learnt from a building's survey. What `content` means is the pipeline's matter; its provenance stands in it.
struct CorrectorRecord {
  std::string pipeline;                  ///< preset name
  std::uint64_t survey_version = 0;      ///< of the survey it was trained on
  std::string content;
  bool operator==(const CorrectorRecord&) const = default;
};

}  // namespace wayfuse
