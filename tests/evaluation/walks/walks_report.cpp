#include "tests/evaluation/walks/walks_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <stdexcept>

#include "tests/evaluation/svg_chart.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;

void write_file(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

std::string shown(double value, int decimals = 2) {
  if (std::isnan(value)) return "–";
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}
std::string shown(const Interval& interval) {
  return "[" + shown(interval.low) + ", " + shown(interval.high) + "]";
}

std::string rows_table(const std::vector<ScoreRow>& rows, bool by_floor) {
  std::string md = by_floor ? "| pipeline | floor " : "| pipeline ";
  md +=
      "| scope | n | mean m (95 %) | RMSE | median | p75 | p90 | p95 | floor hit % | first fix s | in 68 % | in 95 % | radius "
      "rank |\n|";
  for (int i = 0; i < (by_floor ? 15 : 14); ++i) md += i < (by_floor ? 3 : 2) ? " --- |" : " ---: |";
  md += "\n";
  for (const ScoreRow& row : rows) {
    md += "| " + row.pipeline + (by_floor ? " | " + row.floor : "") + " | " + std::string(name_of(row.scope)) + " | " +
          std::to_string(row.error.n) + " | " + shown(row.error.mean) + " " + shown(row.mean_interval) + " | " +
          shown(row.error.rmse) + " | " + shown(row.error.median) + " | " + shown(row.error.p75) + " | " +
          shown(row.error.p90) + " | " + shown(row.error.p95) + " | " + shown(100 * row.floor_hit, 1) + " | " +
          shown(row.ttff_s, 1) + " | " + shown(100 * row.in68, 1) + " | " + shown(100 * row.in95, 1) + " | " +
          (row.radius_rank_corr ? shown(*row.radius_rank_corr) : "–") + " |\n";
  }
  return md;
}

std::string time_table(const WalksOutcome& outcome, Scope scope) {
  std::string md =
      "| pipeline | 0–10 s | 10–30 s | 30–60 s | 60–120 s | > 120 s |\n| --- | ---: | ---: | ---: | ---: | ---: |\n";
  for (const auto& [pipeline, row_scope, bins] : outcome.by_time) {
    if (row_scope != scope) continue;
    md += "| " + pipeline + " |";
    for (const TimeBin& bin : bins) md += bin.n == 0 ? " – |" : " " + shown(bin.mean_m) + " (" + std::to_string(bin.n) + ") |";
    md += "\n";
  }
  return md;
}

std::string scan_rates_table(const WalksOutcome& outcome) {
  std::string md = "| one scan in s | pipeline | scope | n | mean m (95 %) | median | p95 | in 68 % | in 95 % |\n"
                   "| ---: | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  const auto add = [&](const std::string& every, const std::vector<ScoreRow>& rows) {
    for (const ScoreRow& row : rows) {
      md += "| " + every + " | " + row.pipeline + " | " + std::string(name_of(row.scope)) + " | " + std::to_string(row.error.n) + " | " +
            shown(row.error.mean) + " " + shown(row.mean_interval) + " | " + shown(row.error.median) + " | " + shown(row.error.p95) + " | " +
            shown(100 * row.in68, 1) + " | " + shown(100 * row.in95, 1) + " |\n";
    }
  };
  add("as they came", outcome.rows);
  for (const auto& [every_s, rows] : outcome.scan_rates) add(shown(every_s, 0), rows);
  return md;
}

std::string scan_rates_picture(const WalksOutcome& outcome) {
  std::vector<LineSeries> series;
  const auto add = [&](double every_s, const std::vector<ScoreRow>& rows) {
    for (const ScoreRow& row : rows) {
      if (row.scope != Scope::kCovered || row.error.n == 0) continue;
      auto line = std::ranges::find(series, row.pipeline, &LineSeries::name);
      if (line == series.end()) line = series.insert(series.end(), {row.pipeline, {}});
      line->points.push_back({every_s, row.error.mean, row.mean_interval.low, row.mean_interval.high});
    }
  };
  add(0.0, outcome.rows);
  for (const auto& [every_s, rows] : outcome.scan_rates) add(every_s, rows);
  return line_chart({"Error within 3 m of the survey, scans heard less often", "seconds from scan to scan (0: as they came)", "mean horizontal error, m"}, series);
}

