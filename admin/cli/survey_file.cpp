#include "admin/cli/survey_file.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <regex>
#include <set>

#include "sdk/src/recording/import/fingerprint_table.hpp"
#include "sdk/src/recording/import/import.hpp"
#include "wayfuse/proto/codec.hpp"
#include "wayfuse/sdk/surveyor.hpp"

namespace wayfuse::cli {
namespace {

constexpr std::array<std::string_view, 5> kFormats = {"csv", "geojson", "uji", "ilc20", "getsensordata"};
constexpr std::size_t kBeginning = 16 * 1024;

Fault needs_georeference(const std::string& path, const char* what) {
  return {FaultCode::kMissingField, path, std::string(what) + ", and the building has no georeference: lay it on the earth first (wayfuse building georeference)"};
}

// `file:line: cause` as the readers of recordings complain; anything else is a note.
void take_complaint(const std::string& path, const std::string& complaint, SurveyFile& file) {
  const std::regex shape(R"(:(\d+): (.*))");
  std::smatch match;
  const std::string rest = complaint.starts_with(path) ? complaint.substr(path.size()) : "";
  if (std::regex_match(rest, match, shape)) {
    file.bad.push_back({path, std::stoul(match[1]), "", match[2]});
  } else {
    file.notes.push_back(complaint);
  }
}

// ---------------------------------------------------------------- walks

Result<void> place_walk(const std::string& path, const ImportedRecording& recording, const SurveyFileSettings& settings, SurveyFile& file) {
  const std::string& device = recording.header.device_model.empty() ? settings.device_model : recording.header.device_model;
  Surveyor surveyor(device, Random(1));
  if (const auto begun = surveyor.begin_walk(std::filesystem::path(path).stem().string()); !begun) return begun.fault();
  const UnixTime began = recording.header.started_at == UnixTime{} ? written_at(path) : recording.header.started_at;
  if (recording.header.started_at == UnixTime{}) file.notes.push_back(path + ": tells no wall clock: surveyed when the file was written");
  std::optional<PhoneTime> marked;
  std::size_t marks = 0;
  for (const RecordedEvent& event : recording.events) {
    Result<void> taken;
    if (const auto* mark = std::get_if<TruthMark>(&event)) {
      if (marked == mark->time) continue;  // marked twice in one millisecond
      marked = mark->time;
      ++marks;
      taken = surveyor.mark(mark->time, mark->place, 0.0);
    } else if (const auto* scan = std::get_if<RssScan>(&event)) {
      taken = surveyor.scan(*scan, began + (scan->time - time_of(recording.events.front())));
    }
    if (!taken) return Fault{taken.fault().code, path, taken.fault().field + ": " + taken.fault().cause};
  }
  if (marks < 2) return Fault{FaultCode::kMissingField, path, "a walk needs two marks of where the walker was; this one has " + std::to_string(marks)};
  if (const auto ended = surveyor.end_walk(); !ended) return ended.fault();
  for (SurveyBatch& batch : surveyor.take_batches()) {
    std::ranges::move(batch.points, std::back_inserter(file.points));
  }
  if (surveyor.readings_left_out() > 0) {
    file.notes.push_back(path + ": " + std::to_string(surveyor.readings_left_out()) + " readings were heard outside the marks: they have no place");
  }
  return {};
}

Result<SurveyFile> read_recording(const std::string& path, const SurveyFileSettings& settings) {
  if (settings.format == "getsensordata" && !settings.georeference) return needs_georeference(path, "its places are latitudes and longitudes");
  const auto recording = import_recording(settings.format, path, {settings.floor, settings.georeference});
  if (!recording) return recording.fault();
  SurveyFile file;
  for (const std::string& complaint : recording->complaints) take_complaint(path, complaint, file);
  file.rows = recording->events.size() + file.bad.size();
  if (const auto placed = place_walk(path, *recording, settings, file); !placed) return placed.fault();
  return file;
}

// ---------------------------------------------------------------- UJIIndoorLoc

// Web Mercator, EPSG:3857: a sphere of the equator's radius.
GeoPoint from_web_mercator(BuildingPoint units) {
  constexpr double kRadius_m = 6378137.0;
  constexpr double kDegree = std::numbers::pi / 180.0;
  return {(2.0 * std::atan(std::exp(units.y_m / kRadius_m)) - std::numbers::pi / 2.0) / kDegree, units.x_m / kRadius_m / kDegree};
}

// The collection names no access points but its columns: each gets an address that no maker has.
Bssid address_of_column(std::uint16_t column) { return {0x020000000000ULL + column + 1}; }

ReferencePoint point_of(const TabledScan& row, const Georeference& frame) {
  RssScan scan{PhoneTime(std::chrono::seconds(row.unix_s)), {}};
  for (const TabledScan::Heard& heard : row.heard) scan.readings.push_back({address_of_column(heard.access_point), heard.rss_dbm, {}, 0, {}, {}});
  return {{frame.to_building(from_web_mercator(row.point)), row.floor}, 0.0, "UJI phone " + std::to_string(row.phone), {},
          UnixTime(std::chrono::seconds(row.unix_s)), {std::move(scan)}};
}

Result<SurveyFile> read_uji_points(const std::string& path, const SurveyFileSettings& settings) {
  if (!settings.georeference) return needs_georeference(path, "its places are Web Mercator");
  SurveyFile file;
  std::vector<BadRow> bad;
  const auto table = read_uji(path, &bad);
  if (!table) return table.fault();
  for (BadRow& row : bad) file.bad.push_back({path, static_cast<std::size_t>(row.line), std::move(row.column), std::move(row.cause)});
  file.rows = table->scans.size() + bad.size();
  std::set<int> buildings;
  for (const TabledScan& scan : table->scans) buildings.insert(scan.building);
  if (buildings.size() > 1 && !settings.source_building) {
    std::string names;
    for (const int building : buildings) names += (names.empty() ? "" : ", ") + std::to_string(building);
    return Fault{FaultCode::kMissingField, path, "holds several buildings (BUILDINGID " + names + "): say which with --source-building"};
  }
  for (const TabledScan& scan : table->scans) {
    if (!settings.source_building || scan.building == *settings.source_building) file.points.push_back(point_of(scan, *settings.georeference));
  }
  file.notes.push_back(path + ": its access points are columns: WAP001 is " + to_string(address_of_column(0)));
  return file;
}

}  // namespace

std::string to_string(const RowFault& fault) {
  return fault.file + ":" + std::to_string(fault.row) + ": " + (fault.field.empty() ? "" : fault.field + ": ") + fault.cause;
}

std::span<const std::string_view> survey_formats() { return kFormats; }

std::string_view format_of(std::string_view beginning) {
  if (beginning.starts_with("\xef\xbb\xbf")) beginning.remove_prefix(3);
  const std::size_t first = beginning.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return "";
  if (beginning[first] == '{') return "geojson";
  const std::string_view line = beginning.substr(first, beginning.find('\n', first) - first);
  if (line.starts_with("WAP001") || line.starts_with("\"WAP001")) return "uji";
  if (line.find("x_m") != std::string_view::npos && line.find("rss_dbm") != std::string_view::npos) return "csv";
  if (beginning.find("\tTYPE_") != std::string_view::npos) return "ilc20";
  const auto sensor = [](std::string_view text) {
    return text.size() > 5 && text[4] == ';' && std::ranges::all_of(text.substr(0, 4), [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); });
  };
  if (line.starts_with('%') || sensor(line)) return "getsensordata";
  return "";
}

