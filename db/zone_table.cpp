#include "db/zone_table.hpp"

#include <cmath>

#include "db/packing.hpp"

namespace wayfuse {
namespace {

constexpr std::int64_t kForEver = -1;

std::int64_t spell(const std::optional<Duration>& duration) { return duration ? duration->count() : kForEver; }
std::optional<Duration> duration_of(std::int64_t count) {
  return count == kForEver ? std::nullopt : std::optional(Duration(count));
}

void check_region(const Polygon& region) {
  if (region.rings.empty()) throw StoreError({FaultCode::kMissingField, "region", "a zone needs an outer ring"});
  for (std::size_t r = 0; r < region.rings.size(); ++r) {
    const std::string ring = "region.rings[" + std::to_string(r) + "]";
    if (region.rings[r].size() < 3) throw StoreError({FaultCode::kOutOfRange, ring, "a ring needs three points"});
    for (const BuildingPoint& point : region.rings[r]) {
      if (!(std::abs(point.x_m) <= 1e6 && std::abs(point.y_m) <= 1e6)) {
        throw StoreError({FaultCode::kOutOfRange, ring, "a coordinate is outside -1e6..1e6 m"});
      }
    }
  }
}

// A duration that is absent is for ever; one below zero would be read back as something else.
void check_duration(const std::optional<Duration>& duration, const char* field) {
  if (duration && *duration < Duration{0}) throw StoreError({FaultCode::kOutOfRange, field, "must not be negative"});
}

void bind(Statement& statement, const ZoneRecord& zone, const std::string& region) {
  statement.bind_text(1, zone.name).bind(2, std::int64_t{zone.floor.value}).bind_blob(3, region).bind(4, zone.exit_tolerance_m);
  statement.bind(5, spell(zone.tolerance_timeout)).bind(6, spell(zone.exit_delay)).bind(7, spell(zone.timeout));
}

StoreError unknown(std::uint64_t id) { return StoreError({FaultCode::kNotFound, "id", "there is no zone " + std::to_string(id)}); }

}  // namespace

std::vector<ZoneRecord> read_zones(SqliteConnection& connection) {
  Statement select = connection.prepare(
      "SELECT id, name, floor, region, exit_tolerance_m, tolerance_timeout_us, exit_delay_us, timeout_us FROM zone ORDER BY id");
  std::vector<ZoneRecord> zones;
  while (select.step()) {
    ZoneRecord zone;
    zone.id = static_cast<std::uint64_t>(select.integer(0));
    zone.name = select.text(1);
    zone.floor.value = static_cast<std::int32_t>(select.integer(2));
    Result<std::vector<Polygon>> region = unpack_polygons(select.blob(3));
    if (!region) throw StoreError(region.fault());
    if (region->size() != 1) throw StoreError({FaultCode::kStoreCorrupt, connection.name(), "a zone's region is not one polygon"});
    zone.region = std::move(region->front());
    zone.exit_tolerance_m = select.real(4);
    zone.tolerance_timeout = duration_of(select.integer(5));
    zone.exit_delay = duration_of(select.integer(6));
    zone.timeout = duration_of(select.integer(7));
    zones.push_back(std::move(zone));
  }
  return zones;
}

ZoneRecord write_zone(SqliteConnection& connection, ZoneRecord zone) {
  check_region(zone.region);
  check_duration(zone.tolerance_timeout, "tolerance_timeout");
  check_duration(zone.exit_delay, "exit_delay");
  check_duration(zone.timeout, "timeout");
  const std::string region = pack_polygons({zone.region});
  Transaction transaction(connection);
  if (zone.id == 0) {
    Statement insert = connection.prepare(
        "INSERT INTO zone (name, floor, region, exit_tolerance_m, tolerance_timeout_us, exit_delay_us, timeout_us) "
        "VALUES (?, ?, ?, ?, ?, ?, ?)");
    bind(insert, zone, region);
    insert.run();
    zone.id = static_cast<std::uint64_t>(connection.last_insert_id());
  } else {
    Statement update = connection.prepare(
        "UPDATE zone SET name = ?, floor = ?, region = ?, exit_tolerance_m = ?, tolerance_timeout_us = ?, exit_delay_us = ?, "
        "timeout_us = ? WHERE id = ?");
    bind(update, zone, region);
    if (update.bind(8, static_cast<std::int64_t>(zone.id)).run() == 0) throw unknown(zone.id);
  }
  transaction.commit();
  return zone;
}

void remove_zone(SqliteConnection& connection, std::uint64_t id) {
  Transaction transaction(connection);
  Statement erase = connection.prepare("DELETE FROM zone WHERE id = ?");
  if (erase.bind(1, static_cast<std::int64_t>(id)).run() == 0) throw unknown(id);
  transaction.commit();
}

}  // namespace wayfuse
