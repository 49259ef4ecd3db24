#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "wayfuse/sdk/recording.hpp"

namespace wayfuse::simulator {

/// A phone's callbacks in the order its operating system makes them, and where it really is. Thread: confined to its owner.
class PhoneFeed {
 public:
  virtual ~PhoneFeed() = default;
  /// The next callback; nothing when it is over.
  virtual std::optional<RecordedEvent> next() = 0;
  /// When that will be; at the end a time after the last one.
  virtual PhoneTime next_time() const = 0;
  /// Absent where nobody knows.
  virtual std::optional<Place> truth_at(PhoneTime time) const = 0;
  virtual const std::string& device_model() const = 0;
};

/// A recording lived through again, its time moved so that it begins at `start`.
///
/// Truth lies on the straight line between the marks around an instant if they are on one floor; before the first and after the last
/// mark nobody knows it.
class RecordedPhone final : public PhoneFeed {
 public:
  RecordedPhone(RecordingHeader header, std::vector<RecordedEvent> events, PhoneTime start);

  std::optional<RecordedEvent> next() override;
  PhoneTime next_time() const override;
  std::optional<Place> truth_at(PhoneTime time) const override;
  const std::string& device_model() const override { return header_.device_model; }
  Duration length() const;
  std::size_t marks() const { return marks_.size(); }

 private:
  RecordingHeader header_;
  std::vector<RecordedEvent> events_;   // ascending
  std::vector<TruthMark> marks_;        // ascending
  std::size_t next_ = 0;
};

/// Reads a whole recording; a fault names file and line.
struct WholeRecording {
  RecordingHeader header;
  std::vector<RecordedEvent> events;
};
Result<WholeRecording> read_recording(const std::string& path);

}  // namespace wayfuse::simulator
