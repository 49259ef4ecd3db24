#pragma once

#include <string>
#include <vector>

#include "tests/evaluation/datasets/recorded_site.hpp"

namespace wayfuse {

/// Which walks make the radio map and which are scored.
struct SelectionOptions {
  bool development = false;       ///< score the development split, survey with the rest of the survey split
  bool chain = false;             ///< score walks that continue each other as one long walk
  std::vector<std::string> only;  ///< ids to score; empty = the whole split
  int folds = 0;                  ///< above 0: cross-validation over the survey; a chain belongs to the fold of its first walk
  int fold = 0;                   ///< the one to score: the others survey, and test walks do neither
  bool may_be_empty = false;      ///< nothing to score is an answer, not a fault: one fold of many
};

struct ScoredWalk {
  RecordedWalk walk;               ///< of a chain: all its parts, one after the other
  std::vector<std::string> parts;  ///< ids
};

struct Selection {
  std::vector<ScoredWalk> scored;  ///< ascending by id
  std::vector<RecordedWalk> survey;
  std::vector<std::string> complaints;  ///< what is left out: walks, and lines of walks
  std::vector<std::string> notes;       ///< what of them is taken otherwise than it is written
  std::string nothing;                  ///< why nothing is scored; empty = something is
};

/// Reads every walk of the site and divides them. A walk that is scored, or part of one that is, never surveys.
///
/// Walks chain where one begins on the same floor within 1 m and 15 s of where another ended. Chains that hold a walk of the
/// split are scored; development chains never run through test walks. A fault that nothing is left to score says which walks cannot
/// be read, and why.
Result<Selection> select_walks(const RecordedSite& site, const SelectionOptions& options);

/// One id a line, with or without `.txt`; blank lines and `#` comments are passed over.
Result<std::vector<std::string>> read_ids(const std::string& file);

/// Prints them on stderr as `label: line`; of many the first 20, and how many more there are.
void print_some(const char* label, const std::vector<std::string>& lines);

}  // namespace wayfuse
