#pragma once

#include <cstdint>
#include <vector>

#include "db/building_database.hpp"
#include "db/sqlite.hpp"

namespace wayfuse {

/// Writes the batches of one group into an open transaction; one answer a batch. A batch that breaks a rule is undone alone.
/// Throws StoreError when the disk failed: then none of them may be acknowledged.
std::vector<Result<SurveyAck>> store_batches(SqliteConnection& connection, const std::vector<SurveyBatch>& batches);

/// Within an open transaction; answers how many points went.
std::uint64_t erase_points(SqliteConnection& connection, const EraseQuery& query);

std::vector<StoredPoint> read_points(SqliteConnection& connection, const PointQuery& query);
std::vector<UploadRecord> read_uploads(SqliteConnection& connection, std::uint64_t after, std::uint32_t most);
std::vector<TransmitterRecord> read_transmitters(SqliteConnection& connection);

}  // namespace wayfuse
