#include "tests/evaluation/walks/selection.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>

#include "sdk/src/recording/import/text_line.hpp"
#include "tests/evaluation/datasets/split.hpp"

namespace wayfuse {
namespace {

constexpr double kJoinDistance_m = 1.0;
constexpr Duration kJoinGap = std::chrono::seconds(15);

constexpr std::size_t kNamed = 3;     // unreadable walks in a fault
constexpr std::size_t kPrinted = 20;  // lines of a kind

using Chains = std::vector<std::vector<std::size_t>>;  // indices of walks, in order

bool continues(const RecordedWalk& first, const RecordedWalk& second) {
  const Duration gap = second.way_points.front().time - first.way_points.back().time;
  return first.floor == second.floor && first.device_model == second.device_model && gap >= Duration(0) && gap <= kJoinGap &&
         distance_m(first.way_points.back().point, second.way_points.front().point) <= kJoinDistance_m;
}

Chains chains_of(const std::vector<RecordedWalk>& walks, const std::vector<std::size_t>& usable) {
  std::vector<std::size_t> by_start = usable;
  std::sort(by_start.begin(), by_start.end(),
            [&](std::size_t a, std::size_t b) { return walks[a].way_points.front().time < walks[b].way_points.front().time; });
  Chains chains;
  for (const std::size_t i : by_start) {
    const auto end =
        std::find_if(chains.begin(), chains.end(), [&](const auto& chain) { return continues(walks[chain.back()], walks[i]); });
    if (end == chains.end())
      chains.push_back({i});
    else
      end->push_back(i);
  }
  std::erase_if(chains, [](const auto& chain) { return chain.size() < 2; });
  return chains;
}

ScoredWalk join(const std::vector<RecordedWalk>& walks, const std::vector<std::size_t>& parts) {
  ScoredWalk joined{walks[parts.front()], {walks[parts.front()].id}};
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const RecordedWalk& next = walks[parts[i]];
    joined.parts.push_back(next.id);
    append(joined.walk.motion, next.motion);
    append(joined.walk.attitudes, next.attitudes);
    append(joined.walk.scans, next.scans);
    append(joined.walk.way_points, next.way_points);
  }
  const auto by_time = [](const auto& a, const auto& b) { return a.time < b.time; };
  std::stable_sort(joined.walk.motion.begin(), joined.walk.motion.end(), by_time);
  std::stable_sort(joined.walk.scans.begin(), joined.walk.scans.end(), by_time);
  return joined;
}

// Indices of the groups of walks to score; a group is a chain or a single walk.
Chains scored_groups(const std::vector<RecordedWalk>& walks, const SelectionOptions& options) {
  const std::set<std::string> only(options.only.begin(), options.only.end());
  const bool inside_survey = options.development || options.folds > 0;
  const auto wanted = [&](std::size_t i) {
    if (!only.empty()) return only.count(walks[i].id) > 0;
    if (options.folds > 0) return split_of(walks[i].id) != Split::kTest;
    return split_of(walks[i].id) == (options.development ? Split::kDevelopment : Split::kTest);
  };
  std::vector<std::size_t> usable;
  for (std::size_t i = 0; i < walks.size(); ++i) {
    if (!inside_survey || split_of(walks[i].id) != Split::kTest || only.count(walks[i].id) > 0) usable.push_back(i);
  }
  Chains groups;
  if (options.chain)
    groups = chains_of(walks, usable);
  else
    for (const std::size_t i : usable) groups.push_back({i});
  std::erase_if(groups, [&](const auto& group) { return std::none_of(group.begin(), group.end(), wanted); });
  if (options.folds > 0) {
    std::erase_if(groups, [&](const auto& group) { return fold_of(walks[group.front()].id, options.folds) != options.fold; });
  }
  return groups;
}

using Unreadable = std::map<std::string, std::string>;  // ids and why

std::string why_nothing(const SelectionOptions& options, std::size_t readable, const Unreadable& unreadable) {
  std::string why = "none to score: ";
  if (readable == 0)
    why += "no walk can be read";
  else if (options.chain)
    why += "no walk continues another one, or no chain holds a walk of the split";
  else
    why += "the split or the list selects nothing here";
  if (unreadable.empty()) return why;
  why += "; " + std::to_string(unreadable.size()) + " of " + std::to_string(readable + unreadable.size()) + " walk files cannot be read:";
  std::size_t named = 0;
  for (const auto& [_, cause] : unreadable) {
    if (named++ == kNamed) return why + "; and others";
    why += (named == 1 ? " " : "; ") + cause;
  }
  return why;
}

}  // namespace

