#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "db/building_database.hpp"
#include "tests/db/survey_world.hpp"

// What a durable commit costs beside a bare fsync on the same disk in the same minute, and how fast readings go in bulk beside the
// plain way of a row each.
namespace wayfuse::testing {
namespace {

double seconds_of(std::chrono::steady_clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

// One standing point as a phone sends it: one scan of 30 access points.
SurveyBatch one_point(std::uint64_t seed) {
  Random random(seed);
  return {"point-" + std::to_string(seed), {sample_point(random, 1, 30)}};
}

// Alternates with the baseline, so that a busy disk is busy for both.
void store_durable_commit(benchmark::State& state) {
  const TemporaryFolder folder;
  auto database = BuildingDatabase::create(folder / "building-7.sqlite", sample_building(), {});
  const int raw = ::open((folder / "raw").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  const std::string page(4096, 'w');
  std::vector<double> commit_s, fsync_s;
  std::uint64_t seed = 0;
  for (auto _ : state) {
    const SurveyBatch batch = one_point(++seed);
    const auto begin = std::chrono::steady_clock::now();
    if (!database->store({batch}).at(0)) state.SkipWithError("not stored");
    const auto between = std::chrono::steady_clock::now();
    if (::write(raw, page.data(), page.size()) < 0 || ::fsync(raw) != 0) state.SkipWithError("no fsync");
    fsync_s.push_back(seconds_of(std::chrono::steady_clock::now() - between));
    commit_s.push_back(seconds_of(between - begin));
    state.SetIterationTime(commit_s.back());
  }
  ::close(raw);
  state.counters["raw_fsync_us"] = median(fsync_s) * 1e6;
  state.counters["commit_us"] = median(commit_s) * 1e6;
  state.counters["ratio"] = median(commit_s) / median(fsync_s);
}
BENCHMARK(store_durable_commit)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(600);

std::vector<SurveyBatch> bulk(std::uint64_t first_seed, std::size_t batches) {
  std::vector<SurveyBatch> group;
  for (std::uint64_t seed = first_seed; seed < first_seed + batches; ++seed) {
    Random random(seed);
    SurveyBatch& batch = group.emplace_back();
    batch.idempotency_key = "bulk-" + std::to_string(seed);
    for (int p = 0; p < 256; ++p) batch.points.push_back(sample_point(random, 1, 30));
  }
  return group;
}

constexpr std::size_t kBatches = 40;  // 10,240 points, 307,200 readings a round

void report_rows(benchmark::State& state, const std::filesystem::path& file, std::uint64_t rounds) {
  const double readings = static_cast<double>(rounds * kBatches * 256 * 30);
  state.counters["readings_per_s"] = benchmark::Counter(readings, benchmark::Counter::kIsRate);
  state.counters["bytes_a_reading"] = static_cast<double>(std::filesystem::file_size(file)) / readings;
}

// Ends with the log folded into the file, as an import does.
void store_bulk(benchmark::State& state) {
  const TemporaryFolder folder;
  std::uint64_t rounds = 0;
  {
    auto database = BuildingDatabase::create(folder / "building-7.sqlite", sample_building(), {});
    for (auto _ : state) {
      state.PauseTiming();
      const std::vector<SurveyBatch> batches = bulk(++rounds * 1000, kBatches);
      state.ResumeTiming();
      if (state.range(0) == 1) {
        for (const Result<SurveyAck>& ack : database->store(batches)) {
          if (!ack) state.SkipWithError("not stored");
        }
        continue;
      }
      for (const SurveyBatch& batch : batches) {
        if (!database->store({batch}).at(0)) state.SkipWithError("not stored");
      }
    }
  }
  report_rows(state, folder / "building-7.sqlite", rounds);
}
// Commits a round: 1 = an import in one group, 40 = uploads of 256 points each.
BENCHMARK(store_bulk)->ArgName("commits")->Arg(1)->Arg(kBatches)->Unit(benchmark::kMillisecond)->MinTime(2)->UseRealTime();

// The plain way: prepared statements, a commit a batch, a row a reading; no hash, no transmitter counts.
void store_bulk_a_row_a_reading(benchmark::State& state) {
  const TemporaryFolder folder;
  const std::string file = folder / "rows.sqlite";
  sqlite3* connection = nullptr;
  sqlite3_open(file.c_str(), &connection);
  sqlite3_exec(connection,
               "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; CREATE TABLE point (id INTEGER PRIMARY KEY, x REAL, y REAL, floor INTEGER);"
               "CREATE TABLE reading (point INTEGER NOT NULL, bssid INTEGER NOT NULL, rss REAL, age INTEGER, frequency INTEGER, range REAL);"
               "CREATE INDEX reading_of_point ON reading (point)",
               nullptr, nullptr, nullptr);
  sqlite3_stmt *point = nullptr, *reading = nullptr;
  sqlite3_prepare_v2(connection, "INSERT INTO point (x, y, floor) VALUES (?, ?, ?)", -1, &point, nullptr);
  sqlite3_prepare_v2(connection, "INSERT INTO reading VALUES (?, ?, ?, ?, ?, ?)", -1, &reading, nullptr);
  std::uint64_t rounds = 0;
  const auto insert = [&](const ReferencePoint& from) {
    sqlite3_bind_double(point, 1, from.place.point.x_m);
    sqlite3_bind_double(point, 2, from.place.point.y_m);
    sqlite3_bind_int(point, 3, from.place.floor.value);
    sqlite3_step(point);
    sqlite3_reset(point);
    const sqlite3_int64 id = sqlite3_last_insert_rowid(connection);
    for (const ScanReading& heard : from.scans[0].readings) {
      sqlite3_bind_int64(reading, 1, id);
      sqlite3_bind_int64(reading, 2, static_cast<sqlite3_int64>(heard.bssid.value));
      sqlite3_bind_double(reading, 3, heard.rss_dbm);
      sqlite3_bind_int64(reading, 4, heard.age.count());
      sqlite3_bind_int(reading, 5, heard.frequency_mhz);
      if (heard.range_m) sqlite3_bind_double(reading, 6, *heard.range_m);
      if (!heard.range_m) sqlite3_bind_null(reading, 6);
      sqlite3_step(reading);
      sqlite3_reset(reading);
    }
  };
  for (auto _ : state) {
    state.PauseTiming();
    const std::vector<SurveyBatch> batches = bulk(++rounds * 1000, kBatches);
    state.ResumeTiming();
    for (const SurveyBatch& batch : batches) {
      if (&batch == &batches.front() || state.range(0) != 1) sqlite3_exec(connection, "BEGIN", nullptr, nullptr, nullptr);
      for (const ReferencePoint& from : batch.points) insert(from);
      if (&batch == &batches.back() || state.range(0) != 1) sqlite3_exec(connection, "COMMIT", nullptr, nullptr, nullptr);
    }
  }
  sqlite3_finalize(point);
  sqlite3_finalize(reading);
  sqlite3_close(connection);
  report_rows(state, file, rounds);
}
BENCHMARK(store_bulk_a_row_a_reading)->ArgName("commits")->Arg(1)->Arg(kBatches)->Unit(benchmark::kMillisecond)->MinTime(2)->UseRealTime();

void store_read_whole_survey(benchmark::State& state) {
  const TemporaryFolder folder;
  auto database = BuildingDatabase::create(folder / "building-7.sqlite", sample_building(), {});
  for (const SurveyBatch& batch : bulk(1, kBatches)) benchmark::DoNotOptimize(database->store({batch}));
  for (auto _ : state) {
    const auto points = database->points({.floor = {}, .after_id = 0, .most = 1'000'000});
    if (!points || points->size() != kBatches * 256) state.SkipWithError("not read");
  }
  state.counters["readings_per_s"] =
      benchmark::Counter(static_cast<double>(kBatches * 256 * 30), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(store_read_whole_survey)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace wayfuse::testing
