#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sdk/src/simulator/phone_feed.hpp"
#include "wayfuse/proto/message.hpp"
#include "wayfuse/sdk/client.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"

namespace wayfuse::simulator {

/// Horizontal errors of one way of positioning, metres, and how often the floor was right.
class ErrorLog {
 public:
  void add(const Place& estimate, const Place& truth);
  std::size_t count() const { return errors_m_.size(); }
  double last_m() const { return errors_m_.empty() ? 0.0 : errors_m_.back(); }
  double mean_m() const;
  double percentile_m(double share) const;
  double floor_share() const;
  void append(const ErrorLog& other);

 private:
  std::vector<double> errors_m_;
  std::size_t floors_right_ = 0;
};

struct TrackedPhoneSettings {
  ClientSettings client;             ///< of the fused session
  bool compare = true;               ///< also open a Wi-Fi-only session and reckon from the true start
};

/// A phone with the SDK in it: lives through its feed, streams, and compares what comes back with where it really is, where
/// that is known.
///
/// Three ways side by side on the same evidence: fused (the building's pipeline), Wi-Fi alone (a session with the `wknn`
/// preset), dead reckoning alone (from the first true place, in the frame the server tells). Thread: the link's.
class TrackedPhone {
 public:
  TrackedPhone(std::unique_ptr<PhoneFeed> feed, TrackedPhoneSettings settings, Client::LinkFactory links, Scheduler& scheduler,
               Random random);

  void start();
  /// Lives through everything up to `now`; false when the walk is over.
  bool advance(PhoneTime now);
  void stop();
  bool all_acknowledged() const;
  /// Nothing more is to be waited for: everything sent was acknowledged, or the session ended.
  bool settled() const;

  const ErrorLog& fused() const { return fused_; }
  const ErrorLog& wifi_alone() const { return wifi_alone_; }
  const ErrorLog& reckoned() const { return reckoned_log_; }
  const std::optional<FusedPosition>& position() const { return position_; }
  const std::optional<Fault>& fault() const { return fault_; }
  const std::string& device_model() const { return feed_->device_model(); }
  std::uint64_t samples_lost() const { return samples_lost_; }
  /// Fused positions that came, also where nobody knows the truth.
  std::size_t positions() const { return positions_; }

 private:
  ClientEvents events_into(ErrorLog& log, bool main);
  void live_through(const RecordedEvent& event);
  void reckon();

  std::unique_ptr<PhoneFeed> feed_;
  MotionTracker motion_;
  std::unique_ptr<Client> main_;
  std::unique_ptr<Client> wifi_client_;
  std::optional<Welcome> welcome_;
  std::vector<MotionReport> unreckoned_;   // until the server told how its frame lies
  std::optional<Place> reckoned_;
  ErrorLog fused_, wifi_alone_, reckoned_log_;
  std::optional<FusedPosition> position_;
  std::optional<Fault> fault_;
  std::uint64_t samples_lost_ = 0;
  std::size_t positions_ = 0;
};

}  // namespace wayfuse::simulator
