#include "db/database_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <future>
#include <thread>

#include "tests/db/survey_world.hpp"

namespace wayfuse {
namespace {

using testing::sample_batch;
using testing::sample_building;
using testing::TemporaryFolder;

std::unique_ptr<DatabaseDirectory> opened(const TemporaryFolder& folder, bool own_thread = true) {
  DatabaseDirectory::Options options;
  options.own_thread = own_thread;
  auto directory = DatabaseDirectory::open(folder / "data", options);
  EXPECT_TRUE(directory) << to_string(directory.fault());
  return std::move(*directory);
}

Result<BuildingRecord> create(DatabaseDirectory& directory, BuildingRecord building) {
  std::promise<Result<BuildingRecord>> answer;
  directory.create_building(std::move(building), [&](Result<BuildingRecord> made) { answer.set_value(std::move(made)); });
  return answer.get_future().get();
}

Result<SurveyAck> store(DatabaseDirectory& directory, BuildingId id, SurveyBatch batch) {
  std::promise<Result<SurveyAck>> answer;
  directory.store(id, std::move(batch), [&](Result<SurveyAck> ack) { answer.set_value(std::move(ack)); });
  return answer.get_future().get();
}

Result<std::uint64_t> count(DatabaseDirectory& directory, BuildingId id) {
  std::promise<Result<std::uint64_t>> answer;
  directory.with_building(id, [&](Result<BuildingDatabase*> database) {
    answer.set_value(database ? (*database)->count_points() : Result<std::uint64_t>(database.fault()));
  });
  return answer.get_future().get();
}

TEST(DatabaseDirectory, KeepsBuildingsAndTheirPointsOverARestart) {
  const TemporaryFolder folder;
  {
    const auto directory = opened(folder);
    EXPECT_TRUE(directory->buildings().empty());
    ASSERT_TRUE(create(*directory, sample_building(12)));
    BuildingRecord unnumbered = sample_building(0);
    const auto made = create(*directory, unnumbered);
    ASSERT_TRUE(made) << to_string(made.fault());
    EXPECT_EQ(made->id.value, 13u);
    ASSERT_TRUE(store(*directory, {12}, sample_batch(1)));
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "data/building-12.sqlite"));
  const auto again = opened(folder);
  EXPECT_THAT(again->buildings(), ::testing::ElementsAre(BuildingId{12}, BuildingId{13}));
  EXPECT_EQ(count(*again, {12}).value(), 2u);
  EXPECT_EQ(count(*again, {13}).value(), 0u);
  EXPECT_EQ(store(*again, {12}, sample_batch(1)).value(), (SurveyAck{"batch-1", 2, 1}));
}

TEST(DatabaseDirectory, NamesTheFaultOfAnUnknownOrTakenNumber) {
  const TemporaryFolder folder;
  const auto directory = opened(folder);
  EXPECT_EQ(count(*directory, {5}).fault().code, FaultCode::kUnknownBuilding);
  EXPECT_EQ(store(*directory, {5}, sample_batch(1)).fault().code, FaultCode::kUnknownBuilding);
  ASSERT_TRUE(create(*directory, sample_building(5)));
  EXPECT_EQ(create(*directory, sample_building(5)).fault().code, FaultCode::kConflict);
}

TEST(DatabaseDirectory, ASecondServerIsToldWhoHasTheFolder) {
  const TemporaryFolder folder;
  const auto first = opened(folder);
  const auto second = DatabaseDirectory::open(folder / "data", {});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.fault().code, FaultCode::kStoreBusy);
  EXPECT_THAT(second.fault().cause, ::testing::HasSubstr("process " + std::to_string(::getpid())));
}

