#pragma once

#include <optional>

#include "db/corrector_record.hpp"
#include "db/sqlite.hpp"

namespace wayfuse {

/// Each in one transaction; throw StoreError (kOutOfRange, what the disk says).
std::optional<CorrectorRecord> read_corrector(SqliteConnection& connection, const std::string& pipeline);
/// Replaces the pipeline's older one.
void write_corrector(SqliteConnection& connection, const CorrectorRecord& corrector);

}  // namespace wayfuse
