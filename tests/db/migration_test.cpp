#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cerrno>
#include <fstream>

#include "db/database_directory.hpp"
#include "db/migrations.hpp"
#include "tests/db/faulty_disk.hpp"
#include "tests/db/survey_world.hpp"

namespace wayfuse {
namespace {

using namespace testing;  // NOLINT: FaultyDisk, sample_*

const std::filesystem::path kFixtures = std::filesystem::path(WAYFUSE_SOURCE_DIR) / "tests/db/fixtures";

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(in)), {});
}

std::int64_t number(const std::filesystem::path& file, const char* sql) {
  sqlite3* connection = nullptr;
  sqlite3_stmt* statement = nullptr;
  sqlite3_open_v2(file.c_str(), &connection, SQLITE_OPEN_READONLY, nullptr);
  sqlite3_prepare_v2(connection, sql, -1, &statement, nullptr);
  const std::int64_t value = sqlite3_step(statement) == SQLITE_ROW ? sqlite3_column_int64(statement, 0) : -1;
  sqlite3_finalize(statement);
  sqlite3_close(connection);
  return value;
}

void change(const std::filesystem::path& file, const std::string& sql) {
  sqlite3* connection = nullptr;
  sqlite3_open(file.c_str(), &connection);
  EXPECT_EQ(sqlite3_exec(connection, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(connection);
  sqlite3_close(connection);
}

// What make_fixture put into every version's building.
void expect_the_fixtures_survey(BuildingDatabase& database, const std::string& where) {
  EXPECT_EQ(database.building()->name, sample_building().name) << where;
  EXPECT_EQ(database.building()->floors, sample_building().floors) << where;
  EXPECT_EQ(database.building()->survey_version, 3u) << where;
  std::vector<ReferencePoint> sent;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const ReferencePoint& point : sample_batch(seed).points) sent.push_back(point);
  }
  std::vector<ReferencePoint> stored;
  const auto points = database.points({});
  ASSERT_TRUE(points) << where << ": " << to_string(points.fault());
  for (const StoredPoint& point : *points) stored.push_back(point.point);
  EXPECT_EQ(stored, sent) << where;
}

TEST(Migration, BringsABuildingOfEveryVersionToToday) {
  for (std::size_t version = 1; version <= building_migrations().size(); ++version) {
    const std::string name = "building-v" + std::to_string(version) + ".sqlite";
    const TemporaryFolder folder;
    ASSERT_TRUE(std::filesystem::copy_file(kFixtures / name, folder / "b.sqlite")) << "every version needs its fixture: " << name;
    ASSERT_EQ(number(folder / "b.sqlite", "PRAGMA user_version"), static_cast<std::int64_t>(version)) << name;
    {
      Result<BuildingDatabase> opened = BuildingDatabase::open(folder / "b.sqlite", {});
      ASSERT_TRUE(opened) << name << ": " << to_string(opened.fault());
      expect_the_fixtures_survey(*opened, name);
      EXPECT_TRUE(opened->store({sample_batch(4)}).at(0));
      EXPECT_TRUE(opened->zones());
    }
    EXPECT_EQ(number(folder / "b.sqlite", "PRAGMA user_version"), static_cast<std::int64_t>(building_migrations().size()));
    const std::filesystem::path copy = folder / ("b.sqlite.v" + std::to_string(version));
    const bool migrated = version < building_migrations().size();
    EXPECT_EQ(std::filesystem::exists(copy), migrated);
    EXPECT_TRUE(!migrated || number(copy, "SELECT count(*) FROM upload") == 3) << "the copy is as it was before";
  }
}

