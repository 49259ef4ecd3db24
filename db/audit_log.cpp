#include "db/audit_log.hpp"

namespace wayfuse {

void write_audit(SqliteConnection& connection, const std::vector<AuditRecord>& records) {
  Transaction transaction(connection);
  Statement insert = connection.prepare("INSERT INTO audit (at_us, key_id, building, action, subject) VALUES (?, ?, ?, ?, ?)");
  for (const AuditRecord& record : records) {
    insert.bind(1, std::int64_t{record.at.time_since_epoch().count()}).bind(2, static_cast<std::int64_t>(record.key_id));
    insert.bind(3, static_cast<std::int64_t>(record.building.value)).bind_text(4, record.action).bind_text(5, record.subject).run();
  }
  transaction.commit();
}

std::vector<AuditRecord> read_audit(SqliteConnection& connection, const AuditQuery& query) {
  Statement select = connection.prepare(
      "SELECT id, at_us, key_id, building, action, subject FROM audit WHERE id > ?1 AND (?2 IS NULL OR building = ?2) "
      "AND (?3 IS NULL OR key_id = ?3) ORDER BY id LIMIT ?4");
  select.bind(1, static_cast<std::int64_t>(query.after_id)).bind(4, std::int64_t{query.most});
  if (query.building) select.bind(2, static_cast<std::int64_t>(query.building->value));
  if (query.key_id) select.bind(3, static_cast<std::int64_t>(*query.key_id));
  std::vector<AuditRecord> records;
  while (select.step()) {
    records.push_back({static_cast<std::uint64_t>(select.integer(0)), UnixTime(Duration(select.integer(1))),
                       static_cast<std::uint64_t>(select.integer(2)), {static_cast<std::uint64_t>(select.integer(3))},
                       std::string(select.text(4)), std::string(select.text(5))});
  }
  return records;
}

std::uint64_t forget_audit(SqliteConnection& connection, UnixTime before) {
  Transaction transaction(connection);
  Statement erase = connection.prepare("DELETE FROM audit WHERE at_us < ?");
  const std::int64_t gone = erase.bind(1, std::int64_t{before.time_since_epoch().count()}).run();
  transaction.commit();
  return static_cast<std::uint64_t>(gone);
}

}  // namespace wayfuse