TEST(DatabaseDirectory, PutsACorruptBuildingAsideAndOpensTheRest) {
  const TemporaryFolder folder;
  {
    const auto directory = opened(folder);
    for (const std::uint64_t id : {1, 2, 3}) {
      ASSERT_TRUE(create(*directory, sample_building(id)));
      ASSERT_TRUE(store(*directory, {id}, sample_batch(id, 50)));
    }
  }
  const std::filesystem::path hurt = folder / "data/building-2.sqlite";
  {
    std::fstream file(hurt, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(3 * 4096);  // one page of noise in the middle
    for (int i = 0; i < 4096; ++i) file.put(static_cast<char>(i * 37));
  }
  const auto directory = opened(folder);
  EXPECT_THAT(directory->buildings(), ::testing::ElementsAre(BuildingId{1}, BuildingId{3}));
  ASSERT_EQ(directory->quarantined().size(), 1u);
  EXPECT_EQ(directory->quarantined()[0].first.value, 2u);
  EXPECT_EQ(directory->quarantined()[0].second.code, FaultCode::kStoreCorrupt);
  EXPECT_TRUE(std::filesystem::exists(hurt.string() + ".corrupt"));
  EXPECT_FALSE(std::filesystem::exists(hurt));
  EXPECT_EQ(store(*directory, {2}, sample_batch(9)).fault().code, FaultCode::kStoreCorrupt);
  EXPECT_TRUE(store(*directory, {3}, sample_batch(9)));
  EXPECT_EQ(create(*directory, sample_building(2)).fault().code, FaultCode::kConflict) << "its number is not free";
  EXPECT_EQ(create(*directory, sample_building(0))->id.value, 4u);
  directory->close();
}

TEST(DatabaseDirectory, PutsABuildingAsideThatBreaksWhileItRuns) {
  const TemporaryFolder folder;
  {
    const auto directory = opened(folder);
    ASSERT_TRUE(create(*directory, sample_building(1)));
    ASSERT_TRUE(store(*directory, {1}, sample_batch(1, 400, 400)));
  }
  const auto directory = opened(folder);  // quick_check passed; 9 MB do not fit SQLite's page cache of 2 MB
  {
    std::fstream file(folder / "data/building-1.sqlite", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(0, std::ios::end);
    const auto size = file.tellp();
    for (std::streamoff page = 2; page < size / 4096; ++page) {
      file.seekp(page * 4096);
      for (int i = 0; i < 16; ++i) file.put(static_cast<char>(0x5a));
    }
  }
  std::promise<Result<std::vector<StoredPoint>>> answer;
  directory->with_building({1}, [&](Result<BuildingDatabase*> database) { answer.set_value((*database)->points({})); });
  const auto points = answer.get_future().get();
  ASSERT_FALSE(points);
  EXPECT_EQ(points.fault().code, FaultCode::kStoreCorrupt);
  EXPECT_EQ(count(*directory, {1}).fault().code, FaultCode::kStoreCorrupt);
  EXPECT_TRUE(directory->buildings().empty());
  EXPECT_TRUE(std::filesystem::exists(folder / "data/building-1.sqlite.corrupt"));
}

TEST(DatabaseDirectory, RestoresABuildingFromItsBackup) {
  const TemporaryFolder folder;
  const auto directory = opened(folder);
  ASSERT_TRUE(create(*directory, sample_building(5)));
  ASSERT_TRUE(store(*directory, {5}, sample_batch(1)));
  const auto back_up = [&](const char* name) {
    std::promise<bool> done;
    directory->with_building({5}, [&](Result<BuildingDatabase*> b) { done.set_value((*b)->back_up_to(folder / name).has_value()); });
    return done.get_future().get();
  };
  const auto restore = [&](DatabaseDirectory& into, const std::string& name) {
    std::promise<Result<BuildingRecord>> done;
    into.restore_building(folder / name, [&](Result<BuildingRecord> r) { done.set_value(std::move(r)); });
    return done.get_future().get();
  };
  ASSERT_TRUE(back_up("five.sqlite"));
  EXPECT_EQ(restore(*directory, "five.sqlite").fault().code, FaultCode::kConflict) << "it is in use";
  EXPECT_FALSE(restore(*directory, "nothing.sqlite"));

  DatabaseDirectory::Options options;
  const auto other = std::move(*DatabaseDirectory::open(folder / "other", options));
  const auto restored = restore(*other, "five.sqlite");
  ASSERT_TRUE(restored) << to_string(restored.fault());
  EXPECT_EQ(restored->name, sample_building().name);
  EXPECT_EQ(count(*other, {5}).value(), 2u);
  EXPECT_TRUE(store(*other, {5}, sample_batch(2)));
  EXPECT_THAT(other->buildings(), ::testing::ElementsAre(BuildingId{5}));
  EXPECT_FALSE(std::filesystem::exists(folder / "other/restoring.sqlite"));

  std::fstream file(folder / "five.sqlite", std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(2 * 4096);
  file << std::string(4096, 'x');
  file.close();
  const auto third = std::move(*DatabaseDirectory::open(folder / "third", options));
  EXPECT_EQ(restore(*third, "five.sqlite").fault().code, FaultCode::kStoreCorrupt);
  EXPECT_TRUE(third->buildings().empty());
  EXPECT_FALSE(std::filesystem::exists(folder / "third/restoring.sqlite"));
}

TEST(DatabaseDirectory, ForgetsABuildingWhoseCreationNeverFinished) {
  const TemporaryFolder folder;
  opened(folder)->close();
  std::ofstream(folder / "data/building-4.sqlite").close();  // killed between making the file and its first commit
  const auto directory = opened(folder);
  EXPECT_TRUE(directory->buildings().empty());
  EXPECT_TRUE(directory->quarantined().empty());
  EXPECT_TRUE(create(*directory, sample_building(4)));
}

TEST(DatabaseDirectory, KeepsTheSecretAndTheKeys) {
  const TemporaryFolder folder;
  std::string secret;
  KeyRecord admin;
  admin.name = "first key";
  admin.keyed_hash = std::string(32, '\x17');
  admin.scopes = {"admin", "survey"};
  admin.created_at = UnixTime(std::chrono::seconds(1'700'000'000));
  KeyRecord phone = admin;
  phone.keyed_hash[0] = 0;
  phone.building = {4};
  phone.scopes = {"track"};
  phone.expires_at = UnixTime(std::chrono::seconds(1'800'000'000));
  {
    const auto directory = opened(folder);
    secret = directory->server_secret().value();
    EXPECT_EQ(secret.size(), 32u);
    EXPECT_TRUE(directory->keys()->empty());
    EXPECT_EQ(directory->add_key(admin)->id, 1u);
    EXPECT_EQ(directory->add_key(phone)->id, 2u);
    EXPECT_EQ(directory->add_key(phone).fault().code, FaultCode::kOutOfRange) << "the same hash twice";
    KeyRecord odd = admin;
    odd.keyed_hash[1] = 0;
    odd.scopes = {"root"};
    EXPECT_EQ(directory->add_key(odd).fault().code, FaultCode::kOutOfRange);
    EXPECT_TRUE(directory->revoke_key(1));
    EXPECT_EQ(directory->revoke_key(77).fault().code, FaultCode::kNotFound);
  }
  const auto directory = opened(folder);
  EXPECT_EQ(directory->server_secret().value(), secret);
  const auto keys = directory->keys();
  ASSERT_EQ(keys->size(), 2u);
  EXPECT_TRUE(keys->at(0).revoked);
  EXPECT_EQ(keys->at(0).scopes, admin.scopes);
  EXPECT_FALSE(keys->at(0).expires_at);
  EXPECT_EQ(keys->at(1).building.value, 4u);
  EXPECT_EQ(keys->at(1).keyed_hash, phone.keyed_hash);
  EXPECT_EQ(keys->at(1).expires_at, phone.expires_at);
  const auto perms = std::filesystem::status(folder / "data/server.sqlite").permissions();
  EXPECT_EQ(perms & (std::filesystem::perms::group_all | std::filesystem::perms::others_all), std::filesystem::perms::none);
}

TEST(DatabaseDirectory, KeepsTheAuditAndForgetsItByRetention) {
  const TemporaryFolder folder;
  const auto at = [](int second) { return UnixTime(std::chrono::seconds(1'700'000'000 + second)); };
  {
    const auto directory = opened(folder);
    std::atomic<int> durable{0}, refused{0};
    const auto note = [&](AuditRecord record) {
      directory->audit(std::move(record), [&](Result<void> done) { ++(done ? durable : refused); });
    };
    for (int i = 0; i < 40; ++i) note({0, at(i), 2u + i % 2, {7}, "observe", "floor " + std::to_string(i % 3)});
    note({0, at(40), 1, {}, "", "an action without a name"});
    note({0, at(41), 1, {}, "keys.revoke", "key 4"});
    directory->close();
    EXPECT_EQ(durable, 41);
    EXPECT_EQ(refused, 1) << "alone";
  }
  const auto directory = opened(folder);
  const std::vector<AuditRecord> all = directory->audited({}).value();
  ASSERT_EQ(all.size(), 41u);
  EXPECT_EQ(all.back().action, "keys.revoke");
  EXPECT_EQ(all.back().at, at(41));
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_GT(all[i].id, all[i - 1].id);
  EXPECT_EQ(directory->audited({.building = BuildingId{7}})->size(), 40u);
  EXPECT_EQ(directory->audited({.key_id = 3})->size(), 20u);
  EXPECT_EQ(directory->audited({.after_id = all[9].id, .most = 5})->front(), all[10]);
  EXPECT_EQ(directory->forget_audit(at(30)).value(), 30u);
  EXPECT_EQ(directory->audited({})->size(), 11u);
}

TEST(DatabaseDirectory, RemembersTheNewestBackupsAndVerificationsOfEachBuilding) {
  const TemporaryFolder folder;
  const auto at = [](int second) { return UnixTime(std::chrono::seconds(1'700'000'000 + second)); };
  using Kind = UpkeepRecord::Kind;
  {
    const auto directory = opened(folder);
    std::atomic<int> durable{0};
    const auto note = [&](UpkeepRecord record) {
      directory->note_upkeep(std::move(record), [&](Result<void> done) { durable += done.has_value(); });
    };
    note({{7}, Kind::kVerification, at(0), 2, 5, 0, "upload 'a': a bit has changed"});
    for (int i = 1; i <= 120; ++i) note({{7}, Kind::kBackup, at(i), 3, 5, 4096u * i, ""});
    note({{8}, Kind::kBackup, at(500), 3, 1, 4096, ""});
    directory->close();
    EXPECT_EQ(durable, 122);
  }
  const auto directory = opened(folder);
  const auto records = directory->upkeep({7}).value();
  ASSERT_EQ(records.size(), 101u) << "100 backups, and backups push no verification out";
  EXPECT_EQ(records.front(), (UpkeepRecord{{7}, Kind::kBackup, at(120), 3, 5, 4096u * 120, ""}));
  EXPECT_EQ(records[99].at, at(21));
  EXPECT_EQ(records.back().finding, "upload 'a': a bit has changed");
  EXPECT_EQ(directory->upkeep({8})->size(), 1u);
  EXPECT_TRUE(directory->upkeep({9})->empty());
}

TEST(DatabaseDirectory, CommitsWhatArrivesTogetherTogetherAndAnswersEachOnce) {
  const TemporaryFolder folder;
  const auto directory = opened(folder);
  for (const std::uint64_t id : {1, 2}) ASSERT_TRUE(create(*directory, sample_building(id)));
  constexpr int kClients = 8, kEach = 25;
  std::atomic<int> acked{0};
  std::vector<std::thread> clients;
  for (int c = 0; c < kClients; ++c) {
    clients.emplace_back([&, c] {
      for (int i = 0; i < kEach; ++i) {
        const auto seed = static_cast<std::uint64_t>(1000 * c + i + 1);
        if (store(*directory, {1 + seed % 2}, sample_batch(seed, 1))) ++acked;
        EXPECT_TRUE(i % 10 != 0 || count(*directory, {1}));
      }
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(acked, kClients * kEach);
  EXPECT_EQ(*count(*directory, {1}) + *count(*directory, {2}), static_cast<std::uint64_t>(kClients * kEach));
}

TEST(DatabaseDirectory, KeepsTheOrderOfUploadsAndReadsOfABuilding) {
  const TemporaryFolder folder;
  const auto directory = opened(folder);
  ASSERT_TRUE(create(*directory, sample_building(1)));
  std::vector<std::uint64_t> seen;  // touched on the writer thread only
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    directory->store({1}, sample_batch(seed, 1), [](Result<SurveyAck> ack) { EXPECT_TRUE(ack); });
    directory->with_building({1}, [&](Result<BuildingDatabase*> database) { seen.push_back((*database)->count_points().value()); });
  }
  directory->close();
  ASSERT_EQ(seen.size(), 30u);
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i], i + 1);
}

TEST(DatabaseDirectory, RefusesMoreThanItCanHoldWaiting) {
  const TemporaryFolder folder;
  DatabaseDirectory::Options options;
  options.most_waiting_points = 4;
  const auto directory = std::move(*DatabaseDirectory::open(folder / "data", options));
  ASSERT_TRUE(create(*directory, sample_building(1)));
  std::promise<void> busy, go;
  directory->with_building({1}, [&](Result<BuildingDatabase*>) {
    busy.set_value();
    go.get_future().wait();
  });
  busy.get_future().wait();
  std::vector<FaultCode> answers;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    directory->store({1}, sample_batch(seed, 2), [&](Result<SurveyAck> ack) { answers.push_back(ack ? FaultCode{} : ack.fault().code); });
  }
  go.set_value();
  directory->close();
  EXPECT_THAT(answers, ::testing::ElementsAre(FaultCode{}, FaultCode{}, FaultCode::kOverloaded));
}

TEST(DatabaseDirectory, AnswersThatItIsClosedInsteadOfHanging) {
  for (const bool own_thread : {true, false}) {
    const TemporaryFolder folder;
    const auto directory = opened(folder, own_thread);
    ASSERT_TRUE(create(*directory, sample_building(1)));
    directory->close();
    EXPECT_EQ(store(*directory, {1}, sample_batch(1)).fault().code, FaultCode::kDraining);
    EXPECT_EQ(count(*directory, {1}).fault().code, FaultCode::kDraining);
    EXPECT_EQ(create(*directory, sample_building(2)).fault().code, FaultCode::kDraining);
    EXPECT_EQ(directory->keys().fault().code, FaultCode::kDraining);
    std::promise<Result<void>> audited;
    directory->audit({.action = "late"}, [&](Result<void> done) { audited.set_value(std::move(done)); });
    EXPECT_EQ(audited.get_future().get().fault().code, FaultCode::kDraining);
    directory->close();
  }
}

TEST(DatabaseDirectory, RunsWithoutAThreadForTheSimulation) {
  const TemporaryFolder folder;
  const auto directory = opened(folder, false);
  bool made = false, acked = false;
  directory->create_building(sample_building(3), [&](Result<BuildingRecord> record) { made = record.has_value(); });
  EXPECT_TRUE(made);
  directory->store({3}, sample_batch(1), [&](Result<SurveyAck> ack) { acked = ack.has_value(); });
  EXPECT_TRUE(acked);
  EXPECT_EQ(directory->server_secret()->size(), 32u);
}

}  // namespace
}  // namespace wayfuse
