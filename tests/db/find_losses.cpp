#include <sqlite3.h>

#include <bit>
#include <cinttypes>
#include <cstdio>
#include <set>

#include "tests/db/journal.hpp"

// The second opinion: knows the file's tables and blob layout from db/README.md, shares no code with the store.
namespace wayfuse::testing {
namespace {

class Query {
 public:
  Query(sqlite3* connection, const char* sql, std::vector<std::string>& wrong) : wrong_(wrong), connection_(connection) {
    if (sqlite3_prepare_v2(connection, sql, -1, &statement_, nullptr) != SQLITE_OK) complain();
  }
  ~Query() { sqlite3_finalize(statement_); }
  Query& bind(std::int64_t value) {
    sqlite3_reset(statement_);
    sqlite3_bind_int64(statement_, 1, value);
    return *this;
  }
  bool next() {
    const int code = sqlite3_step(statement_);
    if (code != SQLITE_ROW && code != SQLITE_DONE) complain();
    return code == SQLITE_ROW;
  }
  std::int64_t integer(int column) { return sqlite3_column_int64(statement_, column); }
  double real(int column) { return sqlite3_column_double(statement_, column); }
  std::string bytes(int column) {
    const auto* data = static_cast<const char*>(sqlite3_column_blob(statement_, column));
    return {data != nullptr ? data : "", static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
  }

 private:
  void complain() { wrong_.push_back(std::string("SQLite: ") + sqlite3_errmsg(connection_)); }
  std::vector<std::string>& wrong_;
  sqlite3* connection_;
  sqlite3_stmt* statement_ = nullptr;
};

std::string format(const char* pattern, double value) {
  char text[40];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

struct Heard {
  std::int64_t readings = 0;
  double strongest_dbm = -1000;
};

// A packed scan, spelled as journal.cpp spells it; counts into `heard`.
std::string spell_readings(const std::string& blob, std::map<std::int64_t, Heard>& heard) {
  std::string text;
  std::size_t at = 0;
  const auto number = [&](int bytes) {
    std::uint64_t value = 0;
    for (int i = 0; i < bytes; ++i) value |= std::uint64_t{static_cast<unsigned char>(blob.at(at++))} << (8 * i);
    return value;
  };
  while (at < blob.size()) {
    const std::uint64_t flags = number(1);
    double rss = static_cast<std::int8_t>(number(1));
    const std::uint64_t frequency = number(2);
    const std::uint64_t age = number(4);
    const std::uint64_t bssid = number(6);
    if (flags & 1) rss = std::bit_cast<double>(number(8));
    const std::string range = flags & 2 ? format("%a", std::bit_cast<double>(number(8))) : "-";
    const std::string sigma = flags & 4 ? format("%a", std::bit_cast<double>(number(8))) : "-";
    char address[20];
    std::snprintf(address, sizeof address, "%016" PRIx64, bssid);
    text += std::string(address) + ' ' + format("%a", rss) + ' ' + std::to_string(age) + ' ' + std::to_string(frequency) + ' ' + range + ' ' +
            sigma + '\n';
    Heard& counted = heard[static_cast<std::int64_t>(bssid)];
    ++counted.readings;
    counted.strongest_dbm = std::max(counted.strongest_dbm, rss);
  }
  return text;
}

// Digests of an upload's points in the order they were sent.
std::vector<std::uint64_t> digests_of(Query& points, Query& scans, std::int64_t upload, std::map<std::int64_t, Heard>& heard) {
  std::vector<std::uint64_t> digests;
  points.bind(upload);
  while (points.next()) {
    std::string text = format("%a", points.real(1)) + ' ' + format("%a", points.real(2)) + ' ' + std::to_string(points.integer(3)) + ' ' +
                       format("%a", points.real(4)) + ' ' + std::to_string(points.integer(5)) + '\n' + points.bytes(6) + '\n' +
                       points.bytes(7) + '\n';
    scans.bind(points.integer(0));
    while (scans.next()) text += "scan " + std::to_string(scans.integer(0)) + '\n' + spell_readings(scans.bytes(1), heard);
    digests.push_back(fnv1a(text));
  }
  return digests;
}

void check_uploads(sqlite3* connection, const Journal& journal, bool settled, std::vector<std::string>& wrong) {
  Query uploads(connection, "SELECT id, idempotency_key, stored, survey_version FROM upload ORDER BY id", wrong);
  Query points(connection,
               "SELECT p.id, x_m, y_m, floor, sigma_m, surveyed_at_us, m.name, coalesce(w.name, '') FROM reference_point p "
               "JOIN device_model m ON m.id = device_model_id LEFT JOIN survey_walk w ON w.id = walk_id WHERE upload_id = ? ORDER BY p.id",
               wrong);
  Query scans(connection, "SELECT phone_time_us, readings FROM scan WHERE point_id = ? ORDER BY ordinal", wrong);
  std::set<std::string> present;
  std::set<std::int64_t> versions;
  std::map<std::int64_t, Heard> heard;
  while (uploads.next()) {
    const std::string key = uploads.bytes(1);
    const auto sent = journal.find(key);
    versions.insert(uploads.integer(3));
    const std::vector<std::uint64_t> digests = digests_of(points, scans, uploads.integer(0), heard);
    if (sent == journal.end() || sent->second.digests.empty()) {
      wrong.push_back(key + ": stored, but never sent");
      continue;
    }
    if (!present.insert(key).second) wrong.push_back(key + ": stored twice");
    if (digests != sent->second.digests) wrong.push_back(key + ": its points are not those that were sent");
    if (uploads.integer(2) != static_cast<std::int64_t>(digests.size())) wrong.push_back(key + ": its row counts other points");
    if (sent->second.acked && static_cast<std::uint64_t>(uploads.integer(3)) != sent->second.survey_version) {
      wrong.push_back(key + ": stored as another version than acknowledged");
    }
  }
  for (const auto& [key, entry] : journal) {
    if (entry.acked && present.count(key) == 0) wrong.push_back(key + ": acknowledged, and lost");
    if (entry.answers_differ) wrong.push_back(key + ": acknowledged twice, differently");
    if (settled && present.count(key) == 0) wrong.push_back(key + ": sent and retried, and not there");
  }
  Query version(connection, "SELECT survey_version FROM building", wrong);
  const std::int64_t reached = version.next() ? version.integer(0) : -1;
  if (reached != static_cast<std::int64_t>(versions.size()) || (reached > 0 && (*versions.begin() != 1 || *versions.rbegin() != reached))) {
    wrong.push_back("survey versions do not run 1.." + std::to_string(reached));
  }
  Query transmitters(connection, "SELECT bssid, readings, strongest_dbm FROM transmitter", wrong);
  std::size_t rows = 0;
  for (; transmitters.next(); ++rows) {
    const Heard counted = heard[transmitters.integer(0)];
    if (counted.readings != transmitters.integer(1) || counted.strongest_dbm != transmitters.real(2)) wrong.push_back("a transmitter's row disagrees with its scans");
  }
  if (rows != heard.size()) wrong.push_back("transmitters are missing or too many");
}

}  // namespace

std::vector<std::string> find_losses(const std::filesystem::path& database, const Journal& journal, bool settled) {
  std::vector<std::string> wrong;
  sqlite3* connection = nullptr;
  if (sqlite3_open_v2(database.c_str(), &connection, SQLITE_OPEN_READONLY, nullptr) != SQLITE_OK) {
    wrong.push_back("cannot open " + database.string());
    sqlite3_close(connection);
    return wrong;
  }
  {
    Query integrity(connection, "PRAGMA integrity_check", wrong);
    if (!integrity.next() || integrity.bytes(0) != "ok") wrong.push_back("integrity_check: " + integrity.bytes(0));
    Query keys(connection, "PRAGMA foreign_key_check", wrong);
    if (keys.next()) wrong.push_back("foreign_key_check finds orphans");
    Query orphans(connection, "SELECT count(*) FROM reference_point WHERE upload_id NOT IN (SELECT id FROM upload)", wrong);
    if (orphans.next() && orphans.integer(0) != 0) wrong.push_back("points without an upload");
    check_uploads(connection, journal, settled, wrong);
  }
  sqlite3_close(connection);
  return wrong;
}

}  // namespace wayfuse::testing
