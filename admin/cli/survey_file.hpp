#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/fingerprint.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"

namespace wayfuse::cli {

/// A row of a survey file that does not serve.
struct RowFault {
  std::string file;
  std::size_t row = 0;             ///< line of the file, from 1
  std::string field;               ///< column or member; empty = the row as a whole
  std::string cause;
};
/// `file:row: field: cause`
std::string to_string(const RowFault& fault);

/// What a file does not tell by itself.
struct SurveyFileSettings {
  std::string format = {};                          ///< one of survey_formats(); empty = told by the content
  std::optional<FloorOrdinal> floor = {};           ///< of walks, instead of what their file says
  std::optional<Georeference> georeference = {};    ///< the building's, for places in degrees or Web Mercator
  std::optional<int> source_building = {};          ///< UJI: rows with this BUILDINGID only
  std::string device_model = {};                    ///< where the file names none
};

/// Reference points as somebody's file has them.
struct SurveyFile {
  std::string format;
  std::size_t rows = 0;
  std::vector<ReferencePoint> points;
  std::vector<RowFault> bad;                        ///< rows left out, ascending
  std::vector<std::string> notes;                   ///< what was assumed or has no place
};

/// `csv`, `geojson`, `uji`, `ilc20`, `getsensordata`.
std::span<const std::string_view> survey_formats();

/// Which of them a file's beginning looks like; empty = none.
std::string_view format_of(std::string_view beginning);

/// Reads a survey file. Rows that do not serve are left out and named; a fault is what makes the whole of no use: a file that is not
/// there, is of no known format, lacks a column, or needs what the settings do not say.
///
/// Walks (`ilc20`, `getsensordata`) are placed between their marks as the SDK's Surveyor does it; the lines of a recording that do not
/// parse are bad rows, and more than one in twenty of them a fault.
Result<SurveyFile> read_survey_file(const std::string& path, const SurveyFileSettings& settings);

/// The product's own export (admin/README.md): a row a reading, columns found by their names.
Result<SurveyFile> read_points_csv(const std::string& path, const SurveyFileSettings& settings);
/// A FeatureCollection of points with their scans.
Result<SurveyFile> read_points_geojson(const std::string& path, const SurveyFileSettings& settings);

/// When a file was last written: what is taken for the time of surveys that tell none.
UnixTime written_at(const std::string& path);

}  // namespace wayfuse::cli
