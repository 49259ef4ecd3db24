#include "admin/cli/replay_report.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "admin/cli/table.hpp"

namespace wayfuse::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string number(const Json& value, const char* format, double unit = 1.0) {
  char text[32];
  std::snprintf(text, sizeof text, format, value.get<double>() / unit);
  return text;
}

std::string largest_residual(const Json& used) {
  for (const Json& reading : used) {  // largest first
    if (reading.at("residual_db").is_number()) return reading.at("bssid").get<std::string>() + " " + number(reading.at("residual_db"), "%+.0f");
  }
  return "-";
}

std::vector<std::string> row_of(const Json& step) {
  const std::string live = step.at("as_live").is_boolean() ? (step.at("as_live").get<bool>() ? "same" : "DIFFERS") : step.at("said").get<bool>() ? "said" : "-";
  std::vector<std::string> row = {step.at("step").dump(), number(step.at("time_us"), "%.2f", 1e6)};
  if (!step.contains("explanation")) {
    row.insert(row.end(), {"-", "-", "-", "-", step.at("radio_map_version").dump(), "-", "-", step.value("no_position", ""), live});
    return row;
  }
  const Json& explanation = step.at("explanation");
  const Json& position = explanation.at("position");
  std::string doubts;
  for (const Json& reason : explanation.at("integrity").at("reasons")) doubts += (doubts.empty() ? "" : "; ") + reason.get<std::string>();
  row.insert(row.end(), {number(position.at("x_m"), "%.2f"), number(position.at("y_m"), "%.2f"), position.at("floor").dump(),
                         number(position.at("radius68_m"), "%.1f"), step.at("radio_map_version").dump(), std::to_string(explanation.at("used").size()),
                         largest_residual(explanation.at("used")), doubts, live});
  return row;
}

}  // namespace

std::string replayed(const std::string& json) {
  const Json answer = Json::parse(json);
  std::string text = "recording " + answer.at("recording").dump() + " by " + answer.at("pipeline").get<std::string>();
  text += answer.at("radio_map_version").is_null() ? "" : " on radio map " + answer.at("radio_map_version").dump();
  text += ": " + answer.at("steps_in_all").dump() + " steps\n";
  if (answer.at("as_it_was").get<bool>()) {
    text += answer.at("differing") == 0 ? "every position the phone was told comes out again, bit for bit\n"
                                        : answer.at("differing").dump() + " positions come out otherwise than the phone was told\n";
  }
  for (const Json& remark : answer.at("remarks")) text += "  " + remark.get<std::string>() + "\n";
  std::vector<std::vector<std::string>> rows;
  for (const Json& step : answer.at("steps")) rows.push_back(row_of(step));
  text += "\n" + table({"step", "time s", "x m", "y m", "floor", "68 % m", "map", "readings", "largest residual dB", "doubts", "live"}, rows);
  if (answer.contains("next")) text += "go on with --after " + answer.at("next").dump() + "\n";
  return text;
}

}  // namespace wayfuse::cli
