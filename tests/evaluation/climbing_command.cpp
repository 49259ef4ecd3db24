#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "sdk/src/recording/import/attitude_trial.hpp"
#include "sdk/src/recording/import/recorded_walk.hpp"
#include "sdk/src/recording/import/step_trial.hpp"
#include "sdk/src/walking/walk_detector.hpp"
#include "tests/evaluation/commands.hpp"
#include "tests/evaluation/motion/walking_score.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kWindow = 8;          // steps, half a flight of stairs
constexpr double kOtherSwing = 0.25;        // stairs would have to differ by so much
constexpr double kSlower = 0.15;

/// What a tracker made of recordings in which nobody changes floors.
struct LevelGround {
  double hours = 0.0;
  int recordings = 0, rides_told = 0, rides_believed = 0;
  // Of each window of eight steps, against the recording's own median.
  std::vector<double> swing_ratio, cadence_ratio;
};

void count_rides(const std::vector<MargSample>& samples, LevelGround& sum) {
  MotionTracker tracker = std::move(MotionTracker::create({})).value();
  std::optional<LiftRide> newest;
  for (const MargSample& sample : samples) {
    tracker.feed(sample);
    const auto ride = tracker.walk().lift;
    if (ride && ride->under_way && !(newest && newest->under_way)) ++sum.rides_believed;
    if (ride && !ride->under_way && !(newest && newest->end == ride->end)) ++sum.rides_told;
    newest = ride;
  }
}

void compare_steps(const std::vector<MargSample>& samples, LevelGround& sum) {
  WalkDetector detector;
  std::vector<double> swings, cadences;
  std::optional<PhoneTime> last;
  for (const MargSample& sample : samples) {
    if (!sample.acceleration_mps2 || (last && sample.time <= *last)) continue;
    last = sample.time;
    const StepBatch batch = detector.feed(sample.time, *sample.acceleration_mps2);
    for (int i = 0; i < batch.count; ++i) {
      if (batch.steps[i].interval_s <= 0.0) continue;
      swings.push_back(batch.steps[i].swing_mps2);
      cadences.push_back(1.0 / batch.steps[i].interval_s);
    }
  }
  const double usual_swing = quantile(swings, 0.5), usual_cadence = quantile(cadences, 0.5);
  for (std::size_t i = 0; i + kWindow <= swings.size(); i += kWindow) {
    const auto mean = [&](const std::vector<double>& values) {
      double total = 0.0;
      for (std::size_t k = i; k < i + kWindow; ++k) total += values[k] / kWindow;
      return total;
    };
    sum.swing_ratio.push_back(mean(swings) / usual_swing);
    sum.cadence_ratio.push_back(mean(cadences) / usual_cadence);
  }
}

void take(const std::vector<MargSample>& samples, LevelGround& sum) {
  if (samples.empty()) return;
  ++sum.recordings;
  sum.hours += seconds(samples.back().time - samples.front().time) / 3600.0;
  count_rides(samples, sum);
  compare_steps(samples, sum);
}

// Every recording of one archive, read as its kind is.
using Reader = std::function<Result<std::vector<MargSample>>(const std::string&)>;
LevelGround measure(const std::vector<std::string>& paths, const Reader& read) {
  LevelGround sum;
  for (const std::string& path : paths) {
    const auto samples = read(path);
    if (samples) take(*samples, sum);
    else std::fprintf(stderr, "left out: %s\n", to_string(samples.fault()).c_str());
  }
  return sum;
}

std::vector<std::string> walks_below(const fs::path& folder) {
  std::vector<std::string> paths;
  if (!fs::is_directory(folder)) return paths;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".txt" && entry.path().parent_path().filename() == "path_data_files") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

nlohmann::json row_of(const std::string& name, const LevelGround& sum) {
  int other_swing = 0, slower = 0;
  for (const double ratio : sum.swing_ratio) other_swing += std::abs(ratio - 1.0) > kOtherSwing;
  for (const double ratio : sum.cadence_ratio) slower += ratio < 1.0 - kSlower;
  return {{"set", name}, {"recordings", sum.recordings}, {"hours", sum.hours}, {"lifts_told", sum.rides_told},
          {"lifts_believed", sum.rides_believed}, {"windows_of_steps", sum.swing_ratio.size()},
          {"swing_ratio_p5", quantile(sum.swing_ratio, 0.05)}, {"swing_ratio_p95", quantile(sum.swing_ratio, 0.95)},
          {"other_swing", other_swing}, {"slower", slower}};
}

void print(const nlohmann::json& row) {
  std::printf("%-12s %3d recordings, %.2f h: %d lift rides told, %d believed on the way; %d windows of 8 steps, swing p5..p95 %.2f..%.2f of the usual, "
              "%d off by a quarter, %d slower by 15 %%\n",
              row["set"].get<std::string>().c_str(), row["recordings"].get<int>(), row["hours"].get<double>(), row["lifts_told"].get<int>(),
              row["lifts_believed"].get<int>(), row["windows_of_steps"].get<int>(), row["swing_ratio_p5"].get<double>(),
              row["swing_ratio_p95"].get<double>(), row["other_swing"].get<int>(), row["slower"].get<int>());
}

int measure_climbing(const std::string& data, const std::string& json) {
  const auto trial = [](auto read) {
    return [read](const std::string& path) -> Result<std::vector<MargSample>> {
      auto recording = read(path);
      if (!recording) return recording.fault();
      return std::move(recording->samples);
    };
  };
  const Reader walk = [](const std::string& path) -> Result<std::vector<MargSample>> {
    auto recording = read_walk(path, {}, false);
    if (!recording) return recording.fault();
    return std::move(recording->motion);
  };
  const auto listed = [&](const char* set) {
    const fs::path folder = fs::path(data) / set;
    return fs::is_directory(folder) ? list_trials(folder) : std::vector<std::string>{};
  };
  const std::pair<const char*, LevelGround> sets[] = {
      {"broad", measure(listed("broad"), trial([](const std::string& path) { return read_broad_trial(path); }))},
      {"tyrex", measure(listed("tyrex"), trial([](const std::string& path) { return read_tyrex_trial(path, TyrexField::kCalibrated); }))},
      {"oxford-steps", measure(listed("oxford-steps"), trial([](const std::string& path) { return read_oxford_trial(path); }))},
      {"ilc20", measure(walks_below(fs::path(data) / "ilc20"), walk)}};
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& [name, sum] : sets) {
    if (sum.recordings == 0) continue;
    rows.push_back(row_of(name, sum));
    print(rows.back());
  }
  if (rows.empty()) {
    std::fprintf(stderr, "wayfuse-eval climbing: %s holds none of broad, tyrex, oxford-steps, ilc20\n", data.c_str());
    return 2;
  }
  if (json.empty()) return 0;
  std::ofstream out(json);
  out << nlohmann::json{{"rows", rows}}.dump(1) << "\n";
  return out ? 0 : 2;
}

}  // namespace

void add_climbing_command(CLI::App& app, std::function<int()>& chosen) {
  auto data = std::make_shared<std::string>(), json = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("climbing", "Lift rides told, and how steps vary, where nobody changes floors.");
  command->add_option("--data", *data, "folder the archives were unpacked into")->required()->check(CLI::ExistingDirectory);
  command->add_option("--json", *json, "write the rows here");
  command->callback([data, json, &chosen] { chosen = [data, json] { return measure_climbing(*data, *json); }; });
}

}  // namespace wayfuse
