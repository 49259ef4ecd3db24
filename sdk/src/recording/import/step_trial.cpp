#include "sdk/src/recording/import/step_trial.hpp"

#include <filesystem>

#include "sdk/src/recording/import/text_line.hpp"

namespace wayfuse {

Result<StepTrial> read_oxford_trial(const std::string& path) {
  auto file = TextFile::read(path);
  if (!file) return file.fault();
  StepTrial trial;
  trial.name = std::filesystem::path(path).stem().string();
  std::vector<std::string_view> fields;
  while (const auto line = file->next_line()) {
    if (line->empty()) continue;
    split(*line, ',', fields);
    const auto time_ns = whole_number(fields[0]);
    double axis[3];
    if (!time_ns || fields.size() < 7 || !numbers(fields, 1, axis))
      return file->fault("ns,ax,ay,az and three step counts expected");
    const auto steps = whole_number(fields[5]);
    const auto hardware = whole_number(fields[6]);
    if (!steps || !hardware) return file->fault("a step count is not a whole number");
    MargSample sample;
    sample.time = PhoneTime(Duration(*time_ns / 1000));
    sample.acceleration_mps2 = Vector3{axis[0], axis[1], axis[2]};
    trial.samples.push_back(sample);
    trial.true_steps.push_back(static_cast<int>(*steps));
    trial.hardware_steps.push_back(static_cast<int>(*hardware));
  }
  if (trial.samples.empty()) return Fault{FaultCode::kMalformed, path, "holds no sample"};
  return trial;
}

}  // namespace wayfuse
