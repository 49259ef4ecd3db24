// A whole server and its phones in one process, on a virtual clock and a seeded network [SAFETY R14, R15].
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/fixtures/scratch_folder.hpp"
#include "tests/locating/plan.hpp"
#include "tests/simulation/ledger.hpp"
#include "wayfuse/sdk/client.hpp"

namespace wayfuse {
namespace {

Plan hall() {
  return Plan({"A....B....C", "...........", "D....E....F"}, 4.0);
}

/// A phone that walks up and down the hall: a step every half second, a scan every two.
struct Phone {
  std::unique_ptr<Client> client;
  Random random{0};
  int ticks = 0;
  std::set<PhoneTime> sent;      ///< every sample has a stamp of its own
  std::set<std::uint64_t> lost;  ///< numbers the client reported as lost
  std::map<std::uint64_t, PhoneTime> stamp_of;
};

class Scenario {
 public:
  explicit Scenario(std::uint64_t seed) : random_(seed), network_(scheduler_, random_.bits(), ledger_) {
    start_server();
    hall_ = server_->add_building("Hall", random_.below(4) == 0 ? "p1" : "nn", hall().survey(1));
    annexe_ = server_->add_building("Annexe", "nn", hall().survey(1));
    network_.weather = {.connect_fails = 0.2 * random_.uniform(),
                        .slow_frame = 0.05 * random_.uniform(),
                        .delay_most = std::chrono::milliseconds(20 + random_.below(300)),
                        .slow_most = std::chrono::seconds(1 + random_.below(8)),
                        .life_mean = std::chrono::seconds(5 + random_.below(40)),
                        .unnoticed_most = std::chrono::seconds(random_.below(20))};
    for (std::size_t i = 0; i < phones_.size(); ++i) add_phone(phones_[i], i == 0 ? BuildingId{} : hall_);
    surveyor_ = make_client(Role::kSurvey, annexe_, {});
    ClientEvents watching;
    watching.observed = [this](const Observation& observation) {
      for (const Observed& observed : observation.tracked) seen_[observed.tracked] = observed.position;
    };
    observer_ = make_client(Role::kObserve, hall_, watching);
    EXPECT_TRUE(observer_->subscribe({}));
    crash_at_s_ = random_.below(3) == 0 ? static_cast<int>(10 + random_.below(40)) : -1;
  }

  void run() {
    scheduler_.after(Duration{0}, [this] { second(); });
    scheduler_.run_for(std::chrono::seconds(60));
    network_.weather = {};
    walking_ = false;
    scheduler_.run_for(std::chrono::seconds(150));
  }

  void check() {
    for (Phone& phone : phones_) check_nothing_is_missing(phone);
    check_trajectories();
    check_survey();
    check_observer();
    EXPECT_EQ(server_->counters().unsound_positions, 0u);
  }
  std::uint64_t hash() const { return ledger_.hash(); }
  const Ledger& ledger() const { return ledger_; }

 private:
  void start_server() {
    server_ = std::make_unique<SimulatedServer>(scheduler_, folder_.path(), random_.bits());
    network_.attach(server_.get());
  }

  void crash() {
    network_.attach(nullptr);
    network_.break_all();
    for (const BegunSession& begun : server_->begun()) begun_.push_back(begun);
    buildings_.push_back(server_->buildings().find(hall_));
    server_.reset();
    const auto down = std::chrono::seconds(random_.below(15));
    scheduler_.after(down, [this] { start_server(); });
  }

  std::unique_ptr<Client> make_client(Role role, BuildingId building, ClientEvents events) {
    ClientSettings settings;
    settings.role = role;
    settings.building = building;
    settings.token = [] { return std::string("key"); };
    settings.device_model = "Simulated";
    settings.app = "simulation/1";
    auto client = std::make_unique<Client>(
        settings, std::move(events), [this] { return network_.make_link(); }, scheduler_, Random(random_.bits()));
    client->start();
    return client;
  }