Result<Selection> select_walks(const RecordedSite& site, const SelectionOptions& options) {
  Selection selection;
  std::vector<RecordedWalk> walks;
  Unreadable unreadable;
  for (const WalkFile& file : site.walks) {
    auto walk = read_walk(file.path, file.floor_origin);
    if (!walk) {
      selection.complaints.push_back(to_string(walk.fault()));
      unreadable[file.id] = selection.complaints.back();
      continue;
    }
    walk->floor = file.floor;
    if (const Floor* floor = site.floor(file.floor)) walk->floor_label = floor->label;  // of the folder: a file may say another
    selection.notes.insert(selection.notes.end(), walk->notes.begin(), walk->notes.end());
    selection.complaints.insert(selection.complaints.end(), walk->complaints.begin(), walk->complaints.end());
    walks.push_back(std::move(*walk));
  }
  for (const std::string& id : options.only) {
    if (unreadable.contains(id)) return Fault{FaultCode::kNotFound, "only", id + " cannot be read: " + unreadable[id]};
    if (std::none_of(walks.begin(), walks.end(), [&](const RecordedWalk& walk) { return walk.id == id; })) {
      return Fault{FaultCode::kNotFound, "only", id + " is no walk of this site"};
    }
  }
  const Chains groups = scored_groups(walks, options);
  if (groups.empty()) selection.nothing = why_nothing(options, walks.size(), unreadable);
  if (groups.empty() && !options.may_be_empty) return Fault{FaultCode::kNotFound, "walks", selection.nothing};
  std::set<std::size_t> taken;
  for (const auto& group : groups) {
    selection.scored.push_back(join(walks, group));
    taken.insert(group.begin(), group.end());
  }
  std::sort(selection.scored.begin(), selection.scored.end(),
            [](const ScoredWalk& a, const ScoredWalk& b) { return a.walk.id < b.walk.id; });
  for (std::size_t i = 0; i < walks.size(); ++i) {
    const Split split = split_of(walks[i].id);
    const bool surveys = split == Split::kSurvey || (split == Split::kDevelopment && !options.development);
    if (!surveys || taken.count(i) > 0) continue;
    if (walks[i].duration_s() > 0.0)
      selection.survey.push_back(std::move(walks[i]));
    else
      selection.complaints.push_back(walks[i].id + ": a survey walk needs two way points");
  }
  return selection;
}

Result<std::vector<std::string>> read_ids(const std::string& path) {
  auto file = TextFile::read(path);
  if (!file) return file.fault();
  std::vector<std::string> ids;
  std::vector<std::string_view> fields;
  while (const auto line = file->next_line()) {
    split(*line, ' ', fields);
    if (fields.empty() || fields[0].starts_with('#')) continue;
    if (fields.size() > 1) return file->fault("one id a line expected");
    std::string_view id = fields[0];
    if (id.ends_with(".txt")) id.remove_suffix(4);
    ids.emplace_back(id);
  }
  if (ids.empty()) return file->fault("holds no id");
  return ids;
}

void print_some(const char* label, const std::vector<std::string>& lines) {
  for (std::size_t i = 0; i < std::min(lines.size(), kPrinted); ++i) std::fprintf(stderr, "%s: %s\n", label, lines[i].c_str());
  if (lines.size() > kPrinted) std::fprintf(stderr, "%s: and %zu more\n", label, lines.size() - kPrinted);
}

}  // namespace wayfuse
