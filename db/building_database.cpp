#include "db/building_database.hpp"

#include <optional>

#include "db/access_point_table.hpp"
#include "db/corrector_table.hpp"
#include "db/directory_files.hpp"
#include "db/file_lock.hpp"
#include "db/floor_images.hpp"
#include "db/packing.hpp"
#include "db/radio_map_shelf.hpp"
#include "db/schema.hpp"
#include "db/survey_store.hpp"
#include "db/verification.hpp"
#include "db/walk_part_table.hpp"
#include "db/webhook_table.hpp"
#include "db/zone_table.hpp"

namespace wayfuse {
namespace {

void write_description(SqliteConnection& connection, const BuildingRecord& building) {
  Statement update = connection.prepare(
      "UPDATE building SET name = ?, latitude_deg = ?, longitude_deg = ?, y_axis_azimuth_rad = ?, declination_rad = ?, "
      "dip_rad = ?, norm_ut = ?, pipeline = ?, publication = ?");
  update.bind_text(1, building.name);
  if (building.georeference) {
    update.bind(2, building.georeference->origin.latitude_deg).bind(3, building.georeference->origin.longitude_deg);
    update.bind(4, building.georeference->y_axis_azimuth_rad);
  }
  update.bind(5, building.magnetic_field.declination_rad).bind(6, building.magnetic_field.dip_rad);
  update.bind(7, building.magnetic_field.norm_ut).bind_text(8, building.pipeline);
  update.bind_text(9, building.publication == PublicationPolicy::kAutomatic ? "automatic" : "reviewed").run();
}

void write_floors(SqliteConnection& connection, const std::vector<Floor>& floors) {
  connection.prepare("DELETE FROM floor").run();
  Statement insert = connection.prepare("INSERT INTO floor (ordinal, label, outline, walkable, walls) VALUES (?, ?, ?, ?, ?)");
  for (const Floor& floor : floors) {
    const std::string outline = floor.outline.rings.empty() ? std::string() : pack_polygons({floor.outline});
    const std::string walkable = pack_polygons(floor.walkable);
    const std::string walls = floor.walls.empty() ? std::string() : pack_polygons({Polygon{floor.walls}});
    insert.bind(1, std::int64_t{floor.ordinal.value}).bind_text(2, floor.label).bind_blob(3, outline).bind_blob(4, walkable);
    insert.bind_blob(5, walls).run();
  }
}

std::vector<Polygon> polygons(std::string_view blob) {
  Result<std::vector<Polygon>> unpacked = unpack_polygons(blob);
  if (!unpacked) throw StoreError(unpacked.fault());
  return std::move(*unpacked);
}

std::vector<Floor> read_floors(SqliteConnection& connection) {
  std::vector<Floor> floors;
  Statement select = connection.prepare("SELECT ordinal, label, outline, walkable, walls FROM floor ORDER BY ordinal");
  while (select.step()) {
    Floor floor;
    floor.ordinal.value = static_cast<std::int32_t>(select.integer(0));
    floor.label = select.text(1);
    if (!select.blob(2).empty()) {
      std::vector<Polygon> outline = polygons(select.blob(2));
      if (outline.size() != 1) throw StoreError({FaultCode::kStoreCorrupt, connection.name(), "a floor's outline is not one polygon"});
      floor.outline = std::move(outline.front());
    }
    floor.walkable = polygons(select.blob(3));
    if (!select.blob(4).empty()) {
      std::vector<Polygon> walls = polygons(select.blob(4));
      if (walls.size() != 1) throw StoreError({FaultCode::kStoreCorrupt, connection.name(), "a floor's walls are not one set"});
      floor.walls = std::move(walls.front().rings);
    }
    floors.push_back(std::move(floor));
  }
  return floors;
}

BuildingRecord read_building(SqliteConnection& connection) {
  Statement select = connection.prepare(
      "SELECT id, name, latitude_deg, longitude_deg, y_axis_azimuth_rad, declination_rad, dip_rad, norm_ut, pipeline, "
      "survey_version, publication FROM building");
  if (!select.step()) throw StoreError({FaultCode::kStoreCorrupt, connection.name(), "the building's own row is missing"});
  BuildingRecord building;
  building.id.value = static_cast<std::uint64_t>(select.integer(0));
  building.name = select.text(1);
  if (!select.is_null(2)) building.georeference = Georeference{{select.real(2), select.real(3)}, select.real(4)};
  building.magnetic_field = {select.real(5), select.real(6), select.real(7)};
  building.pipeline = select.text(8);
  building.survey_version = static_cast<std::uint64_t>(select.integer(9));
  building.publication = select.text(10) == "automatic" ? PublicationPolicy::kAutomatic : PublicationPolicy::kReviewed;
  building.floors = read_floors(connection);
  return building;
}

// Floors come back ascending; what cannot be told apart after a round trip is refused here, by name.
Result<void> check(const BuildingRecord& building) {
  if (building.id.value == 0 || building.id.value > static_cast<std::uint64_t>(INT64_MAX)) {
    return Fault{FaultCode::kOutOfRange, "id", std::to_string(building.id.value) + " is outside 1..9223372036854775807"};
  }
  if (building.name.empty()) return Fault{FaultCode::kMissingField, "name", "a building needs a name"};
  for (std::size_t i = 1; i < building.floors.size(); ++i) {
    if (building.floors[i].ordinal <= building.floors[i - 1].ordinal) {
      return Fault{FaultCode::kOutOfRange, "floors[" + std::to_string(i) + "].ordinal", "floors must ascend without doubles"};
    }
  }
  return {};
}

ConnectionSettings settings_of(const BuildingDatabase::OpenOptions& options) { 
  return {options.vfs, options.synchronous_normal, options.checkpoint_pages};
}

}  // namespace

struct BuildingDatabase::Connection {
  std::filesystem::path file;
  ConnectionSettings settings;
  FileLock lock;
  std::unique_ptr<SqliteConnection> sqlite;
  std::optional<Fault> corruption;