  void add_phone(Phone& phone, BuildingId building) {
    ClientEvents events;
    events.samples_lost = [&phone](std::uint64_t first, std::uint64_t last) {
      for (std::uint64_t number = first; number <= last; ++number) phone.lost.insert(number);
    };
    phone.random = Random(random_.bits());
    phone.client = make_client(Role::kTrack, building, std::move(events));
    scheduler_.after(Duration(static_cast<std::int64_t>(random_.below(500'000))), [this, &phone] { walk(phone); });
  }

  void walk(Phone& phone) {
    if (!walking_) return;
    const double x_m = 2.0 + std::abs(std::remainder(0.7 * ++phone.ticks, 72.0));
    MotionReport step;
    step.time = scheduler_.now();
    step.interval = std::chrono::milliseconds(500);
    step.heading = Heading::from_radians(0.2 * phone.random.normal());
    step.heading_sigma_rad = 0.2;
    step.reference = HeadingReference::kTrue;
    step.steps = 1;
    step.step_length_m = 0.7;
    step.distance_sigma_m = 0.1;
    send(phone, step);
    if (phone.ticks % 4 == 0) {
      RssScan scan = hall().scan_at({x_m, 4.0}, scheduler_.now() + Duration{1});
      for (ScanReading& reading : scan.readings) reading.age = Duration(static_cast<std::int64_t>(phone.random.below(300'000)));
      send(phone, scan);
    }
    scheduler_.after(std::chrono::milliseconds(500), [this, &phone] { walk(phone); });
  }

  void send(Phone& phone, SampleBody body) {
    const PhoneTime stamp = std::visit([](const auto& evidence) { return evidence.time; }, body);
    const auto taken = phone.client->send(std::move(body));
    ASSERT_TRUE(taken) << to_string(taken.fault());
    phone.sent.insert(stamp);
    phone.stamp_of[phone.client->last_sequence()] = stamp;
  }

  void second() {
    const auto now_s = ++seconds_;
    if (now_s == crash_at_s_) crash();
    if (server_) server_->sweep();
    network_.tick();
    if (walking_ && now_s % 5 == 0) upload(now_s);
    scheduler_.after(std::chrono::seconds(1), [this] { second(); });
  }

  void upload(int now_s) {
    SurveyBatch batch{"batch-" + std::to_string(now_s), {}};
    for (int i = 0; i < 3; ++i) {
      ReferencePoint point;
      point.place = {{static_cast<double>(i), 1.0}, {}};
      point.walk = batch.idempotency_key + "-" + std::to_string(i);
      point.device_model = "Simulated";
      point.scans = {hall().scan_at(point.place.point)};
      batch.points.push_back(std::move(point));
    }
    const auto taken = surveyor_->upload(batch);
    ASSERT_TRUE(taken) << to_string(taken.fault());
    uploaded_.insert({batch.points[0].walk, batch.points[1].walk, batch.points[2].walk});
  }

  // Every sample the application gave was applied by a server, or reported lost.
  void check_nothing_is_missing(Phone& phone) {
    EXPECT_EQ(phone.client->state(), ClientState::kStreaming);
    EXPECT_EQ(phone.client->acked_through(), phone.client->last_sequence());
    std::set<PhoneTime> missing = phone.sent;
    for (const auto& [name, session] : ledger_.sessions()) {
      for (const auto& [number, body] : session.samples) {
        if (number > session.acked) continue;
        missing.erase(std::visit([](const auto& evidence) { return evidence.time; }, body));
      }
    }
    for (const std::uint64_t number : phone.lost) missing.erase(phone.stamp_of.at(number));
    EXPECT_TRUE(missing.empty()) << missing.size() << " samples are neither applied nor reported lost";
    if (ledger_.not_recovered() == 0) {
      EXPECT_TRUE(phone.lost.empty());
    }
  }

  // R14: what the server said is, bit for bit, what one tracker says that was fed the same samples without any break.
  void check_trajectories() {
    for (const BegunSession& begun : server_->begun()) begun_.push_back(begun);
    buildings_.push_back(server_->buildings().find(hall_));
    std::size_t compared = 0;
    for (const BegunSession& begun : begun_) {
      const auto& session = ledger_.sessions().at(begun.name);
      if (session.building != hall_) continue;
      Random random(begun.seed);
      const auto tracker = buildings_.front()->pipeline("").value()->make_tracker(random.split());
      std::uint64_t fed = session.begins_after;
      std::optional<PhoneTime> newest;
      for (const Position& position : session.positions) {
        while (fed < position.applied_through) {
          const SampleBody& body = session.samples.at(++fed);
          std::visit([&](const auto& evidence) { tracker->feed(evidence); }, body);
          newest = std::visit([](const auto& evidence) { return evidence.time; }, body);
        }
        ASSERT_TRUE(newest);
        const auto expected = tracker->position(*newest);
        ASSERT_TRUE(expected && *expected == position.position) << begun.name << " after sample " << fed;
        ++compared;
      }
    }
    EXPECT_GT(compared, 20u);
  }

  void check_survey() {
    EXPECT_EQ(surveyor_->uploads_waiting(), 0u);
    std::multiset<std::string> stored;
    server_->store().with_building(annexe_, [&](Result<BuildingDatabase*> database) {
      const auto points = database.value()->points({});
      for (const StoredPoint& point : points.value()) {
        if (!point.point.walk.empty()) stored.insert(point.point.walk);
      }
    });
    EXPECT_EQ(stored, std::multiset<std::string>(uploaded_.begin(), uploaded_.end()));
  }

  void check_observer() {
    for (const SessionSummary& summary : server_->world().board.sessions(hall_)) {
      if (!summary.position) continue;
      ASSERT_TRUE(seen_.contains(summary.tracked));
      const FusedPosition& seen = seen_.at(summary.tracked);
      EXPECT_EQ(seen.valid_at, summary.position->valid_at);
      EXPECT_LT(distance_m(seen.place.point, summary.position->place.point), 0.001);  // JSON rounds
    }
  }

  Random random_;
  VirtualScheduler scheduler_;
  Ledger ledger_;
  SimulatedNetwork network_;
  ScratchFolder folder_;
  std::unique_ptr<SimulatedServer> server_;
  BuildingId hall_;
  BuildingId annexe_;
  std::array<Phone, 3> phones_;
  std::unique_ptr<Client> surveyor_;
  std::unique_ptr<Client> observer_;
  std::map<std::string, FusedPosition> seen_;
  std::set<std::string> uploaded_;
  std::vector<BegunSession> begun_;
  std::vector<std::shared_ptr<const Building>> buildings_;
  int seconds_ = 0;
  int crash_at_s_ = -1;
  bool walking_ = true;
};

std::uint64_t from_environment(const char* name, std::uint64_t standard) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : standard;
}

// WAYFUSE_SIM_SEEDS and WAYFUSE_SIM_FIRST choose more seeds, or the one that failed.
TEST(Simulation, NothingIsLostAndEverythingIsRepeatable) {
  const std::uint64_t first = from_environment("WAYFUSE_SIM_FIRST", 1);
  const std::uint64_t count = from_environment("WAYFUSE_SIM_SEEDS", 30);
  std::uint64_t recovered = 0;
  std::uint64_t not_recovered = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    SCOPED_TRACE("WAYFUSE_SIM_FIRST=" + std::to_string(seed) + " WAYFUSE_SIM_SEEDS=1");
    std::uint64_t hashes[2] = {};
    for (std::uint64_t& hash : hashes) {
      Scenario scenario(seed);
      scenario.run();
      scenario.check();
      hash = scenario.hash();
      recovered += scenario.ledger().recovered();
      not_recovered += scenario.ledger().not_recovered();
    }
    ASSERT_EQ(hashes[0], hashes[1]) << "the same seed went two ways";
    if (testing::Test::HasFailure()) return;
  }
  std::printf("%llu scenarios, each twice: %llu sessions resumed whole, %llu begun anew\n",
              static_cast<unsigned long long>(count), static_cast<unsigned long long>(recovered),
              static_cast<unsigned long long>(not_recovered));
  EXPECT_GT(recovered, 0u);
}

}  // namespace
}  // namespace wayfuse
