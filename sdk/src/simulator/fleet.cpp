#include "sdk/src/simulator/fleet.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <stdexcept>

#include "sdk/src/simulator/live_table.hpp"
#include "sdk/src/simulator/scaled_scheduler.hpp"
#include "sdk/src/simulator/stand_in_phone.hpp"
#include "sdk/src/simulator/surveying.hpp"
#include "sdk/src/simulator/tracked_phone.hpp"
#include "wayfuse/sdk/websocket_link.hpp"

namespace wayfuse::simulator {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(50);        // real time between two looks at the phones
constexpr Duration kSettleMost = std::chrono::seconds(15);       // real time for the last acknowledgements
constexpr Duration kSurveyMost = std::chrono::minutes(10);

Client::LinkFactory links_to(NetworkLoop& loop, const ServerAddress& server) {
  WebsocketLinkSettings settings;
  settings.url = server.url;
  settings.ca_file = server.authority;
  settings.authorization = [key = server.key] { return "Bearer " + key; };
  auto links = loop.links(std::move(settings));
  if (!links) throw std::invalid_argument(to_string(links.fault()));
  return std::move(links).value();
}

ClientSettings client_settings(Role role, BuildingId building) {
  ClientSettings settings;
  settings.role = role;
  settings.building = building;
  settings.app = "wayfuse-phone";
  return settings;
}

// The phones' noses are all a little different: a surveyor's phone is the reference, the walkers' are not.
Device surveyor_device() {
  Device device;
  device.model = "surveyor";
  return device;
}

std::string clock_text(Duration walked) {
  char text[32];
  std::snprintf(text, sizeof text, "%02d:%02d walked", static_cast<int>(seconds(walked)) / 60, static_cast<int>(seconds(walked)) % 60);
  return text;
}

/// Uploads batches one session long and counts what came back.
class Upload {
 public:
  Upload(NetworkLoop& loop, const ServerAddress& server, BuildingId building, std::vector<SurveyBatch> batches, std::uint64_t seed,
         std::FILE* out)
      : loop_(loop), out_(out), batches_(std::move(batches)), total_(batches_.size()),
        client_(settings(building), events(), links_to(loop, server), loop, Random(seed)) {}

  bool run() {
    client_.start();
    loop_.after(kSurveyMost, [this] { fail("the server did not acknowledge in time"); });
    feed();
    loop_.run();
    client_.stop();
    if (fault_.empty()) {
      std::fprintf(out_, "%s  %llu points stored, survey version %llu\n", progress_bar(1).c_str(),
                   static_cast<unsigned long long>(points_), static_cast<unsigned long long>(version_));
    } else {
      std::fprintf(out_, "survey failed: %s\n", fault_.c_str());
    }
    return fault_.empty();
  }

 private:
  static ClientSettings settings(BuildingId building) {
    ClientSettings settings = client_settings(Role::kSurvey, building);
    settings.device_model = surveyor_device().model;
    return settings;
  }

  ClientEvents events() {
    ClientEvents events;
    events.survey_stored = [this](const SurveyAck& ack) {
      points_ += ack.stored;
      version_ = std::max(version_, ack.survey_version);
      ++acked_;
      feed();
      if (acked_ == total_) loop_.stop();
    };
    events.fault = [this](const FaultReport& report) {
      if (!report.idempotency_key.empty() || face_of(report.fault.code).close_code != 0) fail(to_string(report.fault));
    };
    events.state_changed = [this](ClientState state) {
      if (state == ClientState::kEnded && acked_ < total_) fail("the session ended");
    };
    return events;
  }

  // As many as the client takes; the rest when acknowledgements make room.
  void feed() {
    while (sent_ < batches_.size() && client_.upload(batches_[sent_])) ++sent_;
  }

  void fail(const std::string& why) {
    if (fault_.empty()) fault_ = why;
    loop_.stop();
  }