std::string pairs_table(const WalksOutcome& outcome) {
  std::string md =
      "| compared | against | scope | difference of the means m (95 %) | walks better |\n| --- | --- | --- | ---: | ---: |\n";
  for (const auto& pair : outcome.pairs) {
    md += "| " + pair.pipeline + " | " + pair.against + " | " + std::string(name_of(pair.scope)) + " | " +
          shown(pair.mean.difference) + " " + shown(pair.mean.interval) + " | " + shown(100 * pair.mean.share_better, 0) +
          " % |\n";
  }
  return md;
}

// One line a walk: its mean error under every pipeline, for paired looks outside.
std::string walks_csv(const ScoredData& data, const std::vector<PipelineRun>& runs) {
  std::string csv = "walk,floor,seconds,instants,covered";
  for (const PipelineRun& run : runs) csv += "," + run.pipeline + "_all_m," + run.pipeline + "_cov_m";
  csv += "\n";
  std::vector<std::vector<GroupSum>> sums;
  for (const PipelineRun& run : runs) {
    sums.push_back(error_sums(data, run, Scope::kAll));
    sums.push_back(error_sums(data, run, Scope::kCovered));
  }
  for (std::size_t w = 0; w < data.walks.size(); ++w) {
    const auto& instants = data.instants[w];
    const auto covered = std::count_if(instants.begin(), instants.end(), [](const Instant& i) { return i.covered; });
    csv += data.walks[w].walk.id + "," + data.walks[w].walk.floor_label + "," + shown(data.walks[w].walk.duration_s(), 1) +
           "," + std::to_string(instants.size()) + "," + std::to_string(covered);
    for (const auto& column : sums) {
      csv += ",";
      if (column[w].count > 0) csv += shown(column[w].sum / static_cast<double>(column[w].count), 3);
    }
    csv += "\n";
  }
  return csv;
}

std::string cdf_picture(const ScoredData& data, const std::vector<PipelineRun>& runs, Scope scope) {
  std::vector<ValueSeries> series;
  for (const PipelineRun& run : runs) series.push_back({run.pipeline, errors_in(data, run, scope)});
  const std::string where = scope == Scope::kAll ? "all instants" : "within 3 m of the survey";
  return distribution_chart({"Error of the position, " + where, "horizontal error, m", "share of the instants below"}, series,
                            20.0);
}

std::string coverage_picture(const ScoredData& data, const Floor& floor, const SurveyCover& cover) {
  PlanPicture picture;
  picture.title = "Floor " + floor.label + ": what the survey walked, and the walks scored";
  picture.floor = &floor;
  bool first = true;
  for (const auto& [a, b] : cover.paths(floor.ordinal)) {
    picture.tracks.push_back(
        {first ? "survey, 3 m each side" : "", "#56b4e9", {a, b}, 2 * SurveyCover::kCovered_m, 0.18, false});
    first = false;
  }
  for (const auto& [a, b] : cover.paths(floor.ordinal)) picture.tracks.push_back({"", "#0072b2", {a, b}, 0.25, 0.8, false});
  first = true;
  for (const ScoredWalk& walk : data.walks) {
    if (walk.walk.floor != floor.ordinal) continue;
    PlanTrack track{first ? "walks scored" : "", "#d55e00", {}, 0.35, 0.9, false};
    for (const TruePoint& point : walk.walk.way_points) track.points.push_back(point.point);
    picture.tracks.push_back(std::move(track));
    first = false;
  }
  return plan_picture(picture);
}

std::string walk_picture(const ScoredData& data, const std::vector<PipelineRun>& runs, std::size_t w,
                         const RecordedSite& site) {
  const RecordedWalk& walk = data.walks[w].walk;
  PlanPicture picture;
  const Floor* floor = site.floor(walk.floor);
  picture.title = "Walk " + walk.id + (floor ? ", floor " + floor->label : "");
  picture.floor = floor;
  picture.zoom_to_tracks = true;
  PlanTrack truth{"truth", "#222222", {}, 0.25, 1.0, true};
  for (const TruePoint& point : walk.way_points) truth.points.push_back(point.point);
  picture.tracks.push_back(std::move(truth));
  for (std::size_t r = 0; r < runs.size(); ++r) {
    // All of them hide each other: the last, what it is compared with, and Wi-Fi alone.
    if (runs.size() > 3 && r + 1 != runs.size() && runs[r].pipeline != "p1" && runs[r].pipeline != "wknn") continue;
    PlanTrack track{runs[r].pipeline, std::string(series_colour(r)), {}, 0.2, 0.9, true};
    for (const auto& answer : runs[r].walks[w]) {
      if (answer) track.points.push_back(answer->place.point);
    }
    picture.tracks.push_back(std::move(track));
  }
  return plan_picture(picture);
}