UnixTime written_at(const std::string& path) {
  struct stat facts {};
  if (::stat(path.c_str(), &facts) != 0) return {};
  return UnixTime(std::chrono::seconds(facts.st_mtime));
}

Result<SurveyFile> read_survey_file(const std::string& path, const SurveyFileSettings& given) {
  SurveyFileSettings settings = given;
  if (settings.format.empty()) {
    std::ifstream in(path, std::ios::binary);
    std::string beginning(kBeginning, '\0');
    in.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
    if (in.bad() || (!in && in.gcount() == 0)) return Fault{FaultCode::kNotFound, path, "cannot be read, or is empty"};
    beginning.resize(static_cast<std::size_t>(in.gcount()));
    settings.format = format_of(beginning);
  }
  Result<SurveyFile> file = Fault{FaultCode::kUnknownName, path, "looks like none of csv, geojson, uji, ilc20, getsensordata: say which with --format"};
  if (settings.format == "csv") file = read_points_csv(path, settings);
  if (settings.format == "geojson") file = read_points_geojson(path, settings);
  if (settings.format == "uji") file = read_uji_points(path, settings);
  if (settings.format == "ilc20" || settings.format == "getsensordata") file = read_recording(path, settings);
  if (!file) return file;
  file->format = settings.format;
  // What the server would refuse is refused before anything is uploaded.
  for (const ReferencePoint& point : file->points) {
    if (const auto good = check(point, "point"); !good) return Fault{good.fault().code, path, good.fault().field + ": " + good.fault().cause};
  }
  return file;
}

}  // namespace wayfuse::cli
