#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cerrno>
#include <optional>

#include "db/database_directory.hpp"
#include "tests/db/faulty_disk.hpp"
#include "tests/db/survey_world.hpp"

namespace wayfuse {
namespace {

using namespace testing;  // NOLINT: FaultyDisk, sample_*

constexpr std::uint64_t kBatches = 6;

// One client's work: make the building, then store batches; what it was told is its journal.
struct Journal {
  bool created = false;
  std::vector<std::uint64_t> acked;
  std::vector<std::uint64_t> unknown;
};

class Store {
 public:
  Store(const FaultyDisk& disk, const TemporaryFolder& folder) : file_(folder / "building-7.sqlite") {
    options_.vfs = disk.name();
    options_.checkpoint_pages = 8;  // so that many checkpoints fall into a short run
  }
  void synchronous_normal() { options_.synchronous_normal = true; }

  bool create() {
    std::filesystem::remove(file_);  // what an attempt that failed left, as the directory does
    Result<BuildingDatabase> made = BuildingDatabase::create(file_, sample_building(), options_);
    if (made) database_.emplace(std::move(*made));
    return made.has_value();
  }
  Result<void> open() {
    Result<BuildingDatabase> opened = BuildingDatabase::open(file_, options_);
    if (!opened) return opened.fault();
    database_.emplace(std::move(*opened));
    return {};
  }
  void close() { database_.reset(); }
  bool is_open() const { return database_.has_value(); }
  BuildingDatabase& database() { return *database_; }

  void store(std::uint64_t seed, Journal& journal) {
    const Result<SurveyAck> ack = database_->store({sample_batch(seed)}).at(0);
    (ack ? journal.acked : journal.unknown).push_back(seed);
    EXPECT_TRUE(ack || ack.fault().code != FaultCode::kInternal);
  }

