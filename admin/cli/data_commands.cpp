#include <ctime>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "admin/cli/program.hpp"
#include "admin/cli/table.hpp"

namespace wayfuse::cli {
namespace {

// Absent: there is none, or the server refused; why is said.
std::optional<Reply> answer_to(const Program& program, const std::string& path) {
  auto reply = exchange(program.connection, "GET", path);
  if (!reply) {
    std::cerr << "wayfuse: " << reply.fault().cause << "\n";
    return std::nullopt;
  }
  if (reply->status < 400) return *std::move(reply);
  refused(*reply);
  return std::nullopt;
}

// Writes an answer into a file; what is there already is never half replaced.
int fetch(const Program& program, const std::string& path, const std::string& file) {
  const auto reply = answer_to(program, path);
  if (!reply) return EXIT_FAILURE;
  if (file == "-") {
    write_content(file, reply->body);
    return EXIT_SUCCESS;
  }
  write_content(file + ".part", reply->body);
  std::filesystem::rename(file + ".part", file);
  std::cerr << file << ": " << reply->body.size() << " bytes\n";
  return EXIT_SUCCESS;
}

// Unsound = a failure, so that scripts notice.
int verify(const Program& program) {
  const auto reply = answer_to(program, building_path(program, "/verification"));
  if (!reply) return EXIT_FAILURE;
  const auto report = nlohmann::json::parse(reply->body, nullptr, false);
  std::cout << (program.json ? reply->body : report.dump(2)) << "\n";
  return report.is_object() && report.value("sound", false) ? EXIT_SUCCESS : EXIT_FAILURE;
}

std::string utc(const nlohmann::json& at_us) {
  const std::time_t seconds = at_us.get<std::int64_t>() / 1'000'000;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &parts);
  return text;
}

// Backups and verifications in one table, newest first of each, and how far the newest backup is behind.
int show_backups(const Program& program) {
  const auto reply = answer_to(program, building_path(program, "/backups"));
  if (!reply) return EXIT_FAILURE;
  const auto json = nlohmann::json::parse(reply->body, nullptr, false);
  if (program.json || !json.is_object()) {
    std::cout << reply->body << "\n";
    return EXIT_SUCCESS;
  }
  std::vector<std::vector<std::string>> rows;
  for (const auto& one : json["backups"]) {
    rows.push_back({"backup", utc(one["at_us"]), "key " + one["by_key"].dump(), one["survey_version"].dump(), one["bytes"].dump() + " bytes"});
  }
  for (const auto& one : json["verifications"]) {
    rows.push_back({"verified", utc(one["at_us"]), "key " + one["by_key"].dump(), one["survey_version"].dump(),
                    one["sound"].get<bool>() ? "sound" : one["finding"].get<std::string>()});
  }
  std::cout << table({"what", "when", "by", "survey", "result"}, rows);
  if (json["backups"].empty()) {
    std::cout << "never backed up\n";
  } else if (json["backups"][0]["survey_version"] != json["survey_version"]) {
    std::cout << "the survey is at " << json["survey_version"] << " now: the newest backup lacks what was uploaded since\n";
  }
  return EXIT_SUCCESS;
}

}  // namespace

void add_data_commands(CLI::App& app, Program& program) {
  const auto fetching = [&](const char* name, const char* what, const char* path) {
    auto* command = app.add_subcommand(name, what);
    command->add_option("BUILDING", program.building)->required();
    command->add_option("FILE", program.file, "- = standard output")->required();
    command->callback([&program, path] { program.run = [&program, path] { return fetch(program, building_path(program, path), program.file); }; });
  };
  fetching("backup", "A building's database as one SQLite file, consistent while the server works", "/backup");
  fetching("export", "Everything an operator put in, as a zip of CSV, GeoJSON and JSON", "/export.zip");
  auto* restore = app.add_subcommand("restore", "Put a building back from a backup, under its own number");
  restore->add_option("FILE", program.file)->required();
  restore->callback([&] {
    program.call = {"POST", "/v1/restore", content_of(program.file), "", {}, false, "application/vnd.sqlite3"};
  });
  auto* backups = app.add_subcommand("backups", "When a building was backed up and verified, and what that gave");
  backups->add_option("BUILDING", program.building)->required();
  backups->callback([&] { program.run = [&program] { return show_backups(program); }; });
  auto* verifying = app.add_subcommand("verify", "Read a building's whole database and hold it against its hashes");
  verifying->add_option("BUILDING", program.building)->required();
  verifying->callback([&] { program.run = [&program] { return verify(program); }; });

  auto* erase = app.get_subcommand("survey")->add_subcommand("erase", "Erase reference points for good: all that fit every condition given");
  auto conditions = std::make_shared<std::map<std::string, std::string>>();
  erase->add_option("BUILDING", program.building)->required();
  for (const auto& [flag, name] : {std::pair{"--walk", "walk"}, std::pair{"--device-model", "device_model"}, std::pair{"--upload", "upload"},
                                     std::pair{"--point", "point"}, std::pair{"--before-us", "before_us"}}) {
    erase->add_option_function<std::string>(flag, [conditions, name = name](const std::string& value) { (*conditions)[name] = value; });
  }
  erase->callback([&, conditions] {
    std::string query;
    for (const auto& [name, value] : *conditions) query += (query.empty() ? "?" : "&") + name + "=" + escaped(value);
    program.call = {"DELETE", building_path(program, "/points" + query), "", "", {}};
  });
  auto* remove = app.get_subcommand("building")->add_subcommand("remove", "Remove a building for good, with all its files");
  auto sure = std::make_shared<bool>(false);
  remove->add_option("ID", program.building)->required();
  remove->add_flag("--yes", *sure, "I mean it")->required();
  remove->callback([&] { program.call = {"DELETE", building_path(program, ""), "", "", {}}; });

  auto* audit = app.add_subcommand("audit", "Who changed or saw what, oldest first");
  auto after = std::make_shared<std::uint64_t>(0);
  auto only = std::make_shared<std::string>();
  audit->add_option("--after", *after, "Go on behind this line");
  audit->add_option("--building", *only, "Only of this building");
  audit->callback([&, after, only] {
    program.call = {"GET", "/v1/audit?most=1000&after=" + std::to_string(*after) + (only->empty() ? "" : "&building=" + escaped(*only)), "", "audit",
                    {"id", "at_us", "key", "building", "action", "subject"}};
  });
}

}  // namespace wayfuse::cli