  NetworkLoop& loop_;
  std::FILE* out_;
  std::vector<SurveyBatch> batches_;
  std::size_t total_, sent_ = 0, acked_ = 0;
  std::uint64_t points_ = 0, version_ = 0;
  std::string fault_;
  Client client_;
};

std::unique_ptr<TrackedPhone> make_phone(const World& world, const Propagation& propagation, const Walker& walker,
                                         const WalkFleetSettings& settings, const Client::LinkFactory& links,
                                         Scheduler& scheduler, Random random) {
  StandInSettings stand_in;
  stand_in.device = draw_device(random);
  stand_in.carrying = carrying_of(settings.carrying, random);
  stand_in.scanner.throttled = settings.throttled;
  stand_in.start = scheduler.now();
  auto phone = std::make_unique<StandInPhone>(world, propagation, walker, stand_in, random.split());
  TrackedPhoneSettings tracked;
  tracked.client = client_settings(Role::kTrack, settings.building);
  tracked.client.pipeline = settings.pipeline;
  tracked.compare = settings.compare;
  return std::make_unique<TrackedPhone>(std::move(phone), tracked, links, scheduler, random.split());
}

// Starts the phones, lets them live, waits for the last acknowledgements, ends the sessions; false = something never arrived.
bool live(NetworkLoop& loop, ScaledScheduler& clock, const std::vector<std::unique_ptr<TrackedPhone>>& phones, Duration length,
          std::FILE* out) {
  for (const auto& phone : phones) phone->start();
  LiveTable table(out);
  const PhoneTime start = clock.now();
  for (bool walking = true; walking;) {
    loop.run_for(kTick);
    walking = false;
    for (const auto& phone : phones) walking = phone->advance(clock.now()) || walking;
    const Duration walked = std::min(clock.now() - start, length);
    table.show(phones, length > Duration{0} ? seconds(walked) / seconds(length) : 1.0, clock_text(walked));
  }
  const PhoneTime deadline = loop.now() + kSettleMost;
  while (loop.now() < deadline && !std::ranges::all_of(phones, &TrackedPhone::settled)) loop.run_for(kTick);
  std::size_t left_alone = 0;
  for (const auto& phone : phones) {
    if (phone->all_acknowledged()) continue;
    ++left_alone;
    if (left_alone == 1 && phone->fault()) std::fprintf(out, "The newest fault: %s\n", to_string(*phone->fault()).c_str());
  }
  for (const auto& phone : phones) phone->stop();
  loop.run_for(kTick);
  if (left_alone > 0) std::fprintf(out, "The server left samples of %zu phones unacknowledged.\n", left_alone);
  return left_alone == 0 && std::ranges::all_of(phones, [](const auto& phone) { return phone->samples_lost() == 0; });
}

}  // namespace

int survey(const World& world, const ServerAddress& server, const SurveyFleetSettings& settings, std::FILE* out) {
  NetworkLoop loop;
  const Propagation propagation(world, {});
  Random random(settings.seed);
  SurveyingSettings surveying;
  surveying.passes = settings.passes;
  surveying.at = UnixTime{std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch())};
  std::vector<SurveyBatch> batches;
  for (std::size_t i = 0; i < world.floors.size(); ++i) {
    const Floor& plan = world.floors[i].plan;
    auto floor_batches = survey_floor(world, propagation, plan.ordinal, surveyor_device(), surveying, random.split());
    std::move(floor_batches.begin(), floor_batches.end(), std::back_inserter(batches));
    std::fprintf(out, "%s  surveyed %s\n", progress_bar(static_cast<double>(i + 1) / static_cast<double>(world.floors.size() + 1)).c_str(),
                 plan.label.c_str());
    std::fflush(out);
  }
  return Upload(loop, server, settings.building, std::move(batches), random.bits(), out).run() ? 0 : 1;
}

int walk(const World& world, const ServerAddress& server, const WalkFleetSettings& settings, std::FILE* out) {
  NetworkLoop loop;
  ScaledScheduler clock(loop, settings.speed);
  const Propagation propagation(world, {});
  const Client::LinkFactory links = links_to(loop, server);
  const Duration length = from_seconds(60 * settings.minutes);
  Random random(settings.seed + 1);
  std::vector<Walker> walkers;
  walkers.reserve(static_cast<std::size_t>(settings.phones));
  for (int i = 0; i < settings.phones; ++i) walkers.emplace_back(world, GaitSettings{}, length, std::vector<FloorOrdinal>{}, random);
  std::vector<std::unique_ptr<TrackedPhone>> phones;
  for (const Walker& walker : walkers) phones.push_back(make_phone(world, propagation, walker, settings, links, clock, random.split()));

  const bool whole = live(loop, clock, phones, length, out);
  const bool won = print_summary(out, errors_of(phones), settings.compare);
  return won && whole ? 0 : 1;
}

int replay(const std::string& file, const ServerAddress& server, const WalkFleetSettings& settings, std::FILE* out) {
  auto recording = read_recording(file);
  if (!recording) throw std::invalid_argument(to_string(recording.fault()));
  NetworkLoop loop;
  ScaledScheduler clock(loop, settings.speed);
  auto feed = std::make_unique<RecordedPhone>(std::move(recording->header), std::move(recording->events), clock.now());
  const Duration length = feed->length();
  const std::size_t marks = feed->marks();
  TrackedPhoneSettings tracked;
  tracked.client = client_settings(Role::kTrack, settings.building);
  tracked.client.pipeline = settings.pipeline;
  tracked.compare = settings.compare;
  std::vector<std::unique_ptr<TrackedPhone>> phones;
  phones.push_back(std::make_unique<TrackedPhone>(std::move(feed), tracked, links_to(loop, server), clock, Random(settings.seed)));
  const bool whole = live(loop, clock, phones, length, out);
  std::fprintf(out, "\n%zu positions came", phones[0]->positions());
  if (phones[0]->fault()) std::fprintf(out, ", the newest fault: %s", to_string(*phones[0]->fault()).c_str());
  std::fprintf(out, "\n");
  if (marks == 0) {
    std::fprintf(out, "The recording holds no truth marks: there is nothing to compare with.\n");
  } else {
    print_errors(out, errors_of(phones), settings.compare);
  }
  return phones[0]->positions() > 0 && whole ? 0 : 1;
}

}  // namespace wayfuse::simulator
