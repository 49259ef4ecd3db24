// From zero to a moving dot in C++: your own loop, your own sensors, a position at any moment.
//
//   ./moving_dot ws://127.0.0.1:8420/v1/session KEY 1
#include <cstdio>
#include <cstdlib>
#include <random>

#include "wayfuse/sdk/motion_tracker.hpp"
#include "wayfuse/sdk/position_now.hpp"
#include "wayfuse/sdk/websocket_link.hpp"

int main(int count, char** words) {
  if (count < 4) return std::fprintf(stderr, "usage: moving_dot URL KEY BUILDING [SECONDS]\n"), 2;
  wayfuse::NetworkLoop loop;
  wayfuse::WebsocketLinkSettings where;
  where.url = words[1];
  auto links = loop.links(where);
  if (!links) return std::fprintf(stderr, "%s\n", to_string(links.fault()).c_str()), 1;

  wayfuse::ClientSettings settings;
  settings.building = wayfuse::BuildingId{std::strtoull(words[3], nullptr, 10)};
  settings.token = [key = std::string(words[2])] { return key; };
  settings.device_model = "example";
  wayfuse::PositionNow dot;
  wayfuse::ClientEvents events;
  events.welcomed = [&](const wayfuse::Welcome& welcome) { dot.welcomed(welcome); };
  events.position = [&](const wayfuse::Position& word) { dot.fused(word.position, loop.now()); };
  events.fault = [](const wayfuse::FaultReport& report) { std::fprintf(stderr, "%s\n", to_string(report.fault).c_str()); };
  wayfuse::Client client(settings, events, *links, loop, wayfuse::Random(std::random_device{}()));
  client.start();

  auto motion = wayfuse::MotionTracker::create({});
  for (int frame = 0; frame < 60 * (count > 4 ? std::atoi(words[4]) : 60); ++frame) {
    loop.run_for(wayfuse::from_seconds(1.0 / 60));
    wayfuse::MargSample still{loop.now(), {{0, 0, 9.81}}, {{0, 0, 0}}, {{0, 22, -42}}, {}};  // your SensorEvents go here
    if (const auto report = motion->feed(still)) {
      dot.moved(*report);
      (void)client.send(*report);
    }
    if (frame % 120 == 0) {  // and your ScanResults here, each reading with its own age: these live in the demo building
      const wayfuse::Duration age{1000};
      (void)client.send(wayfuse::RssScan{loop.now(), {{wayfuse::Bssid{0x001b2cf0b531}, -47, age, 5260, {}, {}},
                                                      {wayfuse::Bssid{0x001b2c6f7b01}, -51, age, 5500, {}, {}},
                                                      {wayfuse::Bssid{0x001b2c4e66e1}, -79, age, 5500, {}, {}}}});
    }
    const auto live = dot.at(loop.now());
    if (live && frame % 60 == 59) {
      std::printf("%.2f m, %.2f m, floor %d, within %.1f m\n", live->place.point.x_m, live->place.point.y_m,
                  live->place.floor.value, live->radius68_m);
    }
  }
  client.stop();
  loop.run_for(std::chrono::milliseconds(100));
}
