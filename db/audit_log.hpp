#pragma once

#include <vector>

#include "db/audit_record.hpp"
#include "db/sqlite.hpp"

namespace wayfuse {

/// In one transaction; throws StoreError.
void write_audit(SqliteConnection& connection, const std::vector<AuditRecord>& records);
std::vector<AuditRecord> read_audit(SqliteConnection& connection, const AuditQuery& query);
/// Retention; answers how many lines went.
std::uint64_t forget_audit(SqliteConnection& connection, UnixTime before);

}  // namespace wayfuse
