#include "db/corrector_table.hpp"

namespace wayfuse {

std::optional<CorrectorRecord> read_corrector(SqliteConnection& connection, const std::string& pipeline) {
  Statement select = connection.prepare("SELECT survey_version, content FROM corrector WHERE pipeline = ?");
  select.bind_text(1, pipeline);
  if (!select.step()) return std::nullopt;
  return CorrectorRecord{pipeline, static_cast<std::uint64_t>(select.integer(0)), std::string(select.text(1))};
}

void write_corrector(SqliteConnection& connection, const CorrectorRecord& corrector) {
  if (corrector.pipeline.empty() || corrector.pipeline.size() > 256) {
    throw StoreError({FaultCode::kOutOfRange, "pipeline", "a name of 1 to 256 bytes expected"});
  }
  if (corrector.content.empty() || corrector.content.size() > 1'000'000) {
    throw StoreError({FaultCode::kOutOfRange, "content", "1 to 1,000,000 bytes expected"});
  }
  Transaction transaction(connection);
  Statement insert = connection.prepare("INSERT OR REPLACE INTO corrector (pipeline, survey_version, content) VALUES (?, ?, ?)");
  insert.bind_text(1, corrector.pipeline).bind(2, static_cast<std::int64_t>(corrector.survey_version)).bind_text(3, corrector.content).run();
  transaction.commit();
}

}  // namespace wayfuse
