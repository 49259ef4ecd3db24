#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "wayfuse/sdk/client.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"
#include "wayfuse/sdk/position_now.hpp"
#include "wayfuse/sdk/scan_planner.hpp"
#include "wayfuse/sdk/surveyor.hpp"
#include "wayfuse/sdk/websocket_link.hpp"

namespace wayfuse {

struct PhoneSettings {
  ClientSettings client;
  WebsocketLinkSettings link;
  MotionTrackerSettings motion;
  ScanPlatform platform = ScanPlatform::kUnlimited;
  std::uint64_t seed = 0;  ///< 0 = from the system
};

/// What the application is told, on the phone's thread.
struct PhoneEvents {
  std::function<void(const FusedPosition&)> position;
  std::function<void(ClientState)> state_changed;
  std::function<void(const Fault&)> fault;
  std::function<void(std::string_view)> disconnected;
  std::function<void(std::uint64_t, std::uint64_t)> samples_lost;
  std::function<void(const SurveyAck&)> survey_stored;
};

/// A whole phone behind one object: sensors in, position out, its own thread. The C interface is a thin skin over this.
///
/// Thread: every function from any thread. Client and link live on the phone's thread; motion, live position and survey state
/// stand behind one mutex, which is never held while the application is called.
class Phone {
 public:
  static Result<std::unique_ptr<Phone>> create(PhoneSettings settings, PhoneEvents events);
  /// Says goodbye, lets the farewell leave, ends the thread. Not from inside an event.
  ~Phone();

  Result<void> start();
  Result<void> stop();
  Result<void> network_changed();
  ClientState state() const { return state_; }
  bool is_recorded() const { return is_recorded_; }  ///< as the server said last
  bool on_own_thread() const { return std::this_thread::get_id() == thread_.get_id(); }

  Result<void> feed(const MargSample& sample);
  Result<void> feed(const RssScan& scan);
  Result<void> feed(const GnssFix& fix);
  std::optional<LivePosition> position_now();
  MotionCalibration calibration();
  ScanAdvice next_scan();
  void scan_started();

  Result<void> begin_walk(std::string name);
  Result<void> mark(PhoneTime time, Place place, double sigma_m);
  Result<void> end_walk();
  Result<void> begin_point(Place place, double sigma_m);
  Result<void> end_point();
  std::size_t uploads_waiting() const { return uploads_waiting_; }

 private:
  struct StandingPoint {
    Place place;
    double sigma_m = 0.0;
    std::vector<RssScan> scans;
  };
  Phone(PhoneSettings settings, PhoneEvents events, MotionTracker motion);
  ClientEvents client_events();
  /// On the phone's thread. Refuses when too much waits already.
  Result<void> post(std::function<void()> task);
  Result<void> survey_scan(const RssScan& scan);
  Result<void> upload_batches();

  PhoneSettings settings_;
  PhoneEvents events_;
  NetworkLoop loop_;
  std::unique_ptr<Client> client_;
  std::atomic<ClientState> state_{ClientState::kIdle};
  std::atomic<bool> is_recorded_{false};
  std::atomic<int> posted_{0};
  std::atomic<std::size_t> uploads_waiting_{0};

  std::mutex mutex_;  // of what follows
  MotionTracker motion_;
  PositionNow position_;
  ScanPlanner scans_;
  Surveyor surveyor_;
  bool walking_ = false;
  std::optional<StandingPoint> standing_;

  std::thread thread_;  // last: it uses all of the above
};

}  // namespace wayfuse
