#include "db/survey_store.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>

#include "db/body_hash.hpp"
#include "db/packing.hpp"

namespace wayfuse {
namespace {

// A batch made ready for the disk before the transaction touches it.
struct PackedBatch {
  std::vector<std::vector<std::string>> readings;  // a blob a scan, a list a point
  std::string body_hash;
};

std::string at(const char* list, std::size_t index) { return std::string(list) + "[" + std::to_string(index) + "]"; }

Result<PackedBatch> pack(const SurveyBatch& batch) {
  PackedBatch packed;
  BodyHash hash;
  for (std::size_t p = 0; p < batch.points.size(); ++p) {
    const ReferencePoint& point = batch.points[p];
    hash.add(point);
    std::vector<std::string>& blobs = packed.readings.emplace_back();
    for (std::size_t s = 0; s < point.scans.size(); ++s) {
      Result<std::string> blob = pack_readings(point.scans[s].readings, at("points", p) + "." + at("scans", s));
      if (!blob) return blob.fault();
      hash.add(point.scans[s].time, *blob);
      blobs.push_back(std::move(*blob));
    }
  }
  packed.body_hash = hash.finish();
  return packed;
}

// The answer given before under this key; a conflict if the body was another one; absent if the key is new.
std::optional<Result<SurveyAck>> earlier_answer(SqliteConnection& connection, const SurveyBatch& batch, const PackedBatch& packed) {
  Statement find = connection.prepare("SELECT body_hash, stored, survey_version FROM upload WHERE idempotency_key = ?");
  find.bind_text(1, batch.idempotency_key);
  if (!find.step()) return std::nullopt;
  if (find.blob(0) != packed.body_hash) {
    return Fault{FaultCode::kIdempotencyConflict, "idempotency_key", "'" + batch.idempotency_key + "' was used before with another body"};
  }
  return SurveyAck{batch.idempotency_key, static_cast<std::uint32_t>(find.integer(1)), static_cast<std::uint64_t>(find.integer(2))};
}

// The id of a name in a table of names, made when new; remembered over one batch.
class NameTable {
 public:
  NameTable(SqliteConnection& connection, std::string_view insert, std::string_view select)
      : connection_(connection), insert_(insert), select_(select) {}

  std::int64_t id_of(const std::string& name) {
    if (const auto known = ids_.find(name); known != ids_.end()) return known->second;
    Statement insert = connection_.prepare(insert_);
    insert.bind_text(1, name).run();
    Statement select = connection_.prepare(select_);
    select.bind_text(1, name).step();
    return ids_[name] = select.integer(0);
  }

 private:
  SqliteConnection& connection_;
  std::string_view insert_;
  std::string_view select_;
  std::map<std::string, std::int64_t> ids_;
};

class BatchWriter {
 public:
  explicit BatchWriter(SqliteConnection& connection)
      : connection_(connection),
        models_(connection, "INSERT INTO device_model (name) VALUES (?) ON CONFLICT DO NOTHING", "SELECT id FROM device_model WHERE name = ?"),
        walks_(connection, "INSERT INTO survey_walk (name) VALUES (?) ON CONFLICT DO NOTHING", "SELECT id FROM survey_walk WHERE name = ?") {}

  SurveyAck write(const SurveyBatch& batch, const PackedBatch& packed) {
    const std::int64_t version = next_version();
    const std::int64_t upload = write_upload(batch, packed, version);
    for (std::size_t p = 0; p < batch.points.size(); ++p) write_point(upload, batch.points[p], packed.readings[p]);
    write_transmitters();
    return {batch.idempotency_key, static_cast<std::uint32_t>(batch.points.size()), static_cast<std::uint64_t>(version)};
  }

 private:
  struct Heard {
    std::uint16_t frequency_mhz = 0;
    std::int64_t readings = 0;
    double strongest_dbm = -120;
    std::int64_t first_us = 0;
    std::int64_t last_us = 0;
  };

  std::int64_t next_version() {
    connection_.prepare("UPDATE building SET survey_version = survey_version + 1").run();
    return connection_.integer("SELECT survey_version FROM building");
  }

