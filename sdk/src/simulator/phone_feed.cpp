#include "sdk/src/simulator/phone_feed.hpp"

#include <algorithm>
#include <fstream>

namespace wayfuse::simulator {
namespace {

constexpr std::string_view kNoModel = "recorded";

}  // namespace

RecordedPhone::RecordedPhone(RecordingHeader header, std::vector<RecordedEvent> events, PhoneTime start)
    : header_(std::move(header)), events_(std::move(events)) {
  if (header_.device_model.empty()) header_.device_model = kNoModel;
  std::ranges::stable_sort(events_, {}, [](const RecordedEvent& event) { return time_of(event); });
  const Duration shift = events_.empty() ? Duration{0} : start - time_of(events_.front());
  for (RecordedEvent& event : events_) std::visit([shift](auto& body) { body.time += shift; }, event);
  for (const RecordedEvent& event : events_) {
    if (const auto* mark = std::get_if<TruthMark>(&event)) marks_.push_back(*mark);
  }
}

std::optional<RecordedEvent> RecordedPhone::next() {
  if (next_ == events_.size()) return std::nullopt;
  return events_[next_++];
}

PhoneTime RecordedPhone::next_time() const {
  if (next_ < events_.size()) return time_of(events_[next_]);
  return events_.empty() ? PhoneTime{} : time_of(events_.back());
}

Duration RecordedPhone::length() const {
  return events_.empty() ? Duration{0} : time_of(events_.back()) - time_of(events_.front());
}

std::optional<Place> RecordedPhone::truth_at(PhoneTime time) const {
  const auto after = std::ranges::lower_bound(marks_, time, {}, &TruthMark::time);
  if (after == marks_.end()) return std::nullopt;
  if (after->time == time) return after->place;
  if (after == marks_.begin()) return std::nullopt;
  const TruthMark &a = *(after - 1), &b = *after;
  if (a.place.floor != b.place.floor) return std::nullopt;
  const double share = seconds(time - a.time) / seconds(b.time - a.time);
  return Place{{a.place.point.x_m + share * (b.place.point.x_m - a.place.point.x_m),
                a.place.point.y_m + share * (b.place.point.y_m - a.place.point.y_m)},
               a.place.floor};
}

Result<WholeRecording> read_recording(const std::string& path) {
  std::ifstream in(path);
  if (!in) return Fault{FaultCode::kNotFound, path, "cannot be opened"};
  const auto in_file = [&](const Fault& fault) { return Fault{fault.code, path + ": " + fault.field, fault.cause}; };
  auto reader = RecordingReader::open(in);
  if (!reader) return in_file(reader.fault());
  WholeRecording whole{reader->header(), {}};
  while (true) {
    auto event = reader->next();
    if (!event) return in_file(event.fault());
    if (!*event) return whole;
    whole.events.push_back(**std::move(event));
  }
}

}  // namespace wayfuse::simulator
