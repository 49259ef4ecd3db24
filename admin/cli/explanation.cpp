#include "admin/cli/explanation.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "admin/cli/table.hpp"

namespace wayfuse::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string number(const Json& value, const char* format = "%.1f", double unit = 1.0) {
  if (!value.is_number()) return "-";
  char text[32];
  std::snprintf(text, sizeof text, format, value.get<double>() / unit);
  return text;
}

std::string where(const Json& answer) {
  const Json& position = answer.at("position");
  std::string text = answer.at("tracked").get<std::string>() + " in building " + answer.at("building").dump() + " by " +
                     answer.at("pipeline").get<std::string>() + ", radio map " + position.at("radio_map_version").dump() + "\n";
  text += "at x " + number(position.at("x_m")) + " m, y " + number(position.at("y_m")) + " m, floor " + position.at("floor").dump() +
          "; 68 % within " + number(position.at("radius68_m")) + " m, 95 % within " + number(position.at("radius95_m")) + " m\n";
  text += "newest scan " + number(answer.at("scan_age_us"), "%.1f", 1e6) + " s ago, " + answer.at("steps_since_scan").dump() +
          " steps since" + (answer.at("gnss").get<bool>() ? ", GNSS too" : "") + "\n";
  text += "floors:";
  for (const Json& vote : answer.at("floor_votes")) {
    text += " " + vote.at("floor").dump() + " (" + number(vote.at("probability"), "%.0f", 0.01) + " %)";
  }
  return text + "\n";
}

std::vector<std::string> row_of(const Json& reading) {
  return {reading.at("bssid").get<std::string>(), number(reading.at("heard_dbm"), "%.0f"), number(reading.at("expected_dbm"), "%.0f"),
          number(reading.at("residual_db"), "%+.1f"), number(reading.at("age_us"), "%.1f", 1e6), reading.value("why", "used")};
}

}  // namespace

std::string explained(const std::string& json) {
  const Json answer = Json::parse(json);
  std::string text = where(answer);
  text += "integrity: " + answer.at("integrity").at("state").get<std::string>() + "\n";
  for (const Json& reason : answer.at("integrity").at("reasons")) text += "  " + reason.get<std::string>() + "\n";
  for (const Json& remark : answer.value("remarks", Json::array())) text += "  " + remark.get<std::string>() + "\n";
  text += std::to_string(answer.at("used").size()) + " readings used, " + std::to_string(answer.at("rejected").size()) +
          " rejected; expected levels from " + answer.at("surveyed_points_near").dump() + " surveyed points nearby\n\n";
  std::vector<std::vector<std::string>> rows;
  for (const char* list : {"used", "rejected"}) {
    for (const Json& reading : answer.at(list)) rows.push_back(row_of(reading));
  }
  return text + table({"access point", "heard dBm", "expected", "residual dB", "age s", "use"}, rows);
}

}  // namespace wayfuse::cli
