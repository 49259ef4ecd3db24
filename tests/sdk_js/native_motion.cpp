// Prints what the native motion core says of a recording, one line a report and one at the end, for comparison with JavaScript's.

#include <cstdio>
#include <fstream>

#include "wayfuse/sdk/motion_tracker.hpp"
#include "wayfuse/sdk/recording.hpp"

int main(int argc, char** argv) {
  using namespace wayfuse;
  std::ifstream in(argc > 1 ? argv[1] : "");
  auto reader = RecordingReader::open(in);
  if (!reader) return std::fprintf(stderr, "%s\n", to_string(reader.fault()).c_str()), 1;
  MotionTracker tracker = std::move(MotionTracker::create({})).value();
  while (true) {
    const auto event = reader->next();
    if (!event) return std::fprintf(stderr, "%s\n", to_string(event.fault()).c_str()), 1;
    if (!*event) break;
    const auto* sample = std::get_if<MargSample>(&**event);
    const auto report = sample ? tracker.feed(*sample) : std::nullopt;
    if (!report) continue;
    std::printf("[%lld,%u,%.17g,%.17g,%.17g,%.17g,%d]\n", static_cast<long long>(report->time.time_since_epoch().count()), report->steps,
                report->distance_m(), report->heading.radians(), report->heading_sigma_rad, report->turn_rate_radps, report->at_rest);
  }
  const Attitude attitude = tracker.attitude().value();
  const WalkState walk = tracker.walk();
  const Quaternion& q = attitude.body_to_enu;
  std::printf("[%.17g,%.17g,%.17g,%.17g,%llu,%.17g,%.17g]\n", q.w, q.x, q.y, q.z, static_cast<unsigned long long>(walk.steps),
              walk.cadence_hz, walk.speed_mps);
}
