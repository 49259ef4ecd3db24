#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "admin/api.hpp"
#include "admin/data_forms.hpp"
#include "admin/export.hpp"
#include "admin/json_forms.hpp"
#include "admin/query_values.hpp"

namespace wayfuse {
namespace {

constexpr std::size_t kBackupBytes = std::size_t{512} << 20;
constexpr std::size_t kPieceBytes = 64 * 1024;

struct DataRooms {
  DatabaseDirectory& databases;
  ServerControl& server;
  ZoneControl& zones;
  WebhookControl& webhooks;
  const Clock& clock;

  void changed(BuildingId id) const {
    server.building_changed(id);
    zones.zones_changed(id);
    webhooks.webhooks_changed(id);
  }
};

/// An open file that has no name any more: nothing stays behind, however the download ends.
class PassingFile final : public BodySource {
 public:
  static std::shared_ptr<PassingFile> opened(const std::filesystem::path& file) {
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
    return descriptor < 0 ? nullptr : std::make_shared<PassingFile>(descriptor);
  }
  explicit PassingFile(int descriptor) : descriptor_(descriptor) {}
  ~PassingFile() override { ::close(descriptor_); }

  std::optional<std::string> next() override {
    std::string piece(kPieceBytes, '\0');
    const ssize_t read = ::read(descriptor_, piece.data(), piece.size());
    if (read <= 0) return std::nullopt;
    piece.resize(static_cast<std::size_t>(read));
    return piece;
  }
  void on_ready(std::function<void()>) override {}