  std::int64_t write_upload(const SurveyBatch& batch, const PackedBatch& packed, std::int64_t version) {
    Statement insert = connection_.prepare("INSERT INTO upload (idempotency_key, body_hash, stored, survey_version) VALUES (?, ?, ?, ?)");
    insert.bind_text(1, batch.idempotency_key).bind_blob(2, packed.body_hash);
    insert.bind(3, static_cast<std::int64_t>(batch.points.size())).bind(4, version).run();
    return connection_.last_insert_id();
  }

  void write_point(std::int64_t upload, const ReferencePoint& point, const std::vector<std::string>& readings) {
    const std::int64_t surveyed_us = point.surveyed_at.time_since_epoch().count();
    const std::int64_t model = models_.id_of(point.device_model);
    Statement insert = connection_.prepare(
        "INSERT INTO reference_point (upload_id, floor, x_m, y_m, sigma_m, device_model_id, walk_id, surveyed_at_us) "
        "VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
    insert.bind(1, upload).bind(2, std::int64_t{point.place.floor.value}).bind(3, point.place.point.x_m).bind(4, point.place.point.y_m);
    insert.bind(5, point.sigma_m).bind(6, model).bind(8, surveyed_us);
    if (!point.walk.empty()) insert.bind(7, walks_.id_of(point.walk));
    insert.run();
    write_scans(connection_.last_insert_id(), point, readings);
    for (const RssScan& scan : point.scans) {
      for (const ScanReading& reading : scan.readings) hear(reading, surveyed_us);
    }
  }

  void write_scans(std::int64_t point_id, const ReferencePoint& point, const std::vector<std::string>& readings) {
    Statement insert = connection_.prepare("INSERT INTO scan (point_id, ordinal, phone_time_us, readings) VALUES (?, ?, ?, ?)");
    for (std::size_t s = 0; s < point.scans.size(); ++s) {
      insert.bind(1, point_id).bind(2, static_cast<std::int64_t>(s)).bind(3, std::int64_t{point.scans[s].time.time_since_epoch().count()});
      insert.bind_blob(4, readings[s]).run();
    }
  }

  void hear(const ScanReading& reading, std::int64_t at_us) {
    Heard& heard = heard_[reading.bssid.value];
    if (heard.readings == 0) heard = {reading.frequency_mhz, 0, reading.rss_dbm, at_us, at_us};
    ++heard.readings;
    if (reading.frequency_mhz != 0) heard.frequency_mhz = reading.frequency_mhz;
    heard.strongest_dbm = std::max(heard.strongest_dbm, reading.rss_dbm);
    heard.first_us = std::min(heard.first_us, at_us);
    heard.last_us = std::max(heard.last_us, at_us);
  }

  void write_transmitters() {
    Statement upsert = connection_.prepare(
        "INSERT INTO transmitter (bssid, frequency_mhz, readings, strongest_dbm, first_heard_at_us, last_heard_at_us) "
        "VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT (bssid) DO UPDATE SET "
        "frequency_mhz = CASE excluded.frequency_mhz WHEN 0 THEN frequency_mhz ELSE excluded.frequency_mhz END, "
        "readings = readings + excluded.readings, strongest_dbm = max(strongest_dbm, excluded.strongest_dbm), "
        "first_heard_at_us = min(first_heard_at_us, excluded.first_heard_at_us), "
        "last_heard_at_us = max(last_heard_at_us, excluded.last_heard_at_us)");
    for (const auto& [bssid, heard] : heard_) {
      upsert.bind(1, static_cast<std::int64_t>(bssid)).bind(2, std::int64_t{heard.frequency_mhz}).bind(3, heard.readings);
      upsert.bind(4, heard.strongest_dbm).bind(5, heard.first_us).bind(6, heard.last_us).run();
    }
  }

  SqliteConnection& connection_;
  NameTable models_;
  NameTable walks_;
  std::unordered_map<std::uint64_t, Heard> heard_;
};

Result<SurveyAck> store_one(SqliteConnection& connection, const SurveyBatch& batch) {
  const Result<PackedBatch> packed = pack(batch);
  if (!packed) return packed.fault();
  if (std::optional<Result<SurveyAck>> answer = earlier_answer(connection, batch, *packed)) return *answer;
  Savepoint savepoint(connection);
  try {
    SurveyAck ack = BatchWriter(connection).write(batch, *packed);
    savepoint.release();
    return ack;
  } catch (const StoreError& error) {
    if (error.fault().code != FaultCode::kOutOfRange) throw;
    savepoint.undo();
    return Fault{FaultCode::kOutOfRange, "points", error.fault().cause};
  }
}

}  // namespace

std::vector<Result<SurveyAck>> store_batches(SqliteConnection& connection, const std::vector<SurveyBatch>& batches) {
  std::vector<Result<SurveyAck>> answers;
  answers.reserve(batches.size());
  for (const SurveyBatch& batch : batches) answers.push_back(store_one(connection, batch));
  return answers;
}

std::vector<StoredPoint> read_points(SqliteConnection& connection, const PointQuery& query) {
  Statement select = connection.prepare(
      "SELECT p.id, p.floor, p.x_m, p.y_m, p.sigma_m, m.name, w.name, p.surveyed_at_us, s.phone_time_us, s.readings "
      "FROM (SELECT * FROM reference_point WHERE id > ?1 AND (?2 IS NULL OR floor = ?2) "
      "AND (?4 IS NULL OR upload_id IN (SELECT id FROM upload WHERE survey_version <= ?4)) ORDER BY id LIMIT ?3) AS p "
      "JOIN device_model AS m ON m.id = p.device_model_id LEFT JOIN survey_walk AS w ON w.id = p.walk_id "
      "LEFT JOIN scan AS s ON s.point_id = p.id ORDER BY p.id, s.ordinal");
  select.bind(1, static_cast<std::int64_t>(query.after_id)).bind(3, std::int64_t{query.most});
  if (query.through_version) select.bind(4, static_cast<std::int64_t>(*query.through_version));
  if (query.floor) select.bind(2, std::int64_t{query.floor->value});
  std::vector<StoredPoint> points;
  while (select.step()) {
    const auto id = static_cast<std::uint64_t>(select.integer(0));
    if (points.empty() || points.back().id != id) {
      ReferencePoint point;
      point.place = {{select.real(2), select.real(3)}, {static_cast<std::int32_t>(select.integer(1))}};
      point.sigma_m = select.real(4);
      point.device_model = select.text(5);
      point.walk = select.text(6);
      point.surveyed_at = UnixTime(Duration(select.integer(7)));
      points.push_back({id, std::move(point)});
    }
    if (select.is_null(8)) continue;
    Result<std::vector<ScanReading>> readings = unpack_readings(select.blob(9));
    if (!readings) throw StoreError(readings.fault());
    points.back().point.scans.push_back({PhoneTime(Duration(select.integer(8))), std::move(*readings)});
  }
  return points;
}

std::vector<UploadRecord> read_uploads(SqliteConnection& connection, std::uint64_t after, std::uint32_t most) {
  std::vector<UploadRecord> uploads;
  Statement select = connection.prepare("SELECT id, idempotency_key, stored, survey_version FROM upload WHERE id > ? ORDER BY id LIMIT ?");
  select.bind(1, static_cast<std::int64_t>(after)).bind(2, std::int64_t{most});
  while (select.step()) {
    uploads.push_back({static_cast<std::uint64_t>(select.integer(0)), std::string(select.text(1)), static_cast<std::uint64_t>(select.integer(2)),
                       static_cast<std::uint64_t>(select.integer(3))});
  }
  return uploads;
}

std::vector<TransmitterRecord> read_transmitters(SqliteConnection& connection) {
  Statement select = connection.prepare("SELECT bssid, frequency_mhz, readings, strongest_dbm FROM transmitter ORDER BY bssid");
  std::vector<TransmitterRecord> transmitters;
  while (select.step()) {
    transmitters.push_back({{static_cast<std::uint64_t>(select.integer(0))}, static_cast<std::uint16_t>(select.integer(1)),
                            static_cast<std::uint64_t>(select.integer(2)), select.real(3)});
  }
  return transmitters;
}

}  // namespace wayfuse
