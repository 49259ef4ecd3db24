#include <algorithm>
#include <map>

#include "db/packing.hpp"
#include "db/survey_store.hpp"
#include "db/walk_part_table.hpp"

namespace wayfuse {
namespace {

// The points to go, gathered in a table of this connection alone.
std::int64_t choose(SqliteConnection& connection, const EraseQuery& query) {
  connection.execute("CREATE TEMP TABLE IF NOT EXISTS doomed (id INTEGER PRIMARY KEY)");
  connection.execute("DELETE FROM doomed");
  Statement select = connection.prepare(
      "INSERT INTO doomed SELECT p.id FROM reference_point AS p JOIN device_model AS m ON m.id = p.device_model_id "
      "JOIN upload AS u ON u.id = p.upload_id LEFT JOIN survey_walk AS w ON w.id = p.walk_id "
      "WHERE (?1 IS NULL OR p.id = ?1) AND (?2 IS NULL OR w.name = ?2) AND (?3 IS NULL OR m.name = ?3) "
      "AND (?4 IS NULL OR u.idempotency_key = ?4) AND (?5 IS NULL OR p.surveyed_at_us < ?5)");
  if (query.point_id) select.bind(1, static_cast<std::int64_t>(*query.point_id));
  if (query.walk) select.bind_text(2, *query.walk);
  if (query.device_model) select.bind_text(3, *query.device_model);
  if (query.idempotency_key) select.bind_text(4, *query.idempotency_key);
  if (query.surveyed_before) select.bind(5, std::int64_t{query.surveyed_before->time_since_epoch().count()});
  return select.run();
}

struct Heard {
  std::int64_t frequency_mhz = 0;
  std::int64_t readings = 0;
  double strongest_dbm = -120;
  std::int64_t first_us = INT64_MAX;
  std::int64_t last_us = INT64_MIN;
};

// A maximum cannot be taken back, so what is left is counted from the scans, in the order they came.
std::map<std::uint64_t, Heard> count_anew(SqliteConnection& connection) {
  std::map<std::uint64_t, Heard> heard;
  Statement scans = connection.prepare("SELECT s.readings, p.surveyed_at_us FROM scan AS s JOIN reference_point AS p ON p.id = s.point_id ORDER BY s.id");
  while (scans.step()) {
    const Result<std::vector<ScanReading>> readings = unpack_readings(scans.blob(0));
    if (!readings) throw StoreError(readings.fault());
    for (const ScanReading& reading : *readings) {
      Heard& counted = heard[reading.bssid.value];
      ++counted.readings;
      if (reading.frequency_mhz != 0) counted.frequency_mhz = reading.frequency_mhz;
      counted.strongest_dbm = std::max(counted.strongest_dbm, reading.rss_dbm);
      counted.first_us = std::min(counted.first_us, scans.integer(1));
      counted.last_us = std::max(counted.last_us, scans.integer(1));
    }
  }
  return heard;
}

void write_transmitters(SqliteConnection& connection, const std::map<std::uint64_t, Heard>& heard) {
  connection.prepare("DELETE FROM transmitter").run();
  Statement insert = connection.prepare("INSERT INTO transmitter VALUES (?, ?, ?, ?, ?, ?)");
  for (const auto& [bssid, counted] : heard) {
    insert.bind(1, static_cast<std::int64_t>(bssid)).bind(2, counted.frequency_mhz).bind(3, counted.readings);
    insert.bind(4, counted.strongest_dbm).bind(5, counted.first_us).bind(6, counted.last_us).run();
  }
}

}  // namespace

std::uint64_t erase_points(SqliteConnection& connection, const EraseQuery& query) {
  if (!query.point_id && !query.walk && !query.device_model && !query.idempotency_key && !query.surveyed_before) return 0;
  const std::int64_t doomed = choose(connection, query);
  if (doomed == 0) return 0;
  connection.execute("PRAGMA secure_delete = ON");  // an erased place is overwritten, not merely unlinked
  connection.prepare("DELETE FROM scan WHERE point_id IN (SELECT id FROM doomed)").run();
  connection.prepare("DELETE FROM reference_point WHERE id IN (SELECT id FROM doomed)").run();
  forget_emptied_walks(connection);
  connection.execute("PRAGMA secure_delete = OFF");
  write_transmitters(connection, count_anew(connection));
  connection.prepare("UPDATE building SET survey_version = survey_version + 1").run();
  return static_cast<std::uint64_t>(doomed);
}

}  // namespace wayfuse
