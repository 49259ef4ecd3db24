#pragma once

#include <optional>
#include <string>

#include "sdk/src/recording/import/fingerprint_table.hpp"

namespace wayfuse {

/// The two tables of UJIIndoorLoc or of its like.
struct UjiFiles {
  std::string training;
  std::string validation;
};

/// `*trainingData.csv` and `*validationData.csv`, in any case, in the folder or in one folder below it. Absent = there is no such pair.
std::optional<UjiFiles> find_uji(const std::string& folder);

/// How many metres a unit of the table's coordinates is: of the Web-Mercator plane, whose coordinates are large, as many as the latitude
/// says; else it is a metre. Fault: degrees.
Result<double> metres_per_unit(const FingerprintTable& table, const std::string& file);

}  // namespace wayfuse