  std::vector<ReferencePoint> points() {
    std::vector<ReferencePoint> points;
    const auto page = database_->points({.floor = {}, .after_id = 0, .most = 100'000});
    if (!page) ADD_FAILURE() << to_string(page.fault());
    if (page) {
      for (const StoredPoint& stored : *page) points.push_back(stored.point);
    }
    return points;
  }

 private:
  std::filesystem::path file_;
  BuildingDatabase::OpenOptions options_;
  std::optional<BuildingDatabase> database_;
};

// The points a batch put there, found among all: how often does the whole batch stand there?
int times_present(const std::vector<ReferencePoint>& points, std::uint64_t seed) {
  const SurveyBatch batch = sample_batch(seed);
  std::size_t found = 0;
  for (const ReferencePoint& point : points) {
    for (const ReferencePoint& sent : batch.points) found += point == sent;
  }
  EXPECT_EQ(found % batch.points.size(), 0u) << "batch " << seed << " is there in part";
  return static_cast<int>(found / batch.points.size());
}

// The whole life: create, store, close, open again (a checkpoint each way), store more.
Journal live(Store& store) {
  Journal journal;
  journal.created = store.create();
  if (!journal.created) return journal;
  for (std::uint64_t seed = 1; seed <= kBatches; ++seed) {
    if (seed == kBatches / 2) {
      store.close();
      if (!store.open()) return journal;
    }
    store.store(seed, journal);
  }
  return journal;
}

void expect_nothing_lost(Store& store, const Journal& journal, int unknown_least, std::string_view where) {
  const std::vector<ReferencePoint> points = store.points();
  for (const std::uint64_t seed : journal.acked) EXPECT_EQ(times_present(points, seed), 1) << where << ": acked batch " << seed;
  for (const std::uint64_t seed : journal.unknown) {
    const int times = times_present(points, seed);
    EXPECT_TRUE(times >= unknown_least && times <= 1) << where << ": unknown batch " << seed << " is there " << times << " times";
  }
}

// After the fault: mend, retry what is unknown under the same keys, cut the power, look.
void recover_and_check(FaultyDisk& disk, Store& store, Journal journal, std::uint64_t luck_seed, const std::string& where) {
  disk.heal();
  if (!journal.created) {
    ASSERT_TRUE(store.create()) << where;
    journal.created = true;
  }
  if (!store.is_open()) {
    const Result<void> opened = store.open();
    ASSERT_TRUE(opened) << where << ": " << to_string(opened.fault());
  }
  expect_nothing_lost(store, journal, 0, where);
  for (const std::uint64_t seed : std::exchange(journal.unknown, {})) store.store(seed, journal);
  EXPECT_THAT(journal.unknown, ::testing::IsEmpty()) << where << ": a mended disk must take it without a restart";
  disk.cut_power_at(1);
  store.close();
  Random luck(luck_seed);
  disk.restore_power(luck);
  const Result<void> opened = store.open();
  ASSERT_TRUE(opened) << where << ": " << to_string(opened.fault());
  expect_nothing_lost(store, journal, 1, where + ", after a power cut");
}

struct Code {
  const char* name;
  int sqlite;
  int system;
};

class EveryCallFails : public ::testing::TestWithParam<std::tuple<DiskCall, bool>> {};

// R6: the Nth call of each kind fails, for N = 1.. until a whole life passes without reaching the Nth.
TEST_P(EveryCallFails, NothingIsLostOrFalselyAcknowledged) {
  const auto [call, sticks] = GetParam();
  static constexpr Code codes[] = {{"IOERR", SQLITE_IOERR, EIO}, {"FULL", SQLITE_FULL, 0}, {"ENOSPC", SQLITE_IOERR_WRITE, ENOSPC}};
  const TemporaryFolder folder;
  for (const Code& code : codes) {
    for (std::uint64_t nth = 1;; ++nth) {
      FaultyDisk disk;
      Store store(disk, folder);
      disk.fail({call, nth, code.sqlite, code.system, sticks});
      const Journal journal = live(store);
      const std::string where = std::string(name_of(call)) + " " + std::to_string(nth) + " answers " + code.name;
      if (!disk.has_failed()) {
        EXPECT_GT(nth, 1u) << where << ": never happened";
        EXPECT_EQ(journal.acked.size(), kBatches) << where;
        break;
      }
      recover_and_check(disk, store, journal, nth, where);
      if (HasFatalFailure() || HasNonfatalFailure()) return;
    }
  }
}

std::string parameter_name(const ::testing::TestParamInfo<std::tuple<DiskCall, bool>>& info) {
  std::string name(name_of(std::get<0>(info.param)));
  std::replace(name.begin(), name.end(), ' ', '_');
  return name + (std::get<1>(info.param) ? "_from_then_on" : "_once");
}

INSTANTIATE_TEST_SUITE_P(Disk, EveryCallFails,
                         ::testing::Combine(::testing::Values(DiskCall::kOpen, DiskCall::kRead, DiskCall::kWrite, DiskCall::kSync,
                                                              DiskCall::kTruncate, DiskCall::kDelete, DiskCall::kAccess,
                                                              DiskCall::kFileSize, DiskCall::kLock, DiskCall::kShmMap,
                                                              DiskCall::kShmLock),
                                            ::testing::Bool()),
                         parameter_name);

TEST(FullDisk, IsNamedAndUsedAgainOnceThereIsRoom) {
  FaultyDisk disk;
  const TemporaryFolder folder;
  Store store(disk, folder);
  ASSERT_TRUE(store.create());
  for (const Code& code : {Code{"FULL", SQLITE_FULL, 0}, Code{"ENOSPC", SQLITE_IOERR_WRITE, ENOSPC},
                           Code{"quota", SQLITE_IOERR_WRITE, EDQUOT}, Code{"read-only", SQLITE_READONLY, 0},
                           Code{"remounted read-only", SQLITE_IOERR_WRITE, EROFS}}) {
    disk.fail({DiskCall::kWrite, 1, code.sqlite, code.system, true});
    const auto answers = store.database().store({sample_batch(1), sample_batch(2)});
    for (const auto& answer : answers) {
      ASSERT_FALSE(answer) << code.name;
      EXPECT_EQ(answer.fault().code, FaultCode::kStorageFull) << code.name << ": " << to_string(answer.fault());
    }
    disk.heal();
    EXPECT_EQ(store.database().count_points().value(), 0u) << code.name;
  }
  EXPECT_TRUE(store.database().store({sample_batch(1)}).at(0));
}

// A whole folder on the faulty disk, without a thread: its databases live there, their empty stand-ins in the real folder.
std::unique_ptr<DatabaseDirectory> open_folder(const FaultyDisk& disk, const TemporaryFolder& folder) {
  DatabaseDirectory::Options options;
  options.vfs = disk.name();
  options.own_thread = false;
  auto directory = DatabaseDirectory::open(folder.path(), options);
  EXPECT_TRUE(directory) << to_string(directory.fault());
  return directory ? std::move(*directory) : nullptr;
}

KeyRecord sample_key(char hash) {
  KeyRecord key;
  key.name = "a key";
  key.keyed_hash = std::string(32, hash);
  key.scopes = {"survey"};
  return key;
}

TEST(FullDisk, AtStartABuildingWaitsUntilThereIsRoom) {
  FaultyDisk disk;
  const TemporaryFolder folder;
  auto directory = open_folder(disk, folder);
  directory->create_building(sample_building(7), [](Result<BuildingRecord> made) { ASSERT_TRUE(made); });
  directory->store({7}, sample_batch(1), [](Result<SurveyAck> ack) { ASSERT_TRUE(ack); });
  directory->close();
  directory.reset();
  // The server's own file opens; every open after it finds the disk full, and so does the building's.
  const std::uint64_t before = disk.calls(DiskCall::kOpen);
  directory = open_folder(disk, folder);
  const std::uint64_t all = disk.calls(DiskCall::kOpen) - before;
  directory->close();
  directory.reset();
  disk.fail({DiskCall::kOpen, all, SQLITE_CANTOPEN, ENOSPC, true});
  directory = open_folder(disk, folder);
  ASSERT_TRUE(disk.has_failed());
  const auto count = [&] {
    Result<std::uint64_t> points = Fault{};
    directory->with_building({7}, [&](Result<BuildingDatabase*> b) { points = b ? (*b)->count_points() : Result<std::uint64_t>(b.fault()); });
    return points;
  };
  ASSERT_EQ(directory->quarantined().size(), 1u);
  EXPECT_EQ(directory->quarantined()[0].second.code, FaultCode::kStorageFull);
  EXPECT_EQ(count().fault().code, FaultCode::kStorageFull);
  directory->create_building(sample_building(7), [](Result<BuildingRecord> made) { EXPECT_EQ(made.fault().code, FaultCode::kConflict); });
  disk.heal();
  EXPECT_EQ(count().value(), 2u) << "without a restart";
  EXPECT_TRUE(directory->quarantined().empty());
  EXPECT_EQ(directory->buildings().size(), 1u);
}

TEST(PowerCut, AtAnyChangeLeavesKeysAndAuditAsAcknowledged) {
  for (std::uint64_t nth = 1;; ++nth) {
    FaultyDisk disk;
    const TemporaryFolder folder;
    auto directory = open_folder(disk, folder);
    const std::string secret = directory->server_secret().value();
    disk.cut_power_at(nth);
    const bool first = directory->add_key(sample_key('a')).has_value();
    const bool second = directory->add_key(sample_key('b')).has_value();
    const bool revoked = directory->revoke_key(1).has_value();
    bool audited = false;
    directory->audit({.action = "keys.revoke", .subject = "key 1"}, [&](Result<void> done) { audited = done.has_value(); });
    directory->close();
    directory.reset();
    const bool cut = disk.power_is_cut();
    Random luck(nth);
    disk.restore_power(luck);
    directory = open_folder(disk, folder);
    ASSERT_NE(directory, nullptr) << nth;
    EXPECT_EQ(directory->server_secret().value(), secret) << nth;
    const std::vector<KeyRecord> keys = directory->keys().value();
    EXPECT_GE(keys.size(), static_cast<std::size_t>(first + second)) << nth;
    EXPECT_TRUE(!revoked || keys.at(0).revoked) << "a revocation came undone, change " << nth;
    EXPECT_GE(directory->audited({})->size(), audited ? 1u : 0u) << nth;
    if (!cut) break;
  }
}

}  // namespace
}  // namespace wayfuse
