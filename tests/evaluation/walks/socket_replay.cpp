#include "tests/evaluation/walks/socket_replay.hpp"

#include "db/database_directory.hpp"
#include "tests/evaluation/walks/server_process.hpp"
#include "tests/evaluation/walks/survey_upload.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"
#include "wayfuse/sdk/websocket_link.hpp"

namespace wayfuse {
namespace {

constexpr Duration kTurn = std::chrono::microseconds(500);
constexpr int kAnswerTurns = 20;     // after an acknowledgement, for the position behind it (none comes at rest)
constexpr int kTurnsMost = 120'000;  // a minute without an answer

// A client with its own loop and socket.
struct Phone {
  Phone(const ServerProcess& server, const ClientSettings& settings, ClientEvents events, std::uint64_t seed)
      : client(settings, std::move(events), links(server), loop, Random(seed)) {}

  Client::LinkFactory links(const ServerProcess& server) {
    WebsocketLinkSettings settings;
    settings.url = "ws://127.0.0.1:" + std::to_string(server.port()) + "/v1/session";
    settings.authorization = [key = server.admin_key()] { return "Bearer " + key; };
    auto made = loop.links(settings);
    if (!made) throw std::runtime_error(to_string(made.fault()));
    return *std::move(made);
  }

  NetworkLoop loop;
  Client client;
};

Result<BuildingId> make_building(const std::filesystem::path& folder, const BuildingRecord& record) {
  DatabaseDirectory::Options options;
  options.own_thread = false;
  auto store = DatabaseDirectory::open(folder, options);
  if (!store) return store.fault();
  Result<BuildingId> building = BuildingId{};
  (*store)->create_building(record, [&](Result<BuildingRecord> made) {
    if (made)
      building = made->id;
    else
      building = made.fault();
  });
  (*store)->close();
  return building;
}

}  // namespace

struct SocketReplay::Server {
  ScratchFolder folder;
  BuildingId building;
  std::optional<ServerProcess> process;

  Result<void> upload(const std::vector<RecordedWalk>& survey);
  Result<void> await_map(std::uint64_t version);
};

Result<void> SocketReplay::Server::upload(const std::vector<RecordedWalk>& survey) {
  std::optional<Fault> refused;
  std::uint64_t version = 0;
  ClientEvents events;
  events.fault = [&](const FaultReport& report) { refused = report.fault; };
  events.survey_stored = [&](const SurveyAck& ack) { version = std::max(version, ack.survey_version); };
  Phone phone(*process, phone_settings(Role::kSurvey, building, "surveyor"), events, 1);
  phone.client.start();
  const auto uploaded = upload_survey(phone.client, survey, refused, [&] { phone.loop.run_for(std::chrono::milliseconds(5)); });
  if (!uploaded) return uploaded;
  phone.client.stop();
  phone.loop.run_for(std::chrono::milliseconds(50));
  return await_map(version);
}

// The server builds its map beside the traffic: greet it until it has caught up with the survey.
Result<void> SocketReplay::Server::await_map(std::uint64_t version) {
  for (int greeting = 0; greeting < 600; ++greeting) {
    std::optional<std::uint64_t> has;
    ClientEvents events;
    events.welcomed = [&](const Welcome& welcome) { has = welcome.radio_map_version; };
    Phone phone(*process, phone_settings(Role::kTrack, building, "waiting"), events, 1);
    phone.client.start();
    for (int turn = 0; turn < 2000 && !has; ++turn) phone.loop.run_for(kTurn);
    phone.client.stop();
    phone.loop.run_for(std::chrono::milliseconds(100));
    if (has && *has >= version) return {};
  }
  return Fault{FaultCode::kTimeout, "survey", "the server never had a map of the whole survey"};
}

SocketReplay::SocketReplay(std::unique_ptr<Server> server) : server_(std::move(server)) {}
SocketReplay::~SocketReplay() = default;

Result<std::unique_ptr<SocketReplay>> SocketReplay::create(const std::string& program, const RecordedSite& site,
                                                           const std::vector<RecordedWalk>& survey) {
  auto server = std::make_unique<Server>();
  const auto building = make_building(server->folder.path(), record_of(site));
  if (!building) return building.fault();
  server->building = *building;
  auto process = ServerProcess::start(program, server->folder.path());
  if (!process) return process.fault();
  server->process.emplace(*std::move(process));
  if (const auto uploaded = server->upload(survey); !uploaded) return uploaded.fault();
  return std::unique_ptr<SocketReplay>(new SocketReplay(std::move(server)));
}

Result<WalkReply> SocketReplay::run(const RecordedWalk& walk, std::span<const Instant> instants, const std::string& pipeline,
                                    std::uint64_t seed) const {
  auto motion = MotionTracker::create({});
  if (!motion) return motion.fault();
  const PhoneTime begin = begin_of(walk);
  WalkReply reply;
  reply.at.resize(instants.size());
  std::optional<FusedPosition> newest;
  std::optional<Fault> fault;
  bool welcomed = false;
  std::uint64_t answered = 0;
  ClientEvents events;
  events.welcomed = [&](const Welcome& welcome) {
    welcomed = true;
    motion->expect(welcome.magnetic_field);
  };
  events.position = [&](const Position& position) {
    if (!newest) reply.first_fix_s = seconds(position.position.valid_at - begin);
    newest = position.position;
    answered = std::max(answered, position.applied_through);
  };
  events.fault = [&](const FaultReport& report) { fault = report.fault; };
  ClientSettings settings = phone_settings(Role::kTrack, server_->building, walk.device_model);
  settings.pipeline = pipeline;
  Phone phone(*server_->process, settings, events, seed);
  phone.client.start();
  const auto wait = [&](const auto& until, int most) {
    for (int turn = 0; turn < most && !fault && !until(); ++turn) phone.loop.run_for(kTurn);
    return until();
  };
  if (!wait([&] { return welcomed; }, kTurnsMost) && !fault)
    fault = Fault{FaultCode::kTimeout, "session", "the server never greeted"};

  const auto send = [&](SampleBody body) {
    if (const auto sent = phone.client.send(std::move(body)); !sent && !reply.leaves_out(sent.fault()) && !fault) fault = sent.fault();
  };
  PhoneEvents happening;
  happening.sample = [&](const MargSample& sample) {
    if (auto report = motion->feed(sample)) send(*std::move(report));
  };
  happening.scan = [&](const RssScan& scan) { send(scan); };
  happening.ask = [&](std::size_t i) {
    const std::uint64_t sent = phone.client.last_sequence();
    const bool applied = wait([&] { return phone.client.acked_through() >= sent; }, kTurnsMost);
    if (!applied && !fault) fault = Fault{FaultCode::kTimeout, "session", "samples were never acknowledged"};
    wait([&] { return answered >= sent; }, kAnswerTurns);
    reply.at[i] = newest;
  };
  play(walk, instants, happening);
  phone.client.stop();
  phone.loop.run_for(std::chrono::milliseconds(20));
  if (fault) return Fault{fault->code, walk.id + ": " + fault->field, fault->cause};
  return reply;
}

}  // namespace wayfuse
