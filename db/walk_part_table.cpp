#include "db/walk_part_table.hpp"

#include "db/content_hash.hpp"

namespace wayfuse {
namespace {

SurveyAck answer_of(const WalkPartDraft& part, std::int64_t scans, std::int64_t version) {
  return {part.idempotency_key, static_cast<std::uint32_t>(scans), static_cast<std::uint64_t>(version)};
}

void check_place_is_free(SqliteConnection& connection, const WalkPartDraft& part) {
  Statement same = connection.prepare("SELECT 1 FROM walk_part WHERE walk = ? AND part = ?");
  if (same.bind_text(1, part.walk).bind(2, std::int64_t{part.part}).step()) {
    throw StoreError({FaultCode::kConflict, "part", "walk '" + part.walk + "' has a part " + std::to_string(part.part) + " already"});
  }
  Statement ended = connection.prepare("SELECT part FROM walk_part WHERE walk = ? AND last = 1");
  ended.bind_text(1, part.walk);
  if (ended.step() && (part.last || ended.integer(0) < std::int64_t{part.part})) {
    throw StoreError({FaultCode::kConflict, "part",
                      "walk '" + part.walk + "' ended with part " + std::to_string(ended.integer(0))});
  }
  Statement points = connection.prepare(
      "SELECT 1 FROM survey_walk AS w JOIN reference_point AS p ON p.walk_id = w.id WHERE w.name = ? "
      "AND NOT EXISTS (SELECT 1 FROM walk_part WHERE walk = w.name) LIMIT 1");
  if (points.bind_text(1, part.walk).step()) {
    throw StoreError({FaultCode::kConflict, "walk", "points of a walk '" + part.walk + "' are there already"});
  }
}

}  // namespace

SurveyAck store_walk_part(SqliteConnection& connection, const WalkPartDraft& part) {
  const std::string hash = sha256(part.content);
  Transaction transaction(connection);
  Statement earlier = connection.prepare("SELECT sha256, scans, survey_version FROM walk_part WHERE idempotency_key = ?");
  if (earlier.bind_text(1, part.idempotency_key).step()) {
    if (earlier.blob(0) != hash) {
      throw StoreError({FaultCode::kIdempotencyConflict, "idempotency_key",
                        "'" + part.idempotency_key + "' was used before with another body"});
    }
    return answer_of(part, earlier.integer(1), earlier.integer(2));
  }
  check_place_is_free(connection, part);
  const std::int64_t version = connection.integer("SELECT survey_version FROM building");
  Statement insert = connection.prepare(
      "INSERT INTO walk_part (idempotency_key, walk, part, last, scans, survey_version, sha256, content) VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  insert.bind_text(1, part.idempotency_key).bind_text(2, part.walk).bind(3, std::int64_t{part.part});
  insert.bind(4, std::int64_t{part.last}).bind(5, std::int64_t{part.scans}).bind(6, version).bind_blob(7, hash).bind_blob(8, part.content).run();
  transaction.commit();
  return answer_of(part, part.scans, version);
}

std::vector<std::string> walks_to_place(SqliteConnection& connection) {
  Statement select = connection.prepare(
      "SELECT walk FROM walk_part WHERE placed = 0 GROUP BY walk HAVING max(last) = 1 AND count(*) = max(part) + 1 ORDER BY min(id)");
  std::vector<std::string> walks;
  while (select.step()) walks.emplace_back(select.text(0));
  return walks;
}

std::vector<std::string> read_walk_parts(SqliteConnection& connection, const std::string& walk) {
  Statement select = connection.prepare("SELECT content, sha256 FROM walk_part WHERE walk = ? ORDER BY part");
  select.bind_text(1, walk);
  std::vector<std::string> parts;
  while (select.step()) {
    parts.emplace_back(select.blob(0));
    if (sha256(parts.back()) != select.blob(1)) {
      throw StoreError({FaultCode::kStoreCorrupt, connection.name(), "a part of walk '" + walk + "' is not what was stored: a bit has changed"});
    }
  }
  return parts;
}

void mark_placed(SqliteConnection& connection, const std::string& walk) {
  Transaction transaction(connection);
  connection.prepare("UPDATE walk_part SET placed = 1 WHERE walk = ?").bind_text(1, walk).run();
  transaction.commit();
}

void forget_emptied_walks(SqliteConnection& connection) {
  connection
      .prepare("DELETE FROM walk_part WHERE placed = 1 AND walk NOT IN "
               "(SELECT w.name FROM survey_walk AS w JOIN reference_point AS p ON p.walk_id = w.id)")
      .run();
}

}  // namespace wayfuse
