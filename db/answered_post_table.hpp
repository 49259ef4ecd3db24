#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "db/answered_post.hpp"
#include "db/sqlite.hpp"

namespace wayfuse {

/// What is to become of a row: replaced, or forgotten where there is no record.
struct AnsweredPostChange {
  std::string name;
  std::optional<AnsweredPost> record;
};

/// Writes changes in order, in one transaction, and forgets what began before `oldest`.
void write_answered_posts(SqliteConnection& connection, std::span<const AnsweredPostChange> changes, UnixTime oldest);
/// Ascending by time.
std::vector<AnsweredPost> read_answered_posts(SqliteConnection& connection);

}  // namespace wayfuse
