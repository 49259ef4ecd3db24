#include "admin/data_forms.hpp"

#include <nlohmann/json.hpp>

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string to_json(const VerifyReport& report) {
  return Json{{"sound", report.wrong.empty()},
              {"uploads", report.uploads},
              {"uploads_proven", report.uploads_proven},
              {"points", report.points},
              {"scans", report.scans},
              {"readings", report.readings},
              {"transmitters", report.transmitters},
              {"contents", report.contents},
              {"wrong", report.wrong}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string to_json(const std::vector<UpkeepRecord>& records, std::uint64_t survey_version) {
  Json json{{"survey_version", survey_version}, {"backups", Json::array()}, {"verifications", Json::array()}};
  for (const UpkeepRecord& record : records) {
    Json entry{{"at_us", record.at.time_since_epoch().count()}, {"by_key", record.key_id}, {"survey_version", record.survey_version}};
    if (record.kind == UpkeepRecord::Kind::kBackup) {
      entry["bytes"] = record.bytes;
      json["backups"].push_back(std::move(entry));
    } else {
      entry["sound"] = record.finding.empty();
      entry["finding"] = record.finding.empty() ? Json(nullptr) : Json(record.finding);
      json["verifications"].push_back(std::move(entry));
    }
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string to_json(const Erasure& erasure) {
  return Json{{"erased", erasure.points}, {"log_emptied", erasure.log_emptied}, {"radio_maps_built_before", erasure.radio_maps}}.dump();
}

std::string to_json(const std::vector<AuditRecord>& lines, std::uint64_t next) {
  Json json;
  json["audit"] = Json::array();
  for (const AuditRecord& line : lines) {
    json["audit"].push_back({{"id", line.id},
                             {"at_us", line.at.time_since_epoch().count()},
                             {"key", line.key_id},
                             {"building", line.building.value},
                             {"action", line.action},
                             {"subject", line.subject}});
  }
  if (next != 0) json["next"] = next;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace wayfuse
