#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/sdk/recording.hpp"

namespace wayfuse {

/// What a file does not tell by itself.
struct ImportSettings {
  std::optional<FloorOrdinal> floor;           ///< of its truth, instead of what its floor label says
  std::optional<Georeference> georeference;    ///< for truth in latitude and longitude; absent = the first mark is (0, 0), y to the north
};

/// Somebody else's recording as one of ours.
struct ImportedRecording {
  RecordingHeader header;
  std::vector<RecordedEvent> events;           ///< in the order the phone delivered them
  std::vector<std::string> complaints;         ///< `file:line: cause` of every line that was left out, and what the format lacks
};

struct ImportFormat {
  std::string_view name;
  std::string_view about;
  Result<ImportedRecording> (*read)(const std::string& path, const ImportSettings& settings);
};

/// `ilc20`, `getsensordata`, `broad`, `tyrex`, `oxford-steps`.
const std::vector<ImportFormat>& import_formats();

/// Fault kUnknownName lists the formats; a broken file is a fault that names file and line.
Result<ImportedRecording> import_recording(std::string_view format, const std::string& path, const ImportSettings& settings);

/// GetSensorData, the Android application of the IPIN competitions: `ACCE;app s;sensor s;x;y;z;accuracy` and so on, `%` comments.
///
/// Every sensor is brought to the application's clock by the least delay it ever had; a WIFI row's age is its sensor time's. POSI
/// rows are truth. Lines that do not parse are left out and named; kMalformed if they are more than one in twenty.
Result<ImportedRecording> read_get_sensor_data(const std::string& path, const ImportSettings& settings);

}  // namespace wayfuse