// The walks whose error under the last pipeline lies at these places of the order: typical, and the worst.
std::vector<std::pair<std::string, std::size_t>> telling_walks(const ScoredData& data, const PipelineRun& run) {
  const std::vector<GroupSum> sums = error_sums(data, run, Scope::kAll);
  std::vector<std::size_t> order;
  for (std::size_t w = 0; w < sums.size(); ++w) {
    if (sums[w].count > 0) order.push_back(w);
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return sums[a].sum * static_cast<double>(sums[b].count) < sums[b].sum * static_cast<double>(sums[a].count);
  });
  std::vector<std::pair<std::string, std::size_t>> chosen;
  if (order.empty()) return chosen;
  const auto at = [&](double share) { return order[static_cast<std::size_t>(share * static_cast<double>(order.size() - 1))]; };
  for (const auto& [name, share] :
       {std::pair{"good (p25)", 0.25}, {"typical (median)", 0.5}, {"bad (p90)", 0.9}, {"worst", 1.0}}) {
    chosen.emplace_back(name, at(share));
  }
  return chosen;
}

}  // namespace

void write_walks_report(const std::string& folder, const WalksOutcome& outcome, const ScoredData& data,
                        const std::vector<PipelineRun>& runs, const RecordedSite& site, const SurveyCover* cover) {
  const fs::path root = folder;
  fs::create_directories(root);
  std::string md = "# Walks of " + site.name + "\n\n" + std::to_string(data.walks.size()) +
                   (outcome.chain ? " chains of walks" : " walks") + " scored (split: " + outcome.split + "), " +
                   std::to_string(outcome.survey_walks) + " survey walks made " + std::to_string(outcome.survey_points) +
                   " reference points. Seed " + std::to_string(outcome.seed) + ".";
  if (outcome.rss_offset_db != 0.0)
    md += " Every level heard on the scored walks was changed by " + shown(outcome.rss_offset_db, 1) + " dB.";
  md +=
      "\n\nErrors in metres at every scan arrival and way point; COV = the truth lies within 3 m of a survey path; floor "
      "unknown to all;"
      " intervals: bootstrap over walks. `dead-reckoning` is told the true start and goes straight into the pipeline.\n\n";
  md += rows_table(outcome.rows, false);
  write_file(root / "cdf_all.svg", cdf_picture(data, runs, Scope::kAll));
  write_file(root / "cdf_cov.svg", cdf_picture(data, runs, Scope::kCovered));
  md += "\n![Error, all instants](cdf_all.svg)\n\n![Error on covered ground](cdf_cov.svg)\n";
  if (!outcome.pairs.empty()) md += "\n## Walk by walk\n\nNegative: better.\n\n" + pairs_table(outcome);
  md += "\n## By time since the start, COV\n\nMean error in metres (instants).\n\n" + time_table(outcome, Scope::kCovered);
  if (!outcome.scan_rates.empty()) {
    write_file(root / "scan_rates.svg", scan_rates_picture(outcome));
    md += "\n## Scans heard less often\n\nMean errors with their 95 % intervals.\n\n![Error by the time between scans](scan_rates.svg)\n\n" + scan_rates_table(outcome);
  }
  md += "\n## By floor\n\n" + rows_table(outcome.floor_rows, true);
  md += "\n## Alarms and attacks\n\n" + attacks_table(outcome);
  md += "\n## Tracks\n";
  for (const auto& [name, w] : telling_walks(data, runs.back())) {
    const std::string file = "walk_" + data.walks[w].walk.id + ".svg";
    write_file(root / file, walk_picture(data, runs, w, site));
    md += "\n" + name + " under " + runs.back().pipeline + ":\n\n![" + data.walks[w].walk.id + "](" + file + ")\n";
  }
  if (cover) md += "\n## Coverage\n";
  for (const Floor& floor : site.floors) {
    if (!cover) break;
    const std::string file = "coverage_" + floor.label + ".svg";
    write_file(root / file, coverage_picture(data, floor, *cover));
    md += "\n![Floor " + floor.label + "](" + file + ")\n";
  }
  write_file(root / "report.md", md);
  write_file(root / "walks.csv", walks_csv(data, runs));
}

}  // namespace wayfuse
