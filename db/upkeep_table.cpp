#include "db/upkeep_table.hpp"

namespace wayfuse {
namespace {

constexpr std::int64_t kKept = 100;

std::int64_t number(std::uint64_t value) { return static_cast<std::int64_t>(value); }

}  // namespace

void write_upkeep(SqliteConnection& connection, const UpkeepRecord& record) {
  const auto kind = static_cast<std::int64_t>(record.kind);
  Transaction transaction(connection);
  Statement insert = connection.prepare(
      "INSERT INTO upkeep (building, kind, at_us, key_id, survey_version, bytes, finding) VALUES (?, ?, ?, ?, ?, ?, ?)");
  insert.bind(1, number(record.building.value)).bind(2, kind).bind(3, std::int64_t{record.at.time_since_epoch().count()});
  insert.bind(4, number(record.key_id)).bind(5, number(record.survey_version)).bind(6, number(record.bytes)).bind_text(7, record.finding).run();
  Statement forget = connection.prepare(
      "DELETE FROM upkeep WHERE building = ?1 AND kind = ?2 AND id <= "
      "(SELECT id FROM upkeep WHERE building = ?1 AND kind = ?2 ORDER BY id DESC LIMIT 1 OFFSET ?3)");
  forget.bind(1, number(record.building.value)).bind(2, kind).bind(3, kKept).run();
  transaction.commit();
}

std::vector<UpkeepRecord> read_upkeep(SqliteConnection& connection, BuildingId building) {
  Statement select = connection.prepare(
      "SELECT kind, at_us, key_id, survey_version, bytes, finding FROM upkeep WHERE building = ? ORDER BY id DESC");
  select.bind(1, number(building.value));
  std::vector<UpkeepRecord> records;
  while (select.step()) {
    UpkeepRecord record;
    record.building = building;
    record.kind = static_cast<UpkeepRecord::Kind>(select.integer(0));
    record.at = UnixTime(Duration(select.integer(1)));
    record.key_id = static_cast<std::uint64_t>(select.integer(2));
    record.survey_version = static_cast<std::uint64_t>(select.integer(3));
    record.bytes = static_cast<std::uint64_t>(select.integer(4));
    record.finding = select.text(5);
    records.push_back(std::move(record));
  }
  return records;
}

}  // namespace wayfuse
