#pragma once

#include <string>
#include <vector>

#include "db/sqlite.hpp"
#include "db/walk_part_record.hpp"
#include "wayfuse/proto/message.hpp"

namespace wayfuse {

/// Stores a part once; the same key and body is the stored answer, another body under the key, or another part of that number, a fault.
SurveyAck store_walk_part(SqliteConnection& connection, const WalkPartDraft& part);
/// Walks whose last part and all before it are there and whose scans are not among the reference points yet.
std::vector<std::string> walks_to_place(SqliteConnection& connection);
/// Of one walk, in their order.
std::vector<std::string> read_walk_parts(SqliteConnection& connection, const std::string& walk);
void mark_placed(SqliteConnection& connection, const std::string& walk);
/// Within an open transaction: recordings of which no placed point is left go as well.
void forget_emptied_walks(SqliteConnection& connection);

}  // namespace wayfuse
