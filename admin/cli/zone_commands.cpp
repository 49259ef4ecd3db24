#include <algorithm>
#include <chrono>
#include <ctime>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "admin/cli/program.hpp"

namespace wayfuse::cli {
namespace {

using nlohmann::json;

std::string clock_of(std::int64_t at_us) {
  const std::time_t seconds = at_us / 1'000'000;
  std::tm broken{};
  ::localtime_r(&seconds, &broken);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &broken);
  return text;
}

/// Reads server-sent events line by line and shows each.
class Watcher {
 public:
  explicit Watcher(bool as_json) : as_json_(as_json) {}
  const std::string& last_id() const { return last_id_; }

  bool take(std::string_view piece) {
    for (const char c : piece) {
      if (c == '\n') {
        line(line_);
        line_.clear();
      } else {
        line_ += c;
      }
    }
    return true;
  }

 private:
  void line(const std::string& text) {
    if (text.rfind("id: ", 0) == 0) last_id_ = text.substr(4);
    if (text.rfind("event: ", 0) == 0) kind_ = text.substr(7);
    if (text.rfind("data: ", 0) == 0) show(text.substr(6));
  }
  void show(const std::string& data) {
    if (as_json_) {
      std::cout << data << std::endl;
      return;
    }
    if (kind_ == "missed") {
      std::cout << "-- events are missing here: the server restarted, or they came faster than they were read" << std::endl;
      return;
    }
    const json event = json::parse(data, nullptr, false);
    if (!event.is_object()) return;
    std::cout << clock_of(event.value("at_us", std::int64_t{0})) << "  " << event.value("tracked", "") << ' ' << event.value("transition", "") << " zone "
              << event.value("zone", "") << " '" << event.value("zone_name", "") << "', p = " << event.value("probability", 0.0);
    if (event.contains("retracts")) std::cout << ", instead of event " << event["retracts"].get<std::string>();
    std::cout << std::endl;
  }

  const bool as_json_;
  std::string line_;
  std::string kind_;
  std::string last_id_;
};

// Goes on behind the last event seen when the line breaks.
int watch(const Program& program) {
  Watcher watcher(program.json);
  for (int failures = 0;;) {
    std::map<std::string, std::string> headers = {{"accept", "text/event-stream"}};
    if (!watcher.last_id().empty()) headers["last-event-id"] = watcher.last_id();
    const auto reply = follow(program.connection, building_path(program, "/events"), headers, [&](std::string_view piece) {
      failures = 0;
      return watcher.take(piece);
    });
    if (reply && reply->status >= 400) return refused(*reply);
    if (!reply) std::cerr << "wayfuse: " << reply.fault().cause << "\n";
    if (++failures > 10) return EXIT_FAILURE;
    std::this_thread::sleep_for(std::chrono::seconds(std::min(failures, 5)));
  }
}

}  // namespace

void add_zone_commands(CLI::App& app, Program& program) {
  auto* zone = app.add_subcommand("zone", "Zones, who is in them, and their events")->require_subcommand(1);
  const auto building = [&](CLI::App* command) { command->add_option("BUILDING", program.building)->required(); };
  const auto one = [&](CLI::App* command) {
    building(command);
    command->add_option("ZONE", program.id)->required();
  };
  const auto path = [&] { return building_path(program, "/zones/" + escaped(program.id)); };

  auto* list = zone->add_subcommand("list", "All zones of a building");
  building(list);
  list->callback([&] {
    program.call = {"GET", building_path(program, "/zones?most=1000"), "", "zones", {"id", "name", "floor", "exit_tolerance_m", "exit_delay_us", "timeout_us"}};
  });
  auto* show = zone->add_subcommand("show", "One zone");
  one(show);
  show->callback([&, path] { program.call = {"GET", path(), "", "", {}}; });
  auto* add = zone->add_subcommand("add", "Make a zone from its JSON (- = standard input): name, floor, region, tolerances");
  building(add);
  add->add_option("FILE", program.file)->required();
  add->callback([&] { program.call = {"POST", building_path(program, "/zones"), content_of(program.file), "", {}}; });
  auto* replace = zone->add_subcommand("replace", "Replace a zone");
  one(replace);
  replace->add_option("FILE", program.file)->required();
  replace->callback([&, path] { program.call = {"PUT", path(), content_of(program.file), "", {}}; });
  auto* remove = zone->add_subcommand("remove", "Remove a zone");
  one(remove);
  remove->callback([&, path] { program.call = {"DELETE", path(), "", "", {}}; });
  auto* occupants = zone->add_subcommand("occupants", "Phones in a zone now");
  one(occupants);
  occupants->callback([&, path] { program.call = {"GET", path() + "/occupants", "", "occupants", {"tracked", "since_us", "probability"}}; });
  auto* watching = zone->add_subcommand("watch", "Entries and exits as they happen, until Ctrl-C");
  building(watching);
  watching->callback([&] { program.run = [&program] { return watch(program); }; });
}

void add_webhook_commands(CLI::App& app, Program& program) {
  auto* webhook = app.add_subcommand("webhook", "Where zone events are posted to")->require_subcommand(1);
  const auto one = [&](CLI::App* command) {
    command->add_option("BUILDING", program.building)->required();
    command->add_option("WEBHOOK", program.id)->required();
  };
  const auto path = [&] { return building_path(program, "/webhooks/" + escaped(program.id)); };
  auto* list = webhook->add_subcommand("list", "All webhooks and how their deliveries go");
  list->add_option("BUILDING", program.building)->required();
  list->callback([&] {
    program.call = {"GET", building_path(program, "/webhooks?most=1000"), "", "webhooks",
                    {"id", "url", "enabled", "waiting", "delivered", "failed_attempts", "dead_letters", "last_failure"}};
  });
  auto* add = webhook->add_subcommand("add", "Make a webhook; its secret is shown this once");
  auto zones = std::make_shared<std::vector<std::uint64_t>>();
  add->add_option("BUILDING", program.building)->required();
  add->add_option("URL", program.name)->required();
  add->add_option("--zone", *zones, "Only events of this zone; may be repeated");
  add->callback([&, zones] {
    program.call = {"POST", building_path(program, "/webhooks"), json{{"url", program.name}, {"zones", *zones}}.dump(), "", {}};
  });
  auto* remove = webhook->add_subcommand("remove", "Remove a webhook");
  one(remove);
  remove->callback([&, path] { program.call = {"DELETE", path(), "", "", {}}; });
  auto* dead = webhook->add_subcommand("dead", "Events that could not be delivered");
  one(dead);
  dead->callback([&, path] { program.call = {"GET", path() + "/dead-letters", "", "dead_letters", {"event", "at_us", "attempts", "failure"}}; });
  auto* retry = webhook->add_subcommand("retry", "Try the dead ones again");
  one(retry);
  auto event = std::make_shared<std::string>();
  retry->add_option("--event", *event, "Only the one of this event");
  retry->callback([&, path, event] {
    program.call = {"POST", path() + "/dead-letters/retry" + (event->empty() ? "" : "?event=" + escaped(*event)), "", "", {}};
  });
  auto* deliveries = webhook->add_subcommand("deliveries", "The newest attempts at delivering, and what came of each");
  one(deliveries);
  deliveries->callback([&, path] {
    program.call = {"GET", path() + "/deliveries", "", "deliveries", {"at_us", "event", "attempt", "status", "took_us", "outcome", "failure"}};
  });
}

}  // namespace wayfuse::cli