TEST(Migration, BringsAServerOfEveryVersionToToday) {
  for (std::size_t version = 1; version <= server_migrations().size(); ++version) {
    const std::string name = "server-v" + std::to_string(version) + ".sqlite";
    const TemporaryFolder folder;
    ASSERT_TRUE(std::filesystem::copy_file(kFixtures / name, folder / "server.sqlite")) << "every version needs its fixture: " << name;
    const auto directory = DatabaseDirectory::open(folder.path(), {});
    ASSERT_TRUE(directory) << to_string(directory.fault());
    const auto keys = (*directory)->keys();
    ASSERT_EQ(keys->size(), 2u);
    EXPECT_EQ(keys->at(0).keyed_hash, std::string(32, 'a'));
    EXPECT_TRUE(keys->at(1).revoked);
    EXPECT_EQ(keys->at(1).building.value, 7u);
    EXPECT_EQ((*directory)->server_secret()->size(), 32u);
  }
}

TEST(Migration, LeavesANewerFileAlone) {
  const TemporaryFolder folder;
  const std::string next = std::to_string(building_migrations().size() + 1);
  std::filesystem::create_directory(folder / "data");
  std::filesystem::copy_file(kFixtures / "building-v1.sqlite", folder / "data/building-7.sqlite");
  change(folder / "data/building-7.sqlite", "PRAGMA user_version = " + next);
  const std::string before = bytes_of(folder / "data/building-7.sqlite");
  const auto directory = DatabaseDirectory::open(folder / "data", {});
  ASSERT_TRUE(directory);
  ASSERT_EQ((*directory)->quarantined().size(), 1u);
  const Fault fault = (*directory)->quarantined()[0].second;
  EXPECT_EQ(fault.code, FaultCode::kStoreTooNew);
  EXPECT_THAT(fault.cause, ::testing::HasSubstr("version " + next));
  EXPECT_EQ(bytes_of(folder / "data/building-7.sqlite"), before);
}

TEST(Migration, RefusesAFileThatIsNotOurs) {
  const TemporaryFolder folder;
  change(folder / "foreign.sqlite", "CREATE TABLE t (x); PRAGMA user_version = 1");
  EXPECT_EQ(BuildingDatabase::open(folder / "foreign.sqlite", {}).fault().code, FaultCode::kStoreCorrupt);
  std::filesystem::copy_file(kFixtures / "server-v1.sqlite", folder / "server.sqlite");
  EXPECT_THAT(BuildingDatabase::open(folder / "server.sqlite", {}).fault().cause, ::testing::HasSubstr("not a wayfuse building database"));
  std::ofstream(folder / "text.sqlite") << std::string(4096, 'x');
  EXPECT_EQ(BuildingDatabase::open(folder / "text.sqlite", {}).fault().code, FaultCode::kStoreCorrupt);
  EXPECT_FALSE(BuildingDatabase::open(folder / "nowhere.sqlite", {}));
}

// The Nth change of the disk fails, or the power goes there, while a file migrates: it is old or new, and whole.
TEST(Migration, IsWholeWhereverItIsCut) {
  const std::string before = bytes_of(kFixtures / "building-v1.sqlite");
  const TemporaryFolder folder;
  const std::string file = folder / "b.sqlite";
  for (const bool power : {false, true}) {
    for (std::uint64_t nth = 1;; ++nth) {
      FaultyDisk disk;
      disk.place(file, before);
      const std::string where = (power ? "power cut at change " : "write fails: ") + std::to_string(nth);
      if (power) disk.cut_power_at(nth);
      if (!power) disk.fail({DiskCall::kWrite, nth, SQLITE_IOERR_WRITE, EIO, true});
      const bool migrated = BuildingDatabase::open(file, {.vfs = disk.name()}).has_value();
      const bool happened = power ? disk.power_is_cut() : disk.has_failed();
      disk.heal();
      Random luck(nth);
      if (power) disk.restore_power(luck);
      Result<BuildingDatabase> opened = BuildingDatabase::open(file, {.vfs = disk.name()});
      ASSERT_TRUE(opened) << where << ": " << to_string(opened.fault());
      expect_the_fixtures_survey(*opened, where);
      EXPECT_TRUE(opened->zones()) << where;
      if (migrated && !happened) break;
    }
  }
}

}  // namespace
}  // namespace wayfuse