 private:
  const int descriptor_;
};

Response attachment(const char* content_type, const std::string& name) {
  Response response;
  response.content_type = content_type;
  response.headers["content-disposition"] = "attachment; filename=\"" + name + "\"";
  response.headers["cache-control"] = "no-store";
  return response;
}

std::string file_name(BuildingId id, const char* end) { return "building-" + std::to_string(id.value) + end; }

// ---------------------------------------------------------------- backup, verification, restore

constexpr std::size_t kFindingBytes = 1024;

// Writes down what was done to a building, then answers. A disk that does not take the note keeps nobody from his backup.
void note_and_answer(DataRooms rooms, BuildingDatabase& database, UpkeepRecord record, Response response, Respond respond) {
  if (const auto building = database.building()) record.survey_version = building->survey_version;
  record.at = rooms.clock.wall_now();
  record.finding.resize(std::min(record.finding.size(), kFindingBytes));
  const auto answer = std::make_shared<Response>(std::move(response));
  rooms.databases.note_upkeep(std::move(record), [answer, respond](Result<void>) { respond(std::move(*answer)); });
}

void back_up(DataRooms rooms, BuildingId id, const Request& request, Respond respond) {
  rooms.databases.with_building(id, [rooms, id, key = request.key_id, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const std::filesystem::path file = rooms.databases.passing_file();
    if (const auto copied = (*database)->back_up_to(file); !copied) return respond(problem(copied.fault()));
    std::error_code ignored;
    const std::uintmax_t bytes = std::filesystem::file_size(file, ignored);
    Response response = attachment("application/vnd.sqlite3", file_name(id, ".sqlite"));
    response.stream = PassingFile::opened(file);
    if (!response.stream) return respond(problem({FaultCode::kStorageFailed, "backup", "the copy cannot be read"}));
    note_and_answer(rooms, **database, {.building = id, .kind = UpkeepRecord::Kind::kBackup, .key_id = key, .bytes = bytes}, std::move(response), respond);
  });
}

void verify(DataRooms rooms, BuildingId id, const Request& request, Respond respond) {
  rooms.databases.with_building(id, [rooms, id, key = request.key_id, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto report = (*database)->verify();
    if (!report) return respond(problem(report.fault()));
    const std::string finding = report->wrong.empty() ? std::string() : report->wrong.front();
    note_and_answer(rooms, **database, {.building = id, .kind = UpkeepRecord::Kind::kVerification, .key_id = key, .finding = finding},
                    json_response(200, to_json(*report)), respond);
  });
}

void show_backups(DataRooms rooms, BuildingId id, const Request&, Respond respond) {
  const auto records = rooms.databases.upkeep(id);
  if (!records) return respond(problem(records.fault()));
  rooms.databases.with_building(id, [records = *records, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto building = (*database)->building();
    respond(building ? json_response(200, to_json(records, building->survey_version)) : problem(building.fault()));
  });
}

void restore(DataRooms rooms, const Request& request, Respond respond) {
  if (!request.body.starts_with("SQLite format 3")) return respond(problem({FaultCode::kUnknownType, "body", "is no SQLite file"}));
  const std::filesystem::path file = rooms.databases.passing_file();
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  bool written = descriptor >= 0;
  for (std::size_t at = 0; written && at < request.body.size();) {
    const ssize_t wrote = ::write(descriptor, request.body.data() + at, request.body.size() - at);
    written = wrote > 0;
    at += written ? static_cast<std::size_t>(wrote) : 0;
  }
  const bool full = !written && (errno == ENOSPC || errno == EDQUOT || errno == EROFS);
  if (descriptor >= 0) ::close(descriptor);
  const auto remove = [file] {
    for (const char* part : {"", "-wal", "-shm", "-journal", ".lock"}) {
      std::error_code ignored;
      std::filesystem::remove(file.string() + part, ignored);
    }
  };
  if (!written) {
    remove();
    return respond(problem({full ? FaultCode::kStorageFull : FaultCode::kStorageFailed, "body", "cannot be put down"}));
  }
  rooms.databases.restore_building(file, [rooms, remove, respond](Result<BuildingRecord> restored) {
    remove();
    if (!restored) return respond(problem(restored.fault()));
    rooms.zones.zones_changed(restored->id);
    rooms.webhooks.webhooks_changed(restored->id);
    rooms.server.building_made(restored->id, [record = *restored, respond] {
      Response response = json_response(201, to_json(record, 0, 0));
      response.headers["location"] = "/v1/buildings/" + std::to_string(record.id.value);
      respond(std::move(response));
    });
  });
}

// ---------------------------------------------------------------- removal

void remove_building(DataRooms rooms, BuildingId id, const Request&, Respond respond) {
  rooms.databases.remove_building(id, rooms.clock.wall_now(), [rooms, id, respond](Result<void> removed) {
    if (!removed) return respond(problem(removed.fault()));
    rooms.changed(id);
    respond(json_response(204, ""));
  });
}

Result<EraseQuery> erase_query(const Request& request) {
  EraseQuery query;
  const auto text = [&](const char* name, std::optional<std::string>& into) {
    if (const auto found = request.query.find(name); found != request.query.end()) into = found->second;
  };
  text("walk", query.walk);
  text("device_model", query.device_model);
  text("upload", query.idempotency_key);
  if (request.query.contains("point")) {
    const auto point = number_in<std::uint64_t>(request, "point", 0, 1, INT64_MAX);
    if (!point) return point.fault();
    query.point_id = *point;
  }
  if (request.query.contains("before_us")) {
    const auto before = number_in<std::int64_t>(request, "before_us", 0, 0, INT64_MAX);
    if (!before) return before.fault();
    query.surveyed_before = UnixTime(Duration(*before));
  }
  if (!query.point_id && !query.walk && !query.device_model && !query.idempotency_key && !query.surveyed_before) {
    return Fault{FaultCode::kMissingField, "query", "say which points: point, walk, device_model, upload or before_us; all that are given must fit"};
  }
  return query;
}

// What was learnt from erased points stays in radio maps that were built before: which ones is said.
Result<Erasure> erased_from(BuildingDatabase& database, const EraseQuery& query) {
  Erasure erasure;
  const auto erased = database.erase(query);
  if (!erased) return erased.fault();
  erasure.points = *erased;
  const auto scrubbed = database.scrub();
  if (!scrubbed) return scrubbed.fault();
  erasure.log_emptied = *scrubbed;
  const auto record = database.building();
  if (!record) return record.fault();
  const auto maps = database.maps();
  if (!maps) return maps.fault();
  for (const RadioMapRecord& map : *maps) {
    if (*erased > 0 && map.survey_version < record->survey_version) erasure.radio_maps.push_back(map.version);
  }
  return erasure;
}

void erase_points(DataRooms rooms, BuildingId id, const Request& request, Respond respond) {
  const auto query = erase_query(request);
  if (!query) return respond(problem(query.fault()));
  rooms.databases.with_building(id, [rooms, id, query = *query, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto erasure = erased_from(**database, query);
    if (!erasure) return respond(problem(erasure.fault()));
    if (erasure->points > 0) rooms.server.building_changed(id);
    respond(json_response(200, to_json(*erasure)));
  });
}

// ---------------------------------------------------------------- export, audit

void export_all(DataRooms rooms, BuildingId id, const Request&, Respond respond) {
  rooms.databases.with_building(id, [id, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    auto archive = export_archive(**database);
    if (!archive) return respond(problem(archive.fault()));
    Response response = attachment("application/zip", file_name(id, ".zip"));
    response.body = *std::move(archive);
    respond(std::move(response));
  });
}

void show_audit(DataRooms rooms, const Request& request, Respond respond) {
  const auto page = page_in(request);
  if (!page) return respond(problem(page.fault()));
  AuditQuery query;
  query.after_id = page->after;
  query.most = page->most;
  if (request.query.contains("building")) {
    const auto building = number_in<std::uint64_t>(request, "building", 0, 0, INT64_MAX);
    if (!building) return respond(problem(building.fault()));
    query.building = BuildingId{*building};
  }
  if (request.query.contains("key")) {
    const auto key = number_in<std::uint64_t>(request, "key", 0, 0, INT64_MAX);
    if (!key) return respond(problem(key.fault()));
    query.key_id = *key;
  }
  const auto lines = rooms.databases.audited(query);
  if (!lines) return respond(problem(lines.fault()));
  respond(json_response(200, to_json(*lines, lines->size() == query.most ? lines->back().id : 0)));
}

using OnBuilding = void (*)(DataRooms, BuildingId, const Request&, Respond);

Handler on_data(DataRooms rooms, OnBuilding handler) {
  return on_building([rooms, handler](BuildingId id, const Request& request, Respond respond) {
    handler(rooms, id, request, std::move(respond));
  });
}

}  // namespace

void add_data_routes(Router& router, DatabaseDirectory& databases, ServerControl& server, ZoneControl& zones, WebhookControl& webhooks,
                     const Clock& clock) {
  const DataRooms rooms{databases, server, zones, webhooks, clock};
  router.add({"GET", "/v1/buildings/{building}/backup", Scope::kAdmin, "The building's database, consistent, as one SQLite file", on_data(rooms, back_up)});
  router.add({"GET", "/v1/buildings/{building}/verification", Scope::kAdmin, "Read everything and hold it against its hashes", on_data(rooms, verify)});
  router.add({"GET", "/v1/buildings/{building}/backups", Scope::kAdmin, "When it was backed up and verified, and what that gave", on_data(rooms, show_backups)});
  router.add({"GET", "/v1/buildings/{building}/export.zip", Scope::kAdmin, "Everything an operator put in, as CSV, GeoJSON and JSON",
              on_data(rooms, export_all)});
  router.add({"DELETE", "/v1/buildings/{building}/points", Scope::kAdmin, "Erase reference points that fit the query", on_data(rooms, erase_points)});
  router.add({"DELETE", "/v1/buildings/{building}", Scope::kAdmin, "Remove a building for good", on_data(rooms, remove_building)});
  Route restoring{"POST", "/v1/restore", Scope::kAdmin, "Put a building back from a backup",
                  [rooms](const Request& request, const PathValues&, Respond respond) { restore(rooms, request, std::move(respond)); }};
  restoring.body_bytes = kBackupBytes;
  router.add(std::move(restoring));
  router.add({"GET", "/v1/audit", Scope::kAdmin, "Who changed or saw what, oldest first",
              [rooms](const Request& request, const PathValues&, Respond respond) { show_audit(rooms, request, std::move(respond)); }});
}

}  // namespace wayfuse
