#include "sdk/src/recording/import/attitude_trial.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>

#include "sdk/src/recording/import/text_line.hpp"

namespace wayfuse {
namespace {

namespace fs = std::filesystem;

bool is_nan(std::string_view field) {
  return field == "nan" || field == "NaN" || field == "NAN";
}

// Seconds as a time that is never rounded twice.
PhoneTime at_seconds(double value_s) {
  return PhoneTime(from_seconds(value_s));
}

// Four columns as a unit quaternion; `missing` where they are NaN. False = neither.
bool quaternion(const std::vector<std::string_view>& fields, std::size_t first, std::optional<Quaternion>& out) {
  out.reset();
  if (fields.size() < first + 4) return false;
  if (is_nan(fields[first])) return true;
  std::array<double, 4> q{};
  if (!numbers(fields, first, q)) return false;
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (norm < 0.5 || norm > 2.0) return false;
  out = Quaternion{q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm};
  return true;
}

// `t v0 v1 v2 ...` files; `take` gets the time and the values.
template <typename Take>
Result<void> read_series(const fs::path& path, std::size_t values, Take take) {
  auto file = TextFile::read(path.string());
  if (!file) return file.fault();
  std::vector<std::string_view> fields;
  std::array<double, 8> row{};
  while (const auto line = file->next_line()) {
    split(*line, ' ', fields);
    if (fields.empty()) continue;
    if (!numbers(fields, 0, std::span(row.data(), values + 1))) {
      return file->fault("a time and " + std::to_string(values) + " values expected");
    }
    take(row[0], row.data() + 1);
  }
  return {};
}

Result<double> read_offset(const fs::path& path) {
  auto file = TextFile::read(path.string());
  if (!file) return file.fault();
  const auto line = file->next_line();
  const auto offset_s = line ? number(*line) : std::nullopt;
  if (!offset_s) return file->fault("the time offset in seconds expected");
  return *offset_s;
}

Result<void> read_truth(const fs::path& path, double offset_s, AttitudeTrial& trial) {
  auto file = TextFile::read(path.string());
  if (!file) return file.fault();
  std::vector<std::string_view> fields;
  file->next_line();  // header
  while (const auto line = file->next_line()) {
    if (line->empty()) continue;
    split(*line, ',', fields);
    TrueAttitude truth;
    const auto time_s = number(fields[0]);
    if (!time_s || !quaternion(fields, 1, truth.body_to_enu)) return file->fault("t_s,qw,qx,qy,qz expected");
    truth.time = at_seconds(*time_s - offset_s);
    trial.truth.push_back(truth);
  }
  return {};
}

}  // namespace

Result<AttitudeTrial> read_broad_trial(const std::string& path) {
  auto file = TextFile::read(path);
  if (!file) return file.fault();
  AttitudeTrial trial;
  trial.name = fs::path(path).stem().string();
  const auto comment = file->next_line();
  constexpr std::string_view kRate = "sampling_rate_hz=";
  const std::size_t at = comment ? comment->find(kRate) : std::string_view::npos;
  if (at == std::string_view::npos) return file->fault("sampling_rate_hz=... expected");
  const std::string_view rest = comment->substr(at + kRate.size());
  const auto rate_hz = number(rest.substr(0, rest.find(' ')));
  if (!rate_hz || *rate_hz < 1.0 || *rate_hz > 100'000.0) return file->fault("the sampling rate is outside 1..100000 Hz");
  file->next_line();  // column names
  std::vector<std::string_view> fields;
  for (std::size_t row = 0; const auto line = file->next_line(); ++row) {
    if (line->empty()) continue;
    split(*line, ',', fields);
    std::array<double, 9> v{};
    TrueAttitude truth;
    if (fields.size() != 14 || !numbers(fields, 0, v) || !quaternion(fields, 9, truth.body_to_enu)) {
      return file->fault("gx,gy,gz,ax,ay,az,mx,my,mz,qw,qx,qy,qz,moving expected");
    }
    const PhoneTime time = at_seconds(static_cast<double>(row) / *rate_hz);
    truth.time = time;
    truth.counts = fields[13] == "1";
    MargSample sample;
    sample.time = time;
    sample.turn_rate_radps = Vector3{v[0], v[1], v[2]};
    sample.acceleration_mps2 = Vector3{v[3], v[4], v[5]};
    sample.field_ut = Vector3{v[6], v[7], v[8]};
    trial.samples.push_back(sample);
    trial.truth.push_back(truth);
  }
  return trial;
}

Result<AttitudeTrial> read_tyrex_trial(const std::string& folder, TyrexField field) {
  const fs::path root = folder;
  AttitudeTrial trial;
  trial.name = fs::path(root / "").parent_path().filename().string();
  const bool calibrated = field == TyrexField::kCalibrated;
  std::map<PhoneTime, MargSample> samples;
  const auto into = [&](std::optional<Vector3> MargSample::*which) {
    return [&samples, which](double time_s, const double* v) {
      MargSample& sample = samples[at_seconds(time_s)];
      sample.*which = Vector3{v[0], v[1], v[2]};
    };
  };
  const auto offset_s = read_offset(root / "timeAlignment.txt");
  if (!offset_s) return offset_s.fault();
  const auto chosen = [&](const std::string& sensor) {  // some phones record only one kind
    const fs::path raw = root / (sensor + ".txt"), tuned = root / (sensor + "-calibrated.txt");
    return (calibrated && fs::exists(tuned)) || !fs::exists(raw) ? tuned : raw;
  };
  if (const auto done = read_series(root / "accelerometer.txt", 3, into(&MargSample::acceleration_mps2)); !done)
    return done.fault();
  if (const auto done = read_series(chosen("gyroscope"), 3, into(&MargSample::turn_rate_radps)); !done) return done.fault();
  if (const auto done = read_series(chosen("magnetometer"), 3, into(&MargSample::field_ut)); !done) return done.fault();
  if (const auto done = read_truth(root / "truth.csv", *offset_s, trial); !done) return done.fault();
  if (fs::exists(root / "rotation-vector.txt")) {
    const auto done = read_series(root / "rotation-vector.txt", 4, [&](double time_s, const double* v) {
      trial.phone.push_back({at_seconds(time_s), {v[3], v[0], v[1], v[2]}});
    });
    if (!done) return done.fault();
  }
  for (auto& [time, sample] : samples) {
    sample.time = time;
    trial.samples.push_back(sample);
  }
  return trial;
}

std::vector<std::string> list_trials(const std::string& folder) {
  std::vector<std::string> trials;
  if (!fs::is_directory(folder)) return trials;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const bool csv = entry.is_regular_file() && entry.path().extension() == ".csv";
    if (csv || (entry.is_directory() && fs::exists(entry.path() / "truth.csv"))) trials.push_back(entry.path().string());
  }
  std::sort(trials.begin(), trials.end());
  return trials;
}

}  // namespace wayfuse
