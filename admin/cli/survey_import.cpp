#include "admin/cli/survey_import.hpp"

#include <sodium.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "sdk/src/client/point_batches.hpp"

namespace wayfuse::cli {
namespace {

using Json = nlohmann::ordered_json;

// The protocol's own document with every bit of every number: its encoder keeps six decimals, its decoder all there are.
Json form_of(const ReferencePoint& point) {
  Json scans = Json::array();
  for (const RssScan& scan : point.scans) {
    Json readings = Json::array();
    for (const ScanReading& reading : scan.readings) {
      Json& row = readings.emplace_back(Json{{"bssid", to_string(reading.bssid)}, {"rss_dbm", reading.rss_dbm}, {"age_us", reading.age.count()}});
      if (reading.frequency_mhz != 0) row["frequency_mhz"] = reading.frequency_mhz;
      if (reading.range_m) row["range_m"] = *reading.range_m;
      if (reading.range_sigma_m) row["range_sigma_m"] = *reading.range_sigma_m;
    }
    scans.push_back({{"time_us", scan.time.time_since_epoch().count()}, {"readings", std::move(readings)}});
  }
  return {{"place", {{"x_m", point.place.point.x_m}, {"y_m", point.place.point.y_m}, {"floor", point.place.floor.value}}},
          {"sigma_m", point.sigma_m},
          {"device_model", point.device_model},
          {"walk", point.walk},
          {"surveyed_at_us", point.surveyed_at.time_since_epoch().count()},
          {"scans", std::move(scans)}};
}

std::size_t spelled_bytes(const ReferencePoint& point) { return form_of(point).dump().size(); }

// A batch ready to go, under 128 bits of BLAKE2b over its points.
struct Batch {
  std::string key;
  std::string document;
};
Batch batch_of(const std::vector<ReferencePoint>& points) {
  Json list = Json::array();
  for (const ReferencePoint& point : points) list.push_back(form_of(point));
  const std::string content = list.dump();
  unsigned char hash[16];
  crypto_generichash(hash, sizeof hash, reinterpret_cast<const unsigned char*>(content.data()), content.size(), nullptr, 0);
  char hex[2 * sizeof hash + 1];
  sodium_bin2hex(hex, sizeof hex, hash, sizeof hash);
  const std::string key = "import-" + std::string(hex);
  return {key, R"({"type":"survey","idempotency_key":")" + key + R"(","points":)" + content + "}"};
}

std::string refusal(const Result<Reply>& reply) {
  if (!reply) return reply.fault().cause;
  const auto problem = Json::parse(reply->body, nullptr, false);
  std::string words = "the server refused (HTTP " + std::to_string(reply->status) + ")";
  for (const char* part : {"field", "detail"}) {
    if (problem.is_object() && problem.contains(part) && problem[part].is_string()) words += ": " + problem[part].get<std::string>();
  }
  return words;
}

/// Speaks with the server about one building; what does not work is left as a complaint.
class ImportTarget {
 public:
  ImportTarget(const ImportOrder& order, const Ask& ask, std::vector<std::string>& complaints)
      : at_("/v1/buildings/" + order.building), ask_(ask), complaints_(complaints) {}

  bool read_georeference(std::optional<Georeference>& into) {
    // A surveyor's key may not read the building; whether that matters, the file says.
    if (const auto reply = ask_("GET", at_, ""); reply && reply->status == 403) return true;
    const auto building = answer("GET", at_, "");
    if (!building) return false;
    const Json reference = building->value("georeference", Json());
    if (!reference.is_object()) return true;
    constexpr double kDegree = std::numbers::pi / 180.0;
    into = Georeference{{reference["origin"].value("latitude_deg", 0.0), reference["origin"].value("longitude_deg", 0.0)},
                        reference.value("y_axis_azimuth_deg", 0.0) * kDegree};
    return true;
  }

