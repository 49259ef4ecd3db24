#include "db/access_point_table.hpp"

#include <algorithm>
#include <array>

namespace wayfuse {
namespace {

constexpr std::array<std::string_view, 5> kStates = {"ok", "vanished", "moved", "power_changed", "new"};
constexpr std::array<std::string_view, 3> kTrusts = {"auto", "always", "never"};

template <typename Enum, std::size_t N>
Enum named(const std::array<std::string_view, N>& names, std::string_view name) {
  return static_cast<Enum>(std::ranges::find(names, name) - names.begin());  // a CHECK keeps other names out
}

std::int64_t microseconds(UnixTime time) { return time.time_since_epoch().count(); }

}  // namespace

std::string_view to_string(AccessPointState state) { return kStates[static_cast<std::size_t>(state)]; }
std::string_view to_string(AccessPointTrust trust) { return kTrusts[static_cast<std::size_t>(trust)]; }

std::vector<AccessPointRecord> read_access_points(SqliteConnection& connection) {
  Statement select = connection.prepare(
      "SELECT bssid, trust, state, reason, heard_sessions, last_heard_at_us, distance_m, change_db, decided_at_us FROM access_point "
      "ORDER BY bssid");
  std::vector<AccessPointRecord> found;
  while (select.step()) {
    AccessPointRecord record;
    record.bssid = {static_cast<std::uint64_t>(select.integer(0))};
    record.trust = named<AccessPointTrust>(kTrusts, select.text(1));
    record.state = named<AccessPointState>(kStates, select.text(2));
    record.reason = select.text(3);
    record.heard_sessions = static_cast<std::uint64_t>(select.integer(4));
    if (!select.is_null(5)) record.last_heard_at = UnixTime(Duration(select.integer(5)));
    if (!select.is_null(6)) record.distance_m = select.real(6);
    if (!select.is_null(7)) record.change_db = select.real(7);
    record.decided_at = UnixTime(Duration(select.integer(8)));
    found.push_back(std::move(record));
  }
  return found;
}

void write_verdicts(SqliteConnection& connection, const std::vector<AccessPointRecord>& verdicts) {
  Transaction transaction(connection);
  Statement write = connection.prepare(
      "INSERT INTO access_point (bssid, trust, state, reason, heard_sessions, last_heard_at_us, distance_m, change_db, decided_at_us) "
      "VALUES (?, 'auto', ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (bssid) DO UPDATE SET state = excluded.state, reason = excluded.reason, "
      "heard_sessions = excluded.heard_sessions, last_heard_at_us = excluded.last_heard_at_us, distance_m = excluded.distance_m, "
      "change_db = excluded.change_db, decided_at_us = excluded.decided_at_us");
  for (const AccessPointRecord& verdict : verdicts) {
    write.bind(1, static_cast<std::int64_t>(verdict.bssid.value)).bind_text(2, to_string(verdict.state)).bind_text(3, verdict.reason);
    write.bind(4, static_cast<std::int64_t>(verdict.heard_sessions)).bind(8, microseconds(verdict.decided_at));
    verdict.last_heard_at ? write.bind(5, microseconds(*verdict.last_heard_at)) : write.bind_null(5);
    verdict.distance_m ? write.bind(6, *verdict.distance_m) : write.bind_null(6);
    verdict.change_db ? write.bind(7, *verdict.change_db) : write.bind_null(7);
    write.run();
  }
  transaction.commit();
}

void write_trust(SqliteConnection& connection, Bssid bssid, AccessPointTrust trust, UnixTime at) {
  Transaction transaction(connection);
  Statement write = connection.prepare(
      "INSERT INTO access_point (bssid, trust, state, reason, heard_sessions, decided_at_us) VALUES (?, ?, 'ok', '', 0, ?) "
      "ON CONFLICT (bssid) DO UPDATE SET trust = excluded.trust");
  write.bind(1, static_cast<std::int64_t>(bssid.value)).bind_text(2, to_string(trust)).bind(3, microseconds(at)).run();
  transaction.commit();
}

}  // namespace wayfuse
