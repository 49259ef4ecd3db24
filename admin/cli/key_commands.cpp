#include <nlohmann/json.hpp>

#include "admin/cli/program.hpp"

namespace wayfuse::cli {

void add_key_commands(CLI::App& app, Program& program) {
  auto* key = app.add_subcommand("key", "API keys")->require_subcommand(1);
  key->add_subcommand("list", "All keys, without their secrets")->callback([&] {
    program.call = {"GET", "/v1/keys", "", "keys", {"id", "name", "scopes", "building", "coarse"}};
  });
  auto* create = key->add_subcommand("create", "Make a key; it is shown this once");
  create->add_option("NAME", program.name)->required();
  create->add_option("--scope", program.scopes, "survey, track, observe, admin; may be repeated")->required();
  create->add_option("--building", program.building, "Only for this building; 0 = all")->default_val("0");
  create->add_option("--expires-in", program.expires_in_s, "Seconds");
  create->add_flag("--coarse", program.coarse, "It observes zones and never sees a coordinate");
  create->callback([&] {
    nlohmann::json body{{"name", program.name}, {"scopes", program.scopes}, {"building", std::stoull(program.building)}};
    if (program.coarse) body["coarse"] = true;
    if (program.expires_in_s > 0) body["expires_in_s"] = program.expires_in_s;
    program.call = {"POST", "/v1/keys", body.dump(), "", {}};
  });
  auto* revoke = key->add_subcommand("revoke", "Revoke a key at once");
  revoke->add_option("ID", program.id)->required();
  revoke->callback([&] { program.call = {"DELETE", "/v1/keys/" + program.id, "", "", {}}; });
}

}  // namespace wayfuse::cli
