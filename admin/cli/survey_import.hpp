#pragma once

#include <functional>
#include <string>
#include <vector>

#include "admin/cli/api_client.hpp"
#include "admin/cli/survey_file.hpp"

namespace wayfuse::cli {

struct ImportOrder {
  std::string building;
  std::vector<std::string> files;
  SurveyFileSettings settings;
  bool skip_bad = false;            ///< upload the good rows; otherwise one bad row keeps everything back
  bool dry_run = false;             ///< read and check only
};

struct ImportReport {
  std::vector<SurveyFile> files;    ///< as read; their points are in the batches
  std::size_t points = 0;
  std::size_t batches = 0;
  std::size_t uploaded = 0;
  std::size_t already_there = 0;    ///< batches that an earlier run brought
  std::vector<std::string> complaints;  ///< why it ended early; empty = everything is stored
};

/// One exchange with the server that the import goes to.
using Ask = std::function<Result<Reply>(const std::string& method, const std::string& path, const std::string& body)>;
/// Batches stored, and how many there are.
using Progress = std::function<void(std::size_t done, std::size_t all)>;

/// Brings survey files into a building. Nothing is uploaded before every file is read.
///
/// A batch's idempotency key is the hash of its content, and what the server has is asked first: the same files again, or again after a
/// break, upload only what is missing.
ImportReport import_survey(const ImportOrder& order, const Ask& ask, const Progress& progress);

/// As one JSON object, every bad row in it.
std::string to_json(const ImportOrder& order, const ImportReport& report);

}  // namespace wayfuse::cli