  // After any fault the connection is dropped and made anew at the next call: what SQLite believes of a disk that failed is
  // not worth keeping, and a disk that recovered is used again without a restart.
  template <typename Call>
  auto run(Call&& call) -> Result<decltype(call(*sqlite))> {
    auto result = as_result([&] {
      if (sqlite == nullptr) sqlite = reopen_database(file, settings);
      return call(*sqlite);
    });
    if (result) return result;
    if (result.fault().code == FaultCode::kStoreCorrupt) {
      corruption = result.fault();
      if (sqlite != nullptr) sqlite->keep_log_on_close();
    }
    sqlite.reset();
    return result;
  }
};

BuildingDatabase::BuildingDatabase(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}
BuildingDatabase::BuildingDatabase(BuildingDatabase&&) noexcept = default;
BuildingDatabase& BuildingDatabase::operator=(BuildingDatabase&&) noexcept = default;
BuildingDatabase::~BuildingDatabase() = default;

Result<BuildingDatabase> BuildingDatabase::create(const std::filesystem::path& file, const BuildingRecord& building,
                                                  const OpenOptions& options) {
  if (Result<void> good = check(building); !good) return good.fault();
  return as_result([&] {
    FileLock lock(file);
    auto sqlite = create_database(file, building_schema(), settings_of(options), [&](SqliteConnection& connection) {
      Statement insert = connection.prepare(
          "INSERT INTO building (singleton, id, name, declination_rad, dip_rad, norm_ut, pipeline, survey_version) "
          "VALUES (1, ?, 'new', 0, 0, 0, 'new', ?)");
      insert.bind(1, static_cast<std::int64_t>(building.id.value)).bind(2, static_cast<std::int64_t>(building.survey_version)).run();
      write_description(connection, building);
      write_floors(connection, building.floors);
    });
    return BuildingDatabase(std::unique_ptr<Connection>(new Connection{file, settings_of(options), std::move(lock), std::move(sqlite), std::nullopt}));
  });
}

Result<BuildingDatabase> BuildingDatabase::open(const std::filesystem::path& file, const OpenOptions& options) {
  return as_result([&] {
    FileLock lock(file);
    auto sqlite = open_database(file, building_schema(), settings_of(options));
    return BuildingDatabase(std::unique_ptr<Connection>(new Connection{file, settings_of(options), std::move(lock), std::move(sqlite), std::nullopt}));
  });
}

const std::optional<Fault>& BuildingDatabase::corruption() const { return connection_->corruption; }

Result<BuildingRecord> BuildingDatabase::building() { return connection_->run(read_building); }

Result<void> BuildingDatabase::update(const BuildingRecord& building) {
  if (Result<void> good = check(building); !good) return good;
  return connection_->run([&](SqliteConnection& sqlite) {
    Transaction transaction(sqlite);
    write_description(sqlite, building);
    write_floors(sqlite, building.floors);
    transaction.commit();
  });
}

std::vector<Result<SurveyAck>> BuildingDatabase::store(const std::vector<SurveyBatch>& batches) {
  auto answers = connection_->run([&](SqliteConnection& sqlite) {
    Transaction transaction(sqlite);
    std::vector<Result<SurveyAck>> written = store_batches(sqlite, batches);
    transaction.commit();
    return written;
  });
  if (answers) return std::move(*answers);
  return std::vector<Result<SurveyAck>>(batches.size(), answers.fault());
}

Result<std::vector<StoredPoint>> BuildingDatabase::points(const PointQuery& query) {
  return connection_->run([&](SqliteConnection& sqlite) { return read_points(sqlite, query); });
}

Result<std::uint64_t> BuildingDatabase::count_points() {
  return connection_->run([](SqliteConnection& sqlite) {
    return static_cast<std::uint64_t>(sqlite.integer("SELECT count(*) FROM reference_point"));
  });
}

Result<std::vector<UploadRecord>> BuildingDatabase::uploads(std::uint64_t after, std::uint32_t most) {
  return connection_->run([&](SqliteConnection& sqlite) { return read_uploads(sqlite, after, most); });
}

Result<std::vector<TransmitterRecord>> BuildingDatabase::transmitters() { return connection_->run(read_transmitters); }

Result<SurveyAck> BuildingDatabase::store_walk_part(const WalkPartDraft& part) {
  return connection_->run([&](SqliteConnection& sqlite) { return wayfuse::store_walk_part(sqlite, part); });
}
Result<std::vector<std::string>> BuildingDatabase::walks_to_place() { return connection_->run(wayfuse::walks_to_place); }
Result<std::vector<std::string>> BuildingDatabase::walk_parts(const std::string& walk) {
  return connection_->run([&](SqliteConnection& sqlite) { return read_walk_parts(sqlite, walk); });
}
Result<void> BuildingDatabase::mark_placed(const std::string& walk) {
  return connection_->run([&](SqliteConnection& sqlite) { wayfuse::mark_placed(sqlite, walk); });
}

Result<std::vector<AccessPointRecord>> BuildingDatabase::access_points() { return connection_->run(read_access_points); }
Result<void> BuildingDatabase::note_verdicts(const std::vector<AccessPointRecord>& verdicts) {
  return connection_->run([&](SqliteConnection& sqlite) { write_verdicts(sqlite, verdicts); });
}
Result<void> BuildingDatabase::set_trust(Bssid bssid, AccessPointTrust trust, UnixTime at) {
  return connection_->run([&](SqliteConnection& sqlite) { write_trust(sqlite, bssid, trust, at); });
}

Result<std::uint64_t> BuildingDatabase::erase(const EraseQuery& query) {
  return connection_->run([&](SqliteConnection& sqlite) {
    Transaction transaction(sqlite);
    const std::uint64_t erased = erase_points(sqlite, query);
    transaction.commit();
    return erased;
  });
}

Result<bool> BuildingDatabase::scrub() {
  return connection_->run([&](SqliteConnection& sqlite) {
    remove_old_copies(connection_->file);
    return sqlite.integer("PRAGMA wal_checkpoint(TRUNCATE)") == 0;
  });
}

Result<std::vector<ZoneRecord>> BuildingDatabase::zones() { return connection_->run(read_zones); }

Result<ZoneRecord> BuildingDatabase::put_zone(const ZoneRecord& zone) {
  return connection_->run([&](SqliteConnection& sqlite) { return write_zone(sqlite, zone); });
}

Result<void> BuildingDatabase::remove_zone(std::uint64_t id) {
  return connection_->run([&](SqliteConnection& sqlite) { wayfuse::remove_zone(sqlite, id); });
}

Result<std::vector<WebhookRecord>> BuildingDatabase::webhooks() { return connection_->run(read_webhooks); }
Result<WebhookRecord> BuildingDatabase::put_webhook(const WebhookRecord& webhook) {
  return connection_->run([&](SqliteConnection& sqlite) { return write_webhook(sqlite, webhook); });
}
Result<void> BuildingDatabase::remove_webhook(std::uint64_t id) {
  return connection_->run([&](SqliteConnection& sqlite) { wayfuse::remove_webhook(sqlite, id); });
}

Result<void> BuildingDatabase::put_floor_image(const FloorImage& image) {
  return connection_->run([&](SqliteConnection& sqlite) { write_floor_image(sqlite, image); });
}
Result<FloorImage> BuildingDatabase::floor_image(FloorOrdinal floor) {
  return connection_->run([&](SqliteConnection& sqlite) { return read_floor_image(sqlite, floor); });
}
Result<std::vector<FloorOrdinal>> BuildingDatabase::floor_images() { return connection_->run(read_floors_with_image); }
Result<void> BuildingDatabase::remove_floor_image(FloorOrdinal floor) {
  return connection_->run([&](SqliteConnection& sqlite) { wayfuse::remove_floor_image(sqlite, floor); });
}

Result<RadioMapRecord> BuildingDatabase::stage_map(const RadioMapDraft& draft) {
  return connection_->run([&](SqliteConnection& sqlite) { return RadioMapShelf(sqlite).stage(draft); });
}
Result<std::vector<RadioMapRecord>> BuildingDatabase::maps() {
  return connection_->run([](SqliteConnection& sqlite) { return RadioMapShelf(sqlite).maps(); });
}
Result<std::string> BuildingDatabase::map_content(std::uint64_t version) {
  return connection_->run([&](SqliteConnection& sqlite) { return RadioMapShelf(sqlite).content(version); });
}
Result<void> BuildingDatabase::discard_map(std::uint64_t version) {
  return connection_->run([&](SqliteConnection& sqlite) { RadioMapShelf(sqlite).discard(version); });
}
Result<std::optional<std::uint64_t>> BuildingDatabase::live_map() {
  return connection_->run([](SqliteConnection& sqlite) { return RadioMapShelf(sqlite).live(); });
}
Result<std::vector<Publication>> BuildingDatabase::publications() {
  return connection_->run([](SqliteConnection& sqlite) { return RadioMapShelf(sqlite).publications(); });
}
Result<Publication> BuildingDatabase::promote(const Publication& publication, std::optional<std::uint64_t> expected_live) {
  return connection_->run([&](SqliteConnection& sqlite) { return RadioMapShelf(sqlite).promote(publication, expected_live); });
}
Result<Publication> BuildingDatabase::roll_back(const Publication& publication) {
  return connection_->run([&](SqliteConnection& sqlite) { return RadioMapShelf(sqlite).roll_back(publication); });
}
Result<QualityWalkRecord> BuildingDatabase::add_quality_walk(const QualityWalkDraft& draft) {
  return connection_->run([&](SqliteConnection& sqlite) { return RadioMapShelf(sqlite).add_walk(draft); });
}
Result<std::vector<QualityWalkRecord>> BuildingDatabase::quality_walks() {
  return connection_->run([](SqliteConnection& sqlite) { return RadioMapShelf(sqlite).walks(); });
}
Result<std::string> BuildingDatabase::quality_walk_content(std::uint64_t id) {
  return connection_->run([&](SqliteConnection& sqlite) { return RadioMapShelf(sqlite).walk_content(id); });
}
Result<void> BuildingDatabase::remove_quality_walk(std::uint64_t id) {
  return connection_->run([&](SqliteConnection& sqlite) { RadioMapShelf(sqlite).remove_walk(id); });
}
Result<void> BuildingDatabase::note_quality(const MapQuality& quality) {
  return connection_->run([&](SqliteConnection& sqlite) { RadioMapShelf(sqlite).note_quality(quality); });
}
Result<std::vector<MapQuality>> BuildingDatabase::qualities(std::uint64_t version) {
  return connection_->run([&](SqliteConnection& sqlite) { return RadioMapShelf(sqlite).qualities(version); });
}

Result<std::optional<CorrectorRecord>> BuildingDatabase::corrector(const std::string& pipeline) {
  return connection_->run([&](SqliteConnection& sqlite) { return read_corrector(sqlite, pipeline); });
}
Result<void> BuildingDatabase::keep_corrector(const CorrectorRecord& corrector) {
  return connection_->run([&](SqliteConnection& sqlite) { write_corrector(sqlite, corrector); });
}

Result<VerifyReport> BuildingDatabase::verify() { return connection_->run(verify_building); }

Result<void> BuildingDatabase::back_up_to(const std::filesystem::path& file) {
  if (std::filesystem::exists(file)) return Fault{FaultCode::kConflict, file.filename().string(), "there is such a file already"};
  return connection_->run([&](SqliteConnection& sqlite) { sqlite.back_up_to(file, connection_->settings.vfs); });
}

}  // namespace wayfuse
