#pragma once

#include <vector>

#include "db/access_point_record.hpp"
#include "db/sqlite.hpp"

namespace wayfuse {

std::vector<AccessPointRecord> read_access_points(SqliteConnection& connection);
/// Replaces the verdicts; the operator's trust stays as it stands.
void write_verdicts(SqliteConnection& connection, const std::vector<AccessPointRecord>& verdicts);
void write_trust(SqliteConnection& connection, Bssid bssid, AccessPointTrust trust, UnixTime at);

}  // namespace wayfuse
