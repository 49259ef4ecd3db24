#include "admin/cli/sessions_top.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "admin/cli/table.hpp"

namespace wayfuse::cli {
namespace {

using Json = nlohmann::json;

std::string number(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::map<std::string, std::uint64_t> applied_in(const std::string& answer) {
  std::map<std::string, std::uint64_t> applied;
  const Json json = Json::parse(answer, nullptr, false);
  if (!json.is_object()) return applied;
  for (const Json& session : json.value("sessions", Json::array())) applied[session.value("tracked", "")] = session.value("applied_through", 0ULL);
  return applied;
}

double radius_of(const Json& session) {
  return session.contains("position") ? session["position"].value("radius68_m", 0.0) : -1.0;
}

std::vector<std::string> row_of(const Json& session, const std::map<std::string, std::uint64_t>& before, double seconds_between) {
  std::vector<std::string> row{session.value("tracked", ""), session.value("building", Json()).dump(), "-", "-", "-", "-", "-",
                               session.value("connected", false) ? "yes" : "no", session.value("pipeline", ""), session.value("device_model", "")};
  if (session.contains("position")) {
    const Json& position = session["position"];
    row[2] = position.value("floor", Json()).dump();
    row[3] = number(position.value("x_m", 0.0), 1) + ", " + number(position.value("y_m", 0.0), 1);
    row[4] = number(radius_of(session), 1);
    row[5] = position.value("integrity", "-");
  }
  const auto then = before.find(row[0]);
  const std::uint64_t now = session.value("applied_through", 0ULL);
  if (then != before.end() && now >= then->second && seconds_between > 0) row[6] = number(static_cast<double>(now - then->second) / seconds_between, 1);
  return row;
}

}  // namespace

std::string top_of(const std::string& now, const std::string& before, double seconds_between, std::size_t most) {
  std::vector<Json> sessions = Json::parse(now).at("sessions").get<std::vector<Json>>();
  std::ranges::stable_sort(sessions, std::greater(), radius_of);
  const auto connected = std::ranges::count_if(sessions, [](const Json& session) { return session.value("connected", false); });
  const auto placed = std::ranges::count_if(sessions, [](const Json& session) { return session.contains("position"); });
  std::string text = std::to_string(sessions.size()) + " sessions, " + std::to_string(connected) + " connected, " + std::to_string(placed) + " placed\n";
  const auto applied = applied_in(before);
  std::vector<std::vector<std::string>> rows;
  for (const Json& session : sessions) {
    if (rows.size() == most) break;
    rows.push_back(row_of(session, applied, seconds_between));
  }
  text += table({"tracked", "building", "floor", "x, y m", "within m", "integrity", "samples/s", "connected", "pipeline", "device"}, rows);
  if (sessions.size() > rows.size()) text += "and " + std::to_string(sessions.size() - rows.size()) + " more\n";
  return text;
}

}  // namespace wayfuse::cli
