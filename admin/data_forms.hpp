#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "db/audit_record.hpp"
#include "db/building_database.hpp"
#include "db/upkeep_record.hpp"

/// The JSON of what is done with data as a whole.
namespace wayfuse {

struct Erasure {
  std::uint64_t points = 0;
  bool log_emptied = false;                  ///< false = a reader held the log: the bytes go at the next checkpoint
  std::vector<std::uint64_t> radio_maps;     ///< versions built before, which hold what was learnt from the points
};

std::string to_json(const VerifyReport& report);
std::string to_json(const Erasure& erasure);
/// `records` newest first; `survey_version` as the building stands now.
std::string to_json(const std::vector<UpkeepRecord>& records, std::uint64_t survey_version);
std::string to_json(const std::vector<AuditRecord>& lines, std::uint64_t next);

}  // namespace wayfuse
