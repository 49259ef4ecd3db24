#include <memory>
#include <nlohmann/json.hpp>

#include "admin/cli/program.hpp"
#include "admin/cli/replay_report.hpp"

namespace wayfuse::cli {
namespace {

using nlohmann::json;

constexpr double kMiB = 1024.0 * 1024.0;

std::string recordings_path(const Program& program, bool anywhere) {
  return anywhere ? "/v1/recordings/" + escaped(program.id) : building_path(program, "/recordings/" + escaped(program.id));
}

struct Order {
  double hours = 1.0;
  double kept_hours = 24.0;
  double mib = 64.0;
  std::vector<std::string> tracked;

  std::string body() const {
    return json{{"on_for_s", hours * 3600.0}, {"kept_s", kept_hours * 3600.0}, {"bytes", static_cast<std::int64_t>(mib * kMiB)}, {"tracked", tracked}}.dump();
  }
};

struct Again {
  std::string pipeline;
  std::uint64_t map = 0;
  bool on_map = false;
  std::uint64_t after = 0;
  std::size_t most = 20;

  std::string body() const {
    json question{{"after", after}, {"most", most}};
    if (!pipeline.empty()) question["pipeline"] = pipeline;
    if (on_map) question["radio_map_version"] = map;
    return question.dump();
  }
};

int fetch(const Program& program, const std::string& path) {
  const auto reply = exchange(program.connection, "GET", path, "", "", {});
  if (!reply) throw std::runtime_error(reply.fault().cause);
  if (reply->status >= 400) return refused(*reply);
  write_content(program.file, reply->body);
  return EXIT_SUCCESS;
}

void add_switch_commands(CLI::App& recording, Program& program) {
  auto* on = recording.add_subcommand("on", "Record what phones send in a building, in the server's memory, for a while");
  auto order = std::make_shared<Order>();
  on->add_option("BUILDING", program.building)->required();
  on->add_option("--hours", order->hours, "How long")->capture_default_str()->check(CLI::Range(0.01, 168.0));
  on->add_option("--keep-hours", order->kept_hours, "Older pieces are forgotten")->capture_default_str()->check(CLI::Range(0.02, 168.0));
  on->add_option("--mib", order->mib, "Memory; then the oldest pieces go")->capture_default_str()->check(CLI::Range(1.0, 256.0));
  on->add_option("--tracked", order->tracked, "Only this phone, by its public name; may be repeated");
  on->callback([&program, order] { program.call = {"PUT", building_path(program, "/recording"), order->body(), "", {}}; });
  auto* off = recording.add_subcommand("off", "Stop; what is recorded stays until it is too old or erased");
  off->add_option("BUILDING", program.building)->required();
  off->callback([&] { program.call = {"PUT", building_path(program, "/recording"), R"({"on_for_s":0})", "", {}}; });
  auto* status = recording.add_subcommand("status", "Whether it is on, and what room it takes");
  status->add_option("BUILDING", program.building)->required();
  status->callback([&] { program.call = {"GET", building_path(program, "/recording"), "", "", {}}; });
}

}  // namespace

void add_recording_commands(CLI::App& app, Program& program) {
  auto* recording = app.add_subcommand("recording", "Recordings of sessions: what phones sent, to be lived through again")->require_subcommand(1);
  add_switch_commands(*recording, program);
  auto* list = recording->add_subcommand("list", "Recorded sessions of a building");
  list->add_option("BUILDING", program.building)->required();
  list->callback([&] {
    program.call = {"GET", building_path(program, "/recordings?most=1000"), "", "recordings",
                    {"id", "tracked", "device_model", "pipeline", "last_radio_map_version", "steps", "samples", "bytes", "growing", "from_the_start"}};
  });
  const auto one = [&](CLI::App* command) {
    command->add_option("ID", program.id)->required();
    command->add_option("--building", program.building, "For a key of this building only; 0 = any")->default_val("0");
  };
  const auto path = [&program] { return recordings_path(program, program.building == "0"); };
  auto* get = recording->add_subcommand("get", "What one session was fed, as JSON lines");
  one(get);
  get->add_option("--out", program.file, "Where to; - = standard output")->default_val("-");
  get->callback([&program, path] { program.run = [&program, path] { return fetch(program, path()); }; });
  auto* erase = recording->add_subcommand("erase", "Erase one recording for good");
  one(erase);
  erase->callback([&program, path] { program.call = {"DELETE", path(), "", "", {}}; });

  auto* replay = app.add_subcommand("replay", "Live through a recording again, step by step; by another pipeline or on another map where asked");
  auto again = std::make_shared<Again>();
  one(replay);
  replay->add_option("--pipeline", again->pipeline, "Preset; as it was where not said");
  auto* map = replay->add_option("--map", again->map, "Radio map version; as it was where not said");
  replay->add_option("--after", again->after, "Show steps after this one")->capture_default_str();
  replay->add_option("--most", again->most, "Steps to show")->capture_default_str()->check(CLI::Range(1, 200));
  replay->callback([&program, path, again, map] {
    again->on_map = map->count() > 0;
    program.call = {.method = "POST", .path = path() + "/replay", .body = again->body(), .show = replayed};
  });
}

}  // namespace wayfuse::cli
