#include <nlohmann/json.hpp>

#include "server/recordings/recording_desk.hpp"
#include "wayfuse/sdk/recording.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kPortion = 256u << 10;

const char* name_of(HeadingReference reference) {
  switch (reference) {
    case HeadingReference::kTrue: return "true";
    case HeadingReference::kMagnetic: return "magnetic";
    case HeadingReference::kArbitrary: return "arbitrary";
  }
  return "arbitrary";
}

Json to_json(const MotionReport& motion) {
  Json line{{"type", "motion"},
            {"time_us", motion.time.time_since_epoch().count()},
            {"interval_us", motion.interval.count()},
            {"heading_rad", motion.heading.radians()},
            {"heading_sigma_rad", motion.heading_sigma_rad},
            {"reference", name_of(motion.reference)},
            {"turn_rate_radps", motion.turn_rate_radps},
            {"steps", motion.steps},
            {"step_length_m", motion.step_length_m},
            {"distance_sigma_m", motion.distance_sigma_m},
            {"at_rest", motion.at_rest}};
  if (motion.speed_mps) line["speed_mps"] = *motion.speed_mps;
  if (motion.turning) line["turning"] = true;
  if (motion.climb_m) line["climb_m"] = *motion.climb_m;
  if (motion.field_horizontal_ut) line["field_horizontal_ut"] = *motion.field_horizontal_ut;
  if (motion.field_vertical_ut) line["field_vertical_ut"] = *motion.field_vertical_ut;
  return line;
}

// A phone's motion is the one thing that its own recordings do not hold.
std::string line_of(const MotionReport& motion, std::uint64_t sequence) {
  Json line = to_json(motion);
  line["sequence"] = sequence;
  return line.dump() + "\n";
}
std::string line_of(const RecordedEvent& event, std::uint64_t sequence) { return recording_line(event, sequence); }

class RecordingLines final : public BodySource {
 public:
  RecordingLines(std::string header, TapePieces pieces) : header_(std::move(header)), pieces_(std::move(pieces)) {}

  std::optional<std::string> next() override {
    std::string portion = std::move(header_);
    header_.clear();
    while (piece_ < pieces_.size() && portion.size() < kPortion) {
      const auto& entries = pieces_[piece_]->entries;
      if (entry_ == entries.size()) {
        ++piece_, entry_ = 0;
        continue;
      }
      if (const auto* sample = std::get_if<Sample>(&entries[entry_++])) {
        portion += std::visit([&](const auto& body) { return line_of(body, sample->sequence); }, sample->body);
      }
    }
    return portion.empty() ? std::nullopt : std::optional(std::move(portion));
  }
  void on_ready(std::function<void()>) override {}  // it is all here

 private:
  std::string header_;
  const TapePieces pieces_;
  std::size_t piece_ = 0;
  std::size_t entry_ = 0;
};

}  // namespace

std::shared_ptr<BodySource> recording_lines(const RecordingSummary& summary, const std::string& building, TapePieces pieces) {
  const Json header{{"type", "wayfuse-recording"},
                    {"version", 1},
                    {"device_model", summary.device_model},
                    {"app", summary.app},
                    {"building", building},
                    {"started_at_us", summary.begun_at.time_since_epoch().count()},
                    {"tracked", summary.tracked},
                    {"pipeline", summary.pipeline},
                    {"radio_map_version", summary.first_map},
                    {"seed", std::to_string(summary.seed)},
                    {"epoch", std::to_string(summary.epoch)},
                    {"from_the_start", summary.from_the_start}};
  return std::make_shared<RecordingLines>(header.dump() + "\n", std::move(pieces));
}

}  // namespace wayfuse
