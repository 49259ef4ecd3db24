#pragma once

#include <span>
#include <string>
#include <vector>

#include "sdk/src/recording/import/fingerprint_table.hpp"

namespace wayfuse {

/// One file of levels and one of places, scan by scan in the same order.
struct LevelsFiles {
  std::string levels;
  std::string places;
  std::string part;  ///< which part of its collection it is, like the month; empty = the only one
};

/// Collections published as pairs of tables: Tampere, the library recorded over 25 months, and their like. They come as
///  - numbers parted by comma, semicolon, tab or blanks, with or without a header line;
///  - a scan a row, or, told by the number of places, a scan a column; so the places too;
///  - not heard: 100 (+100, 100.0), 0 and any positive number, nothing, `nan`, a level of -105 dBm and below that no radio
///    reports and at least every tenth entry repeats, or one of -100 and below that fills more than half of all cells; a table
///    without any number below -20 holds decibels above -100, 0 = not heard;
///  - places `x,y,z` or `x,y`, z the floor's number or a height in metres: what differs by less than a metre is one floor. A header
///    that names x and y (longitude, latitude) and the floor counts instead of their order. Further columns are passed over, as are
///    a first column that is an index and a first row that counts the columns. Access points are matched by name where all have names.
/// Degrees, and places given for levels, are refused.
/// Floors are counted from 0 upwards over all files together, so that training and test agree. One table a pair. Faults name file,
/// line and cause.
Result<std::vector<FingerprintTable>> read_levels(std::span<const LevelsFiles> files);

/// Pairs found in a folder and below it, by name: levels `*rss*`, places the same with `crd`, `coord`, `coordinates` or `xyz`
/// instead, extension csv, txt or dat, hidden files passed over; training `trn` or `train`, test `tst`, `test` or `val`. In order of their names. Of several folders that hold
/// training files only the first one's count (later months are what is tested).
struct LevelsCollection {
  std::vector<LevelsFiles> training;
  std::vector<LevelsFiles> test;
};
Result<LevelsCollection> find_levels(const std::string& folder);

}  // namespace wayfuse
