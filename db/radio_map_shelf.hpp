#pragma once

#include <optional>
#include <vector>

#include "db/radio_map_record.hpp"
#include "db/sqlite.hpp"

namespace wayfuse {

/// A building's radio maps, their history and what they were measured by. Each change is one transaction; all throw StoreError.
/// Borrowed for one call.
class RadioMapShelf {
 public:
  explicit RadioMapShelf(SqliteConnection& connection) : connection_(connection) {}

  RadioMapRecord stage(const RadioMapDraft& draft);
  std::vector<RadioMapRecord> maps();
  std::string content(std::uint64_t version);
  void discard(std::uint64_t version);

  std::optional<std::uint64_t> live();
  std::vector<Publication> publications();
  Publication promote(const Publication& publication, std::optional<std::uint64_t> expected_live);
  Publication roll_back(const Publication& publication);

  QualityWalkRecord add_walk(const QualityWalkDraft& draft);
  std::vector<QualityWalkRecord> walks();
  std::string walk_content(std::uint64_t id);
  void remove_walk(std::uint64_t id);
  void note_quality(const MapQuality& quality);
  std::vector<MapQuality> qualities(std::uint64_t version);

 private:
  Publication publish(Publication publication);
  std::string checked_content(std::string_view sql, std::uint64_t id, const std::string& what);
  SqliteConnection& connection_;
};

}  // namespace wayfuse
