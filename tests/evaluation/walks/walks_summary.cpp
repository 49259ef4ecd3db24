#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "tests/evaluation/walks/walks_report.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

// A figure rounded to what it means; null where there is none.
Json figure(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e4) / 1e4;
}

Json interval(const Interval& interval) {
  return Json::array({figure(interval.low), figure(interval.high)});
}

Json row_json(const ScoreRow& row) {
  Json json;
  json["pipeline"] = row.pipeline;
  json["scope"] = name_of(row.scope);
  if (!row.floor.empty()) json["floor"] = row.floor;
  json["n"] = row.error.n;
  json["mean_m"] = figure(row.error.mean);
  json["rmse_m"] = figure(row.error.rmse);
  json["median_m"] = figure(row.error.median);
  json["p75_m"] = figure(row.error.p75);
  json["p90_m"] = figure(row.error.p90);
  json["p95_m"] = figure(row.error.p95);
  json["floor_hit"] = figure(row.floor_hit);
  json["ttff_s"] = figure(row.ttff_s);
  json["in68"] = figure(row.in68);
  json["in95"] = figure(row.in95);
  json["radius_rank_corr"] = row.radius_rank_corr ? figure(*row.radius_rank_corr) : Json(nullptr);
  json["walks"] = row.walks;
  json["unanswered"] = row.asked - row.error.n;
  json["mean_m_interval"] = interval(row.mean_interval);
  json["median_m_interval"] = interval(row.median_interval);
  json["floor_hit_interval"] = interval(row.floor_hit_interval);
  json["in68_interval"] = interval(row.in68_interval);
  json["in95_interval"] = interval(row.in95_interval);
  json["path"] = row.path;
  return json;
}

constexpr Scope kScopes[] = {Scope::kAll, Scope::kCovered};

std::string row_line(const ScoreRow& row) {
  char line[256];
  std::snprintf(line, sizeof line,
                "%-18s %-5s %6zu  %6.2f [%5.2f, %5.2f] %6.2f %6.2f %6.2f %6.2f %6.2f  %5.1f%% %5.1fs %5.1f%% %5.1f%% %6.2f\n",
                row.pipeline.c_str(), std::string(name_of(row.scope)).c_str(), row.error.n, row.error.mean,
                row.mean_interval.low, row.mean_interval.high, row.error.rmse, row.error.median, row.error.p75, row.error.p90,
                row.error.p95, 100 * row.floor_hit, row.ttff_s, 100 * row.in68, 100 * row.in95,
                row.radius_rank_corr.value_or(std::nan("")));
  return line;
}

}  // namespace

std::vector<ScoreRow> score_rows(const ScoredData& data, const std::vector<PipelineRun>& runs, std::uint64_t seed) {
  std::vector<ScoreRow> rows;
  for (const PipelineRun& run : runs) {
    for (const Scope scope : kScopes) rows.push_back(score(data, run, scope, nullptr, seed));
  }
  return rows;
}

WalksOutcome summarise_walks(const ScoredData& data, const std::vector<PipelineRun>& runs, const RecordedSite& site,
                             std::uint64_t seed) {
  WalksOutcome outcome;
  outcome.seed = seed;
  outcome.rows = score_rows(data, runs, seed);
  for (const PipelineRun& run : runs) {
    for (const Scope scope : kScopes) {
      outcome.by_time.push_back({run.pipeline, scope, score_by_time(data, run, scope, seed)});
      for (const Floor& floor : site.floors) {
        ScoreRow row = score(data, run, scope, &floor, seed);
        if (row.walks > 0) outcome.floor_rows.push_back(std::move(row));
      }
    }
  }
  for (std::size_t i = 0; i + 1 < runs.size(); ++i) {  // each against the last: the pipeline the run is about
    for (const Scope scope : kScopes) {
      const auto against = error_sums(data, runs[i], scope);
      outcome.pairs.push_back({runs.back().pipeline, runs[i].pipeline, scope,
                               paired_difference(against, error_sums(data, runs.back(), scope), Random(seed))});
    }
  }
  return outcome;
}

std::string walks_json(const WalksOutcome& outcome) {
  Json json;
  json["data"] = outcome.data;
  json["split"] = outcome.split;
  json["chain"] = outcome.chain;
  json["rss_offset_db"] = outcome.rss_offset_db;
  json["seed"] = outcome.seed;
  json["survey_walks"] = outcome.survey_walks;
  json["survey_points"] = outcome.survey_points;
  json["rows"] = Json::array();
  for (const ScoreRow& row : outcome.rows) json["rows"].push_back(row_json(row));
  for (const auto& [every_s, rows] : outcome.scan_rates) {
    for (const ScoreRow& row : rows) {
      Json entry = row_json(row);
      entry["scan_every_s"] = every_s;
      json["scan_rates"].push_back(std::move(entry));
    }
  }
  json["by_floor"] = Json::array();
  for (const ScoreRow& row : outcome.floor_rows) json["by_floor"].push_back(row_json(row));
  json["by_time"] = Json::array();
  for (const auto& [pipeline, scope, bins] : outcome.by_time) {
    for (const TimeBin& bin : bins) {
      Json entry;
      entry["pipeline"] = pipeline;
      entry["scope"] = name_of(scope);
      entry["from_s"] = bin.from_s;
      entry["to_s"] = bin.to_s < 1e8 ? Json(bin.to_s) : Json(nullptr);
      entry["n"] = bin.n;
      entry["mean_m"] = figure(bin.mean_m);
      entry["mean_m_interval"] = interval(bin.interval);
      json["by_time"].push_back(std::move(entry));
    }
  }
  json["paired"] = Json::array();
  for (const auto& pair : outcome.pairs) {
    Json entry;
    entry["pipeline"] = pair.pipeline;
    entry["against"] = pair.against;
    entry["scope"] = name_of(pair.scope);
    entry["mean_difference_m"] = figure(pair.mean.difference);
    entry["interval"] = interval(pair.mean.interval);
    entry["share_of_walks_better"] = figure(pair.mean.share_better);
    json["paired"].push_back(std::move(entry));
  }
  json.update(Json::parse(attacks_json(outcome)));
  return json.dump(1) + "\n";
}

std::string walks_table(const WalksOutcome& outcome) {
  std::string table;
  char line[256];
  std::snprintf(line, sizeof line, "%-18s %-5s %6s  %6s %-14s %6s %6s %6s %6s %6s  %6s %6s %6s %6s %6s\n", "pipeline", "scope",
                "n", "mean", "[95 %]", "rmse", "median", "p75", "p90", "p95", "floor", "ttff", "in68", "in95", "rank");
  table += line;
  for (const ScoreRow& row : outcome.rows) table += row_line(row);
  for (const auto& [every_s, rows] : outcome.scan_rates) {
    std::snprintf(line, sizeof line, "one scan in %g s\n", every_s);
    table += line;
    for (const ScoreRow& row : rows) table += row_line(row);
  }
  return table + "\n" + attacks_table(outcome);
}

}  // namespace wayfuse