  bool read_uploads(std::set<std::string>& keys) {
    std::uint64_t after = 0;
    do {
      const auto page = answer("GET", at_ + "/uploads?most=1000&after=" + std::to_string(after), "");
      if (!page) return false;
      for (const Json& upload : page->value("items", Json::array())) keys.insert(upload.value("idempotency_key", ""));
      after = page->value("next", std::uint64_t{0});
    } while (after != 0);
    return true;
  }

  bool upload(const Batch& batch) { return answer("POST", at_ + "/points", batch.document).has_value(); }

 private:
  std::optional<Json> answer(const std::string& method, const std::string& path, const std::string& body) {
    const auto reply = ask_(method, path, body);
    if (!reply || reply->status >= 400) {
      complaints_.push_back(method + " " + path + ": " + refusal(reply));
      return std::nullopt;
    }
    Json json = Json::parse(reply->body, nullptr, false);
    if (json.is_object()) return json;
    complaints_.push_back(method + " " + path + ": the answer is no JSON object");
    return std::nullopt;
  }

  const std::string at_;
  const Ask& ask_;
  std::vector<std::string>& complaints_;
};

// Reads every file before any is uploaded; false = something keeps the import back.
bool read_files(const ImportOrder& order, const SurveyFileSettings& settings, ImportReport& report) {
  std::size_t bad = 0;
  for (const std::string& path : order.files) {
    auto file = read_survey_file(path, settings);
    if (file) {
      bad += file->bad.size();
      report.files.push_back(*std::move(file));
    } else {
      report.complaints.push_back(file.fault().field + ": " + file.fault().cause);
    }
  }
  if (bad > 0 && !order.skip_bad) {
    report.complaints.push_back(std::to_string(bad) + (bad == 1 ? " row does" : " rows do") + " not serve: nothing was uploaded. Mend them, or leave them out with --skip-bad");
  }
  return report.complaints.empty();
}

// Whether a file may speak of the earth: only then the building is asked where it lies.
bool may_need_georeference(const ImportOrder& order) { return order.settings.format != "csv" && order.settings.format != "ilc20"; }

}  // namespace

ImportReport import_survey(const ImportOrder& order, const Ask& ask, const Progress& progress) {
  ImportReport report;
  ImportTarget target(order, ask, report.complaints);
  SurveyFileSettings settings = order.settings;
  if (may_need_georeference(order) && !target.read_georeference(settings.georeference)) return report;
  if (!read_files(order, settings, report)) return report;
  SizedPoints points;
  for (SurveyFile& file : report.files) {
    report.points += file.points.size();
    for (ReferencePoint& point : file.points) add_point(std::move(point), points, spelled_bytes);
    file.points.clear();
  }
  const auto messages = in_messages(std::move(points));
  report.batches = messages.size();
  if (order.dry_run) return report;
  std::set<std::string> there;
  if (!target.read_uploads(there)) return report;
  for (const auto& message : messages) {
    const Batch batch = batch_of(message);
    if (!there.insert(batch.key).second) {
      ++report.already_there;
    } else if (target.upload(batch)) {
      ++report.uploaded;
    } else {
      report.complaints.push_back("the same command again goes on from here");
      break;
    }
    progress(report.uploaded + report.already_there, report.batches);
  }
  return report;
}

std::string to_json(const ImportOrder& order, const ImportReport& report) {
  Json files = Json::array();
  for (const SurveyFile& file : report.files) {
    Json bad = Json::array();
    for (const RowFault& row : file.bad) bad.push_back({{"file", row.file}, {"row", row.row}, {"field", row.field}, {"cause", row.cause}});
    files.push_back({{"format", file.format}, {"rows", file.rows}, {"bad", std::move(bad)}, {"notes", file.notes}});
  }
  return Json{{"files", std::move(files)},
              {"points", report.points},
              {"batches", report.batches},
              {"uploaded", report.uploaded},
              {"already_there", report.already_there},
              {"dry_run", order.dry_run},
              {"complaints", report.complaints}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace wayfuse::cli
