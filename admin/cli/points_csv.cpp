#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "admin/cli/survey_file.hpp"
#include "sdk/src/recording/import/text_line.hpp"
#include "wayfuse/proto/codec.hpp"

namespace wayfuse::cli {
namespace {

constexpr double kWholeMost = 9007199254740991.0;  // 2^53 - 1: exact in a double

/// Fields of one line as RFC 4180 has them; false = a quote that does not end.
bool split_quoted(std::string_view line, std::vector<std::string>& fields) {
  fields.assign(1, "");
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (quoted && line[i] == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[i++];
    } else if (line[i] == '"') {
      quoted = !quoted;
    } else if (line[i] == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  return !quoted;
}

// The apostrophe that keeps spreadsheets from running a text.
std::string unguarded(const std::string& text) {
  return text.size() > 1 && text[0] == '\'' && std::string_view("=+-@'").find(text[1]) != std::string_view::npos ? text.substr(1) : text;
}

struct Broken {
  std::string field, cause;
};

constexpr std::array<std::string_view, 5> kNeeded = {"x_m", "y_m", "floor", "bssid", "rss_dbm"};
constexpr std::array<std::string_view, 11> kKnown = {"point", "sigma_m", "device_model", "walk", "surveyed_at_us", "scan",
                                                     "scan_time_us", "age_us", "frequency_mhz", "range_m", "range_sigma_m"};

class CsvPoints {
 public:
  CsvPoints(const std::string& path, const SurveyFileSettings& settings, SurveyFile& file) : path_(path), settings_(settings), file_(file) {}

  Result<void> header(const std::vector<std::string>& names);
  void row(const std::vector<std::string>& fields, std::size_t line);
  void finish();

 private:
  struct Entry {
    ReferencePoint point;
    std::size_t line = 0;                          // of its first row
    std::map<std::string, std::size_t> scans = {}; // by the scan's name: its place in the point
    std::vector<std::size_t> scan_lines = {};
  };
  const std::string& text(std::string_view name) const;
  double number_of(std::string_view name, double least, double most, std::optional<double> standard) const;
  std::int64_t whole_of(std::string_view name, double least, double most, std::optional<std::int64_t> standard) const;
  ReferencePoint head() const;
  std::optional<ScanReading> reading() const;
  void add(ReferencePoint head, std::optional<ScanReading> reading, std::size_t line);
  void refuse_other(const Entry& entry, const ReferencePoint& head) const;

  const std::string& path_;
  const SurveyFileSettings& settings_;
  SurveyFile& file_;
  std::map<std::string, std::size_t, std::less<>> columns_;
  const std::vector<std::string>* fields_ = nullptr;
  std::vector<Entry> entries_;                     // as they come
  std::map<std::string, std::size_t> by_name_;
  UnixTime written_ = written_at(path_);
};

Result<void> CsvPoints::header(const std::vector<std::string>& names) {
  std::string passed_over;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!columns_.emplace(names[i], i).second) return Fault{FaultCode::kDuplicateField, path_ + ":1", "column " + shown(names[i]) + " stands twice"};
    const bool known = std::ranges::count(kNeeded, names[i]) + std::ranges::count(kKnown, names[i]) > 0;
    if (!known) passed_over += (passed_over.empty() ? "" : ", ") + shown(names[i]);
  }
  for (const std::string_view name : kNeeded) {
    if (!columns_.contains(name)) return Fault{FaultCode::kMissingField, path_ + ":1", "column " + std::string(name) + " is missing"};
  }
  if (!passed_over.empty()) file_.notes.push_back(path_ + ": columns passed over: " + passed_over);
  if (!columns_.contains("surveyed_at_us")) file_.notes.push_back(path_ + ": no column surveyed_at_us: surveyed when the file was written");
  return {};
}

const std::string& CsvPoints::text(std::string_view name) const {
  static const std::string kNothing;
  const auto column = columns_.find(name);
  return column == columns_.end() ? kNothing : (*fields_)[column->second];
}

double CsvPoints::number_of(std::string_view name, double least, double most, std::optional<double> standard) const {
  const std::string& field = text(name);
  if (field.empty() && standard) return *standard;
  const auto value = number(field);
  if (!value) throw Broken{std::string(name), "'" + shown(field) + "' is not a number"};
  if (*value < least || *value > most) {
    char range[64];
    std::snprintf(range, sizeof range, "%.10g..%.10g", least, most);
    throw Broken{std::string(name), shown(field) + " is outside " + range};
  }
  return *value;
}

std::int64_t CsvPoints::whole_of(std::string_view name, double least, double most, std::optional<std::int64_t> standard) const {
  const std::string& field = text(name);
  if (field.empty() && standard) return *standard;
  number_of(name, least, most, {});
  const auto value = whole_number(field);
  if (!value) throw Broken{std::string(name), "'" + shown(field) + "' is not a whole number"};
  return *value;
}

// All of a point but its scans.
ReferencePoint CsvPoints::head() const {
  ReferencePoint point;
  point.place.point = {number_of("x_m", -1e5, 1e5, {}), number_of("y_m", -1e5, 1e5, {})};
  point.place.floor = {static_cast<std::int32_t>(whole_of("floor", -200, 1000, {}))};
  point.sigma_m = number_of("sigma_m", 0, 1000, 0.0);
  point.device_model = unguarded(text("device_model"));
  if (!columns_.contains("device_model")) point.device_model = settings_.device_model;
  point.walk = unguarded(text("walk"));
  point.surveyed_at = UnixTime(Duration(whole_of("surveyed_at_us", 0, kWholeMost, written_.time_since_epoch().count())));
  return point;
}

// Absent: a scan that heard nothing.
std::optional<ScanReading> CsvPoints::reading() const {
  if (text("bssid").empty() && text("rss_dbm").empty()) return std::nullopt;
  const auto bssid = parse_bssid(text("bssid"));
  if (!bssid) throw Broken{"bssid", "'" + shown(text("bssid")) + "' is no BSSID"};
  ScanReading reading;
  reading.bssid = *bssid;
  reading.rss_dbm = number_of("rss_dbm", -120, 0, {});
  reading.age = Duration(whole_of("age_us", 0, 600e6, 0));
  reading.frequency_mhz = static_cast<std::uint16_t>(whole_of("frequency_mhz", 0, 65535, 0));
  if (!text("range_m").empty()) reading.range_m = number_of("range_m", -50, 1e4, {});
  if (!text("range_sigma_m").empty()) reading.range_sigma_m = number_of("range_sigma_m", 0, 1e4, {});
  return reading;
}

void CsvPoints::refuse_other(const Entry& entry, const ReferencePoint& head) const {
  const ReferencePoint& first = entry.point;
  const char* field = first.place.point.x_m != head.place.point.x_m   ? "x_m"
                      : first.place.point.y_m != head.place.point.y_m ? "y_m"
                      : first.place.floor != head.place.floor         ? "floor"
                      : first.sigma_m != head.sigma_m                 ? "sigma_m"
                      : first.device_model != head.device_model       ? "device_model"
                      : first.walk != head.walk                       ? "walk"
                      : first.surveyed_at != head.surveyed_at         ? "surveyed_at_us"
                                                                      : nullptr;
  if (field) throw Broken{field, "differs from row " + std::to_string(entry.line) + " of the same point"};
}

void CsvPoints::add(ReferencePoint head, std::optional<ScanReading> reading, std::size_t line) {
  std::string name = text("point");
  if (!columns_.contains("point")) {
    for (const char* part : {"x_m", "y_m", "floor", "sigma_m", "device_model", "walk", "surveyed_at_us"}) name += text(part) + '\n';
  }
  const auto known = by_name_.find(name);
  if (known != by_name_.end()) refuse_other(entries_[known->second], head);
  const std::string& scan_name = columns_.contains("scan") ? text("scan") : text("scan_time_us");
  const PhoneTime time(Duration(whole_of("scan_time_us", -kWholeMost, kWholeMost, head.surveyed_at.time_since_epoch().count())));
  Entry* entry = known == by_name_.end() ? nullptr : &entries_[known->second];
  const bool scan_known = entry && entry->scans.contains(scan_name);
  if (scan_known && entry->point.scans[entry->scans.at(scan_name)].time != time) {
    throw Broken{"scan_time_us", "differs from row " + std::to_string(entry->scan_lines[entry->scans.at(scan_name)]) + " of the same scan"};
  }
  if (!entry) {
    by_name_.emplace(name, entries_.size());
    entry = &entries_.emplace_back(Entry{std::move(head), line});
  }
  if (!scan_known) {
    entry->scans.emplace(scan_name, entry->point.scans.size());
    entry->point.scans.push_back({time, {}});
    entry->scan_lines.push_back(line);
  }
  if (reading) entry->point.scans[entry->scans.at(scan_name)].readings.push_back(*reading);
}

void CsvPoints::row(const std::vector<std::string>& fields, std::size_t line) {
  ++file_.rows;
  try {
    if (fields.size() != columns_.size()) {
      throw Broken{"", std::to_string(columns_.size()) + " fields expected, " + std::to_string(fields.size()) + " found"};
    }
    fields_ = &fields;
    auto point = head();
    auto heard = reading();
    add(std::move(point), heard, line);
  } catch (const Broken& broken) {
    file_.bad.push_back({path_, line, broken.field, broken.cause});
  }
}

// What only the whole point shows: an access point that speaks twice in a scan, too many scans, a text that is not UTF-8.
void CsvPoints::finish() {
  for (Entry& entry : entries_) {
    if (const auto good = check(entry.point, ""); !good) {
      file_.bad.push_back({path_, entry.line, good.fault().field, good.fault().cause});
    } else {
      file_.points.push_back(std::move(entry.point));
    }
  }
  std::ranges::stable_sort(file_.bad, {}, &RowFault::row);
}

}  // namespace

Result<SurveyFile> read_points_csv(const std::string& path, const SurveyFileSettings& settings) {
  auto text = TextFile::read(path);
  if (!text) return text.fault();
  SurveyFile file;
  CsvPoints points(path, settings, file);
  std::vector<std::string> fields;
  const auto header = text->next_line();
  if (!header || !split_quoted(*header, fields)) return text->fault("a header line of column names expected");
  if (const auto good = points.header(fields); !good) return good.fault();
  while (const auto line = text->next_line()) {
    if (line->empty()) continue;
    const auto number = static_cast<std::size_t>(text->line_number());
    if (split_quoted(*line, fields)) {
      points.row(fields, number);
    } else {
      ++file.rows;
      file.bad.push_back({path, number, "", "a quote does not end"});
    }
  }
  points.finish();
  return file;
}

}  // namespace wayfuse::cli
