#include "db/verification.hpp"

#include <map>

#include "db/body_hash.hpp"
#include "db/packing.hpp"
#include "db/radio_map_shelf.hpp"
#include "db/walk_part_table.hpp"

namespace wayfuse {
namespace {

class Verification {
 public:
  explicit Verification(SqliteConnection& connection) : connection_(connection) {}

  VerifyReport run() {
    check_pages();
    if (!report_.wrong.empty()) return report_;  // what lies on broken pages is not worth reading
    Statement uploads = connection_.prepare("SELECT id, idempotency_key, stored, body_hash FROM upload ORDER BY id");
    while (uploads.step()) check_upload(uploads.integer(0), std::string(uploads.text(1)), uploads.integer(2), std::string(uploads.blob(3)));
    check_transmitters();
    check_contents();
    return report_;
  }

 private:
  void complain(std::string what) { report_.wrong.push_back(std::move(what)); }

  void check_pages() {
    Statement integrity = connection_.prepare("PRAGMA integrity_check(20)");
    while (integrity.step()) {
      if (integrity.text(0) != "ok") complain(std::string(integrity.text(0)));
    }
    Statement references = connection_.prepare("PRAGMA foreign_key_check");
    while (references.step()) complain("a row of " + std::string(references.text(0)) + " refers to nothing");
  }

  void check_upload(std::int64_t id, const std::string& key, std::int64_t stored, const std::string& body_hash) {
    ++report_.uploads;
    Statement points = connection_.prepare(
        "SELECT p.id, floor, x_m, y_m, sigma_m, m.name, coalesce(w.name, ''), surveyed_at_us, "
        "(SELECT count(*) FROM scan WHERE point_id = p.id) FROM reference_point AS p JOIN device_model AS m ON m.id = device_model_id "
        "LEFT JOIN survey_walk AS w ON w.id = walk_id WHERE p.upload_id = ? ORDER BY p.id");
    points.bind(1, id);
    BodyHash hash;
    std::int64_t found = 0;
    for (; points.step(); ++found) {
      ReferencePoint point;
      point.place = {{points.real(2), points.real(3)}, {static_cast<std::int32_t>(points.integer(1))}};
      point.sigma_m = points.real(4);
      point.device_model = points.text(5);
      point.walk = points.text(6);
      point.surveyed_at = UnixTime(Duration(points.integer(7)));
      point.scans.resize(static_cast<std::size_t>(points.integer(8)));
      hash.add(point);
      check_scans(points.integer(0), hash);
    }
    report_.points += static_cast<std::uint64_t>(found);
    if (found > stored) complain("upload " + key + " has more points than it brought");
    if (found != stored) return;  // some were erased: the hash of the rest is not known
    if (hash.finish() != body_hash) return complain("upload " + key + " is not what was sent: a bit has changed");
    ++report_.uploads_proven;
  }

  void check_scans(std::int64_t point, BodyHash& hash) {
    Statement scans = connection_.prepare("SELECT phone_time_us, readings FROM scan WHERE point_id = ? ORDER BY ordinal");
    scans.bind(1, point);
    while (scans.step()) {
      ++report_.scans;
      hash.add(PhoneTime(Duration(scans.integer(0))), scans.blob(1));
      const Result<std::vector<ScanReading>> readings = unpack_readings(scans.blob(1));
      if (!readings) {
        complain("a scan of point " + std::to_string(point) + " does not follow its layout");
        continue;
      }
      report_.readings += readings->size();
      for (const ScanReading& reading : *readings) {
        auto [heard, first] = heard_.try_emplace(reading.bssid.value, 0, reading.rss_dbm);
        ++heard->second.first;
        heard->second.second = std::max(heard->second.second, reading.rss_dbm);
      }
    }
  }

  void check_transmitters() {
    Statement rows = connection_.prepare("SELECT bssid, readings, strongest_dbm FROM transmitter");
    while (rows.step()) {
      ++report_.transmitters;
      const auto heard = heard_.find(static_cast<std::uint64_t>(rows.integer(0)));
      if (heard == heard_.end() || heard->second.first != rows.integer(1) || heard->second.second != rows.real(2)) {
        complain("transmitter " + to_string(Bssid{static_cast<std::uint64_t>(rows.integer(0))}) + " disagrees with the scans");
      }
    }
    if (report_.transmitters != heard_.size()) complain("transmitters are missing");
  }

  // Radio maps and quality walks against their sha256.
  void check_contents() {
    RadioMapShelf shelf(connection_);
    const auto check = [&](auto read) {
      try {
        read();
        ++report_.contents;
      } catch (const StoreError& error) {
        if (error.fault().code != FaultCode::kStoreCorrupt) throw;
        complain(error.fault().cause);
      }
    };
    for (const RadioMapRecord& map : shelf.maps()) check([&] { shelf.content(map.version); });
    for (const QualityWalkRecord& walk : shelf.walks()) check([&] { shelf.walk_content(walk.id); });
    std::vector<std::string> recorded;
    Statement walks = connection_.prepare("SELECT DISTINCT walk FROM walk_part ORDER BY walk");
    while (walks.step()) recorded.emplace_back(walks.text(0));
    for (const std::string& walk : recorded) check([&] { read_walk_parts(connection_, walk); });
  }

  SqliteConnection& connection_;
  VerifyReport report_;
  std::map<std::uint64_t, std::pair<std::int64_t, double>> heard_;  // readings, strongest
};

}  // namespace

VerifyReport verify_building(SqliteConnection& connection) { return Verification(connection).run(); }

}  // namespace wayfuse
