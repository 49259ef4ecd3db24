#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "admin/recording_control.hpp"
#include "admin/server_control.hpp"
#include "admin/session_control.hpp"
#include "admin/zone_control.hpp"
#include "db/building_database.hpp"
#include "db/database_directory.hpp"
#include "wayfuse/proto/part.hpp"
#include "wayfuse/proto/result.hpp"

/// The JSON the admin API speaks: one place that spells and checks each resource. Degrees and metres outside.
namespace wayfuse {

/// A building as an operator sends it. Faults name the field: `floors[1].outline[0][3]: a point is [x_m, y_m]`.
Result<BuildingRecord> parse_building(std::string_view json);
/// Only the floors, as `{"floors": [...]}`.
Result<std::vector<Floor>> parse_floors(std::string_view json);
std::string to_json(const BuildingRecord& building, std::uint64_t points, std::uint64_t radio_map_version);
std::string to_json(const std::vector<BuildingRecord>& buildings, std::uint64_t next);

/// A page of points; `next` is the id to go on after, 0 = this was the last page.
std::string to_json(const std::vector<StoredPoint>& points, std::uint64_t next);
/// One row a reading, with a header line.
std::string to_json(const std::vector<UploadRecord>& uploads, std::uint64_t next);
std::string points_csv_header();
std::string to_csv(const StoredPoint& point);
/// One feature a point (RFC 7946). Precondition: the building is georeferenced.
std::string to_geojson_feature(const StoredPoint& point, const Georeference& georeference);

/// A zone as an operator sends it, without its id; its rings are sound.
Result<ZoneRecord> parse_zone(std::string_view json);
std::string to_json(const ZoneRecord& zone);
std::string to_json(const std::vector<ZoneRecord>& zones, std::uint64_t next);
std::string to_json(const std::vector<ZoneOccupant>& occupants);

std::string to_json(const std::vector<TransmitterRecord>& transmitters);
std::string to_json(const SurveyAck& ack);
std::string to_json(const std::vector<PartDescription>& parts);
/// `zones` holds the names of the zones each phone is in; `coarse` leaves positions out [C19].
std::string to_json(const std::vector<SessionSummary>& sessions, const std::map<std::string, std::vector<std::string>>& zones, bool coarse);
std::string to_json(const Explanation& explanation);
/// A recording's seed and epoch are texts: JSON's own numbers would round them.
std::string to_json(const RecordingState& state);
std::string to_json(const RecordingSummary& recording);
std::string to_json(const std::vector<RecordingSummary>& recordings, std::optional<std::uint64_t> next);
std::string to_json(const ReplayAnswer& answer, std::uint64_t recording, std::optional<std::uint64_t> map_version);
Result<RecordingOrder> parse_recording_order(std::string_view json);
/// An empty text asks for the beginning, as it was.
Result<ReplayQuestion> parse_replay_question(std::string_view json);
std::string to_json(const Readiness& readiness);
std::string names_to_json(std::string_view field, const std::vector<std::string>& names);

/// A key as an operator asks for it: name, scopes, building, expiry. Hash and id are not part of it.
Result<KeyRecord> parse_key(std::string_view json, UnixTime now);
std::string to_json(const KeyRecord& key, std::string_view secret);
std::string to_json(const std::vector<KeyRecord>& keys, std::uint64_t next);

}  // namespace wayfuse
