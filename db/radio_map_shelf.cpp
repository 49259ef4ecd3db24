#include "db/radio_map_shelf.hpp"

#include <bit>

#include "db/content_hash.hpp"
#include "db/packing.hpp"

namespace wayfuse {
namespace {

std::int64_t number(std::uint64_t value) { return static_cast<std::int64_t>(value); }
std::int64_t microseconds(UnixTime time) { return time.time_since_epoch().count(); }
UnixTime time_of(std::int64_t microseconds) { return UnixTime(Duration(microseconds)); }

StoreError not_found(const std::string& what, std::uint64_t id) {
  return StoreError({FaultCode::kNotFound, what, "there is no " + what + " " + std::to_string(id)});
}

std::string pack_floats(const std::vector<float>& values) {
  Packer packer;
  for (const float value : values) packer.u32(std::bit_cast<std::uint32_t>(value));
  return packer.take();
}
std::vector<float> unpack_floats(std::string_view blob) {
  std::vector<float> values;
  for (std::size_t at = 0; at + 4 <= blob.size(); at += 4) {
    std::uint32_t bits = 0;
    for (std::size_t byte = 4; byte-- > 0;) bits = bits << 8 | static_cast<unsigned char>(blob[at + byte]);
    values.push_back(std::bit_cast<float>(bits));
  }
  return values;
}

RadioMapRecord map_of(Statement& row) {
  return {static_cast<std::uint64_t>(row.integer(0)), static_cast<std::uint64_t>(row.integer(1)), std::string(row.text(2)),
          time_of(row.integer(3)), std::string(row.blob(4)), static_cast<std::uint64_t>(row.integer(5))};
}

Publication publication_of(Statement& row) {
  Publication publication;
  publication.id = static_cast<std::uint64_t>(row.integer(0));
  publication.version = static_cast<std::uint64_t>(row.integer(1));
  publication.act = row.text(2) == "promoted" ? Publication::Act::kPromoted : Publication::Act::kRolledBack;
  publication.at = time_of(row.integer(3));
  publication.by_key = static_cast<std::uint64_t>(row.integer(4));
  publication.reason = row.text(5);
  return publication;
}

QualityWalkRecord walk_of(Statement& row) {
  return {static_cast<std::uint64_t>(row.integer(0)), std::string(row.text(1)), std::string(row.text(2)), time_of(row.integer(3)),
          std::string(row.blob(4)), static_cast<std::uint64_t>(row.integer(5))};
}

}  // namespace

RadioMapRecord RadioMapShelf::stage(const RadioMapDraft& draft) {
  const std::string hash = sha256(draft.content);
  Transaction transaction(connection_);
  // A version is never below its survey's: whoever waits for a survey to be on the map compares the two numbers.
  Statement insert = connection_.prepare(
      "INSERT INTO radio_map (version, survey_version, recipe, built_at_us, sha256, content) SELECT max(?1, 1 + max("
      "coalesce((SELECT seq FROM sqlite_sequence WHERE name = 'radio_map'), 0), coalesce((SELECT max(version) FROM radio_map), 0))), "
      "?1, ?2, ?3, ?4, ?5 WHERE NOT EXISTS (SELECT 1 FROM radio_map WHERE sha256 = ?4)");
  insert.bind(1, number(draft.survey_version)).bind_text(2, draft.recipe).bind(3, microseconds(draft.built_at));
  insert.bind_blob(4, hash).bind_blob(5, draft.content).run();
  Statement find = connection_.prepare(
      "SELECT version, survey_version, recipe, built_at_us, sha256, length(content) FROM radio_map WHERE sha256 = ?");
  find.bind_blob(1, hash).step();
  RadioMapRecord staged = map_of(find);
  transaction.commit();
  return staged;
}

std::vector<RadioMapRecord> RadioMapShelf::maps() {
  Statement select = connection_.prepare(
      "SELECT version, survey_version, recipe, built_at_us, sha256, length(content) FROM radio_map ORDER BY version");
  std::vector<RadioMapRecord> maps;
  while (select.step()) maps.push_back(map_of(select));
  return maps;
}

std::string RadioMapShelf::checked_content(std::string_view sql, std::uint64_t id, const std::string& what) {
  Statement select = connection_.prepare(sql);
  if (!select.bind(1, number(id)).step()) throw not_found(what, id);
  std::string content(select.blob(0));
  if (sha256(content) != select.blob(1)) {
    throw StoreError({FaultCode::kStoreCorrupt, connection_.name(), what + " " + std::to_string(id) + " is not what was stored: a bit has changed"});
  }
  return content;
}

std::string RadioMapShelf::content(std::uint64_t version) {
  return checked_content("SELECT content, sha256 FROM radio_map WHERE version = ?", version, "radio map");
}

void RadioMapShelf::discard(std::uint64_t version) {
  Transaction transaction(connection_);
  Statement published = connection_.prepare("SELECT 1 FROM publication WHERE version = ?");
  if (published.bind(1, number(version)).step()) {
    throw StoreError({FaultCode::kConflict, "version", "radio map " + std::to_string(version) + " was published: fixes name it"});
  }
  Statement erase = connection_.prepare("DELETE FROM radio_map WHERE version = ?");
  if (erase.bind(1, number(version)).run() == 0) throw not_found("radio map", version);
  transaction.commit();
}

std::optional<std::uint64_t> RadioMapShelf::live() {
  Statement newest = connection_.prepare("SELECT version FROM publication ORDER BY id DESC LIMIT 1");
  if (!newest.step()) return std::nullopt;
  return static_cast<std::uint64_t>(newest.integer(0));
}

std::vector<Publication> RadioMapShelf::publications() {
  Statement select = connection_.prepare("SELECT id, version, act, at_us, by_key, reason FROM publication ORDER BY id");
  std::vector<Publication> history;
  while (select.step()) history.push_back(publication_of(select));
  return history;
}

Publication RadioMapShelf::publish(Publication publication) {
  Statement insert = connection_.prepare("INSERT INTO publication (version, act, at_us, by_key, reason) VALUES (?, ?, ?, ?, ?)");
  insert.bind(1, number(publication.version));
  insert.bind_text(2, publication.act == Publication::Act::kPromoted ? "promoted" : "rolled back");
  insert.bind(3, microseconds(publication.at)).bind(4, number(publication.by_key)).bind_text(5, publication.reason).run();
  publication.id = static_cast<std::uint64_t>(connection_.last_insert_id());
  return publication;
}

Publication RadioMapShelf::promote(const Publication& publication, std::optional<std::uint64_t> expected_live) {
  Transaction transaction(connection_);
  const std::optional<std::uint64_t> now = live();
  if (now != expected_live) {
    throw StoreError({FaultCode::kConflict, "expected_live", "version " + (now ? std::to_string(*now) : "none") + " is live now"});
  }
  Statement known = connection_.prepare("SELECT 1 FROM radio_map WHERE version = ?");
  if (!known.bind(1, number(publication.version)).step()) throw not_found("radio map", publication.version);
  if (now == publication.version) throw StoreError({FaultCode::kConflict, "version", "it is live already"});
  Publication promoted = publication;
  promoted.act = Publication::Act::kPromoted;
  promoted = publish(promoted);
  transaction.commit();
  return promoted;
}

Publication RadioMapShelf::roll_back(const Publication& publication) {
  Transaction transaction(connection_);
  // What was live before the live version was last promoted; so that a second rollback goes one further, not back again.
  Statement before = connection_.prepare(
      "SELECT version FROM publication WHERE id < (SELECT max(id) FROM publication WHERE act = 'promoted' AND version = "
      "(SELECT version FROM publication ORDER BY id DESC LIMIT 1)) ORDER BY id DESC LIMIT 1");
  if (!before.step()) throw StoreError({FaultCode::kConflict, "version", "no version was live before"});
  Publication back = publication;
  back.version = static_cast<std::uint64_t>(before.integer(0));
  back.act = Publication::Act::kRolledBack;
  back = publish(back);
  transaction.commit();
  return back;
}

QualityWalkRecord RadioMapShelf::add_walk(const QualityWalkDraft& draft) {
  const std::string hash = sha256(draft.content);
  Transaction transaction(connection_);
  Statement taken = connection_.prepare("SELECT 1 FROM quality_walk WHERE name = ?1 AND sha256 <> ?2");
  if (taken.bind_text(1, draft.name).bind_blob(2, hash).step()) {
    throw StoreError({FaultCode::kConflict, "name", "another walk is called '" + draft.name + "'"});
  }
  Statement insert = connection_.prepare(
      "INSERT INTO quality_walk (name, device_model, recorded_at_us, sha256, content) VALUES (?, ?, ?, ?, ?) ON CONFLICT (sha256) DO NOTHING");
  insert.bind_text(1, draft.name).bind_text(2, draft.device_model).bind(3, microseconds(draft.recorded_at));
  insert.bind_blob(4, hash).bind_blob(5, draft.content).run();
  Statement find = connection_.prepare(
      "SELECT id, name, device_model, recorded_at_us, sha256, length(content) FROM quality_walk WHERE sha256 = ?");
  find.bind_blob(1, hash).step();
  QualityWalkRecord added = walk_of(find);
  transaction.commit();
  return added;
}

std::vector<QualityWalkRecord> RadioMapShelf::walks() {
  Statement select =
      connection_.prepare("SELECT id, name, device_model, recorded_at_us, sha256, length(content) FROM quality_walk ORDER BY id");
  std::vector<QualityWalkRecord> walks;
  while (select.step()) walks.push_back(walk_of(select));
  return walks;
}

std::string RadioMapShelf::walk_content(std::uint64_t id) {
  return checked_content("SELECT content, sha256 FROM quality_walk WHERE id = ?", id, "quality walk");
}

void RadioMapShelf::remove_walk(std::uint64_t id) {
  Transaction transaction(connection_);
  Statement erase = connection_.prepare("DELETE FROM quality_walk WHERE id = ?");
  if (erase.bind(1, number(id)).run() == 0) throw not_found("quality walk", id);
  transaction.commit();
}

void RadioMapShelf::note_quality(const MapQuality& quality) {
  Transaction transaction(connection_);
  Statement map = connection_.prepare("SELECT 1 FROM radio_map WHERE version = ?");
  if (!map.bind(1, number(quality.version)).step()) throw not_found("radio map", quality.version);
  Statement walk = connection_.prepare("SELECT 1 FROM quality_walk WHERE id = ?");
  if (!walk.bind(1, number(quality.walk_id)).step()) throw not_found("quality walk", quality.walk_id);
  Statement write = connection_.prepare(
      "INSERT OR REPLACE INTO map_quality (version, walk_id, measured_at_us, measured_with, asked, instants, mean_m, rmse_m, median_m, p90_m, "
      "floor_hit, in68, in95, error_quantiles_m) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  const std::string quantiles = pack_floats(quality.error_quantiles_m);
  write.bind(1, number(quality.version)).bind(2, number(quality.walk_id)).bind(3, microseconds(quality.measured_at));
  write.bind_text(4, quality.measured_with).bind(5, number(quality.asked)).bind(6, number(quality.instants)).bind(7, quality.mean_m);
  write.bind(8, quality.rmse_m).bind(9, quality.median_m).bind(10, quality.p90_m).bind(11, quality.floor_hit).bind(12, quality.in68);
  write.bind(13, quality.in95).bind_blob(14, quantiles).run();
  transaction.commit();
}

std::vector<MapQuality> RadioMapShelf::qualities(std::uint64_t version) {
  Statement select = connection_.prepare(
      "SELECT version, walk_id, measured_at_us, instants, mean_m, rmse_m, median_m, p90_m, floor_hit, in68, in95, asked, measured_with, "
      "error_quantiles_m FROM map_quality WHERE version = ? ORDER BY walk_id");
  select.bind(1, number(version));
  std::vector<MapQuality> measured;
  while (select.step()) {
    measured.push_back({static_cast<std::uint64_t>(select.integer(0)), static_cast<std::uint64_t>(select.integer(1)), time_of(select.integer(2)),
                        static_cast<std::uint64_t>(select.integer(3)), select.real(4), select.real(5), select.real(6), select.real(7),
                        select.real(8), select.real(9), select.real(10), static_cast<std::uint64_t>(select.integer(11)),
                        std::string(select.text(12)), unpack_floats(select.blob(13))});
  }
  return measured;
}

}  // namespace wayfuse
