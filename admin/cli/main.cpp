// wayfuse: the operator's command line. Every command is one request to the admin API.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "admin/cli/api_client.hpp"
#include "admin/cli/completion.hpp"
#include "admin/cli/doctor.hpp"
#include "admin/cli/table.hpp"

namespace {

using namespace wayfuse;
using namespace wayfuse::cli;

struct Call {
  std::string method;
  std::string path;
  std::string body;
  std::string list;                  // the answer's list shown as a table
  std::vector<std::string> fields;   // its columns
  bool raw = false;                  // print as it comes: exports
};

struct Program {
  Connection connection;
  bool json = false;
  std::string building = "1";
  std::string id, file, name, format = "csv";
  std::vector<std::string> scopes;
  double expires_in_s = 0;
  DoctorSettings doctor;
  Call call;
};

std::string content_of(const std::string& file) {
  if (file == "-") return {std::istreambuf_iterator<char>(std::cin), {}};
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file + " cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

// The server's own words: title, field and cause of its problem document.
int refused(const Reply& reply) {
  const auto problem = nlohmann::json::parse(reply.body, nullptr, false);
  std::cerr << "wayfuse: the server refused";
  if (problem.is_object()) {
    for (const char* part : {"title", "field", "detail"}) {
      if (problem.contains(part) && problem[part].is_string() && !problem[part].get<std::string>().empty()) {
        std::cerr << ": " << problem[part].get<std::string>();
      }
    }
  }
  std::cerr << " (HTTP " << reply.status << ")\n";
  return EXIT_FAILURE;
}

int perform(const Program& program) {
  const Call& call = program.call;
  const auto reply = exchange(program.connection, call.method, call.path, call.body);
  if (!reply) {
    std::cerr << "wayfuse: " << reply.fault().cause << "\n";
    return EXIT_FAILURE;
  }
  if (reply->status >= 400) return refused(*reply);
  if (call.raw || program.json) {
    std::cout << reply->body << (call.raw ? "" : "\n");
  } else if (!reply->body.empty()) {
    std::cout << readable(reply->body, call.list, call.fields);
  }
  return EXIT_SUCCESS;
}

void add_building_commands(CLI::App& app, Program& program) {
  auto* building = app.add_subcommand("building", "Buildings and their floors")->require_subcommand(1);
  building->add_subcommand("list", "All buildings")->callback([&] {
    program.call = {"GET", "/v1/buildings", "", "buildings", {"id", "name", "pipeline", "survey_version"}};
  });
  auto* show = building->add_subcommand("show", "One building");
  show->add_option("ID", program.building)->required();
  show->callback([&] { program.call = {"GET", "/v1/buildings/" + program.building, "", "", {}}; });
  auto* create = building->add_subcommand("create", "Create a building from its JSON description (- = standard input)");
  create->add_option("FILE", program.file)->required();
  create->callback([&] { program.call = {"POST", "/v1/buildings", content_of(program.file), "", {}}; });
  auto* replace = building->add_subcommand("replace", "Replace a building's description");
  replace->add_option("ID", program.building)->required();
  replace->add_option("FILE", program.file)->required();
  replace->callback([&] { program.call = {"PUT", "/v1/buildings/" + program.building, content_of(program.file), "", {}}; });
}

void add_survey_commands(CLI::App& app, Program& program) {
  auto* survey = app.add_subcommand("survey", "Reference points and access points")->require_subcommand(1);
  const auto at = [&](const char* what) { return "/v1/buildings/" + program.building + what; };
  auto* upload = survey->add_subcommand("upload", "Upload a survey document (proto/README.md), - = standard input");
  upload->add_option("BUILDING", program.building)->required();
  upload->add_option("FILE", program.file)->required();
  upload->callback([&program, at] { program.call = {"POST", at("/points"), content_of(program.file), "", {}}; });
  auto* dump = survey->add_subcommand("export", "Every reference point, to standard output");
  dump->add_option("BUILDING", program.building)->required();
  dump->add_option("--format", program.format, "csv or geojson")->check(CLI::IsMember({"csv", "geojson"}));
  dump->callback([&program, at] { program.call = {"GET", at(("/points." + program.format).c_str()), "", "", {}, true}; });
  auto* transmitters = survey->add_subcommand("transmitters", "Access points as the survey heard them");
  transmitters->add_option("BUILDING", program.building)->required();
  transmitters->callback([&program, at] {
    program.call = {"GET", at("/transmitters"), "", "transmitters", {"bssid", "frequency_mhz", "readings", "strongest_dbm"}};
  });
}

void add_key_commands(CLI::App& app, Program& program) {
  auto* key = app.add_subcommand("key", "API keys")->require_subcommand(1);
  key->add_subcommand("list", "All keys, without their secrets")->callback([&] {
    program.call = {"GET", "/v1/keys", "", "keys", {"id", "name", "scopes", "building", "revoked"}};
  });
  auto* create = key->add_subcommand("create", "Make a key; it is shown this once");
  create->add_option("NAME", program.name)->required();
  create->add_option("--scope", program.scopes, "survey, track, observe, admin; may be repeated")->required();
  create->add_option("--building", program.building, "Only for this building; 0 = all")->default_val("0");
  create->add_option("--expires-in", program.expires_in_s, "Seconds");
  create->callback([&] {
    nlohmann::json body{{"name", program.name}, {"scopes", program.scopes}, {"building", std::stoull(program.building)}};
    if (program.expires_in_s > 0) body["expires_in_s"] = program.expires_in_s;
    program.call = {"POST", "/v1/keys", body.dump(), "", {}};
  });
  auto* revoke = key->add_subcommand("revoke", "Revoke a key at once");
  revoke->add_option("ID", program.id)->required();
  revoke->callback([&] { program.call = {"DELETE", "/v1/keys/" + program.id, "", "", {}}; });
}

void add_operation_commands(CLI::App& app, Program& program) {
  app.add_subcommand("status", "Whether the server is ready, and why not")->callback([&] {
    program.call = {"GET", "/readyz", "", "", {}};
  });
  app.add_subcommand("version", "The server's version")->callback([&] { program.call = {"GET", "/v1/version", "", "", {}}; });
  app.add_subcommand("metrics", "Prometheus metrics")->callback([&] { program.call = {"GET", "/metrics", "", "", {}, true}; });
  app.add_subcommand("sessions", "Live sessions")->callback([&] {
    program.call = {"GET", "/v1/sessions", "", "sessions", {"tracked", "building", "device_model", "pipeline", "connected", "applied_through"}};
  });
  app.add_subcommand("pipelines", "Pipeline presets")->callback([&] {
    program.call = {"GET", "/v1/pipelines", "", "pipelines", {"pipeline"}};
  });
  app.add_subcommand("parts", "Every pipeline part")->callback([&] {
    program.call = {"GET", "/v1/parts", "", "parts", {"role", "name", "summary"}};
  });
}

CLI::App* add_doctor_command(CLI::App& app, Program& program) {
  auto* doctor = app.add_subcommand("doctor", "Find what is misconfigured on this machine and at the server, and how to mend it");
  doctor->add_option("--config", program.doctor.config, "The server's configuration file")->capture_default_str();
  doctor->add_option("--wayfused", program.doctor.wayfused, "The server's program")->capture_default_str();
  doctor->add_option("--user", program.doctor.user, "As whom the server runs; root looks with that user's eyes")->capture_default_str();
  return doctor;
}

// `wayfuse complete -- WORD...`: what may stand where the last word stands; for the shell.
int complete(const CLI::App& app, int argc, char** argv) {
  const std::vector<std::string> words(argv + std::min(argc, 3), argv + argc);
  for (const std::string& word : completions(app, words)) std::cout << word << "\n";
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  Program program;
  CLI::App app("wayfuse: run a building's positioning from the command line");
  app.require_subcommand(1);
  app.fallthrough();  // --json and its like may stand anywhere
  app.add_option("--server", program.connection.server, "Base URL of wayfused")->envname("WAYFUSE_SERVER")->default_val("http://127.0.0.1:8420");
  app.add_option("--key", program.connection.key, "API key; better given as WAYFUSE_KEY")->envname("WAYFUSE_KEY");
  app.add_option("--authority", program.connection.authority, "PEM file with the certificate authority to trust")->envname("WAYFUSE_AUTHORITY")->check(CLI::ExistingFile);
  app.add_flag("--json", program.json, "Print the server's JSON as it came");
  add_building_commands(app, program);
  add_survey_commands(app, program);
  add_key_commands(app, program);
  add_operation_commands(app, program);
  const CLI::App* doctor = add_doctor_command(app, program);
  if (argc > 1 && std::string_view(argv[1]) == "complete") return complete(app, argc, argv);
  try {
    app.parse(argc, argv);
    if (*doctor) return report(examine(program.connection, program.doctor), program.json);
    return perform(program);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::cerr << "wayfuse: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
