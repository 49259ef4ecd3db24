#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "tests/evaluation/walks/walks_report.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

Json figure(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e4) / 1e4;
}

template <typename... Values>
std::string line(const char* format, Values... values) {
  char text[320];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

std::string slower(double scan_every_s) { return scan_every_s > 0.0 ? line(", one scan in %g s", scan_every_s) : ""; }

std::string name_of(const AttackRow& row) {
  return row.attack + " " + row.kind + (row.fakes > 0 ? " " + std::to_string(row.fakes) : "") + slower(row.scan_every_s);
}

// How carried-off phones are found back, beside those that are merely switched on where they arrive.
std::string carried_table(const WalksOutcome& outcome) {
  std::string table;
  for (const AttackRow& row : outcome.attacks) {
    if (row.attack != "kidnap") continue;
    if (table.empty()) {
      table = "\n| after 15 s | attack | scope | walks | p95 | < 10 m % | switched on there p95 | < 10 m % |\n"
              "| --- | --- | --- | ---: | ---: | ---: | ---: | ---: |\n";
    }
    for (const Scope scope : {Scope::kAll, Scope::kCovered}) {
      const FoundBack &carried = row.carried[static_cast<std::size_t>(scope)], &fresh = row.switched_on[static_cast<std::size_t>(scope)];
      table += line("| %s | %s | %s | %zu | %.2f | %.1f | %.2f | %.1f |\n", row.pipeline.c_str(), name_of(row).c_str(), std::string(name_of(scope)).c_str(),
                    carried.walks, carried.p95_m, 100 * carried.within10, fresh.p95_m, 100 * fresh.within10);
    }
  }
  return table;
}

double per_hour(const AlarmRow& row) { return row.hours > 0.0 ? static_cast<double>(row.alarms) / row.hours : 0.0; }

}  // namespace

std::string attacks_json(const WalksOutcome& outcome) {
  Json json = Json::object();
  for (const AlarmRow& row : outcome.alarms) {
    json["alarms"].push_back({{"pipeline", row.pipeline}, {"scan_every_s", row.scan_every_s}, {"hours_walked", figure(row.hours)}, {"false_alarms", row.alarms},
                              {"false_alarms_per_hour", figure(per_hour(row))}, {"suspect_share", figure(row.suspect)},
                              {"degraded_share", figure(row.degraded)}});
  }
  for (const AttackRow& row : outcome.attacks) {
    Json entry = {{"pipeline", row.pipeline}, {"attack", row.attack}, {"kind", row.kind}, {"walks", row.walks}, {"n", row.instants},
                  {"flagged_5s", figure(row.flagged)}, {"p75_m", figure(row.p75_m)}, {"p95_m", figure(row.p95_m)},
                  {"clean_p75_m", figure(row.clean_p75_m)}, {"clean_p95_m", figure(row.clean_p95_m)},
                  {"p95_ratio", figure(row.p95_m / row.clean_p95_m)}};
    if (row.scan_every_s > 0.0) entry["scan_every_s"] = row.scan_every_s;
    if (row.attack == "fakes") entry["fakes"] = row.fakes;
    if (row.attack == "kidnap") {
      for (const Scope scope : {Scope::kAll, Scope::kCovered}) {
        const auto s = static_cast<std::size_t>(scope);
        entry["after_15s"][name_of(scope)] = {{"walks", row.carried[s].walks}, {"p95_m", figure(row.carried[s].p95_m)},
                                              {"within_10m", figure(row.carried[s].within10)}, {"switched_on_p95_m", figure(row.switched_on[s].p95_m)},
                                              {"switched_on_within_10m", figure(row.switched_on[s].within10)}};
      }
    }
    json["attacks"].push_back(std::move(entry));
  }
  for (const PoisonRow& row : outcome.poisons) {
    json["poisons"].push_back({{"pipeline", row.pipeline}, {"points", row.points}, {"walks", row.walks}, {"gate", row.gate},
                               {"misplaced", row.misplaced}, {"doubted", row.doubted}, {"doubted_rightly", row.doubted_rightly},
                               {"mean_m", figure(row.mean_m)}, {"p75_m", figure(row.p75_m)}, {"p95_m", figure(row.p95_m)}});
  }
  return json.dump();
}

std::string attacks_table(const WalksOutcome& outcome) {
  std::string table = "| honest walks | hours | false alarms | an hour | suspect % | degraded % |\n| --- | ---: | ---: | ---: | ---: | ---: |\n";
  for (const AlarmRow& row : outcome.alarms) {
    const std::string phone = row.pipeline + slower(row.scan_every_s);
    table += line("| %s | %.2f | %zu | %.1f | %.1f | %.1f |\n", phone.c_str(), row.hours, row.alarms, per_hour(row), 100 * row.suspect,
                  100 * row.degraded);
  }
  if (!outcome.attacks.empty()) {
    table += "\n| attacked | attack | walks | flagged in 5 s % | p75 clean | p75 | p95 clean | p95 | ratio |\n"
             "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  }
  for (const AttackRow& row : outcome.attacks) {
    const std::string attack = name_of(row);
    table += line("| %s | %s | %zu | %.1f | %.2f | %.2f | %.2f | %.2f | %.2f |\n", row.pipeline.c_str(), attack.c_str(), row.walks, 100 * row.flagged,
                  row.clean_p75_m, row.p75_m, row.clean_p95_m, row.p95_m, row.p95_m / row.clean_p95_m);
  }
  table += carried_table(outcome);
  if (!outcome.poisons.empty()) {
    table += "\n| survey | points, walks misplaced % | gate | misplaced | left out | rightly | mean | p75 | p95 |\n"
             "| --- | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  }
  for (const PoisonRow& row : outcome.poisons) {
    table += line("| %s | %.0f, %.0f | %s | %zu | %zu | %zu | %.2f | %.2f | %.2f |\n", row.pipeline.c_str(), 100 * row.points, 100 * row.walks,
                  row.gate ? "on" : "off", row.misplaced, row.doubted, row.doubted_rightly, row.mean_m, row.p75_m, row.p95_m);
  }
  return table;
}

}  // namespace wayfuse
