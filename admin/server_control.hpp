#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "wayfuse/proto/fix.hpp"
#include "wayfuse/proto/part.hpp"
#include "wayfuse/proto/result.hpp"

namespace wayfuse {

/// A live session as the operator sees it; the name is the public one and resumes nothing.
struct SessionSummary {
  std::string tracked;
  BuildingId building;
  std::string device_model;
  std::string app;
  std::string pipeline;
  UnixTime since;
  bool connected = false;
  std::uint64_t applied_through = 0;
  std::optional<FusedPosition> position;
};

struct Readiness {
  bool ready = false;
  std::vector<std::string> reasons;  ///< why not
};

/// The window `admin` has on the running server; `server` implements it, so the arrow stays server -> admin.
///
/// Thread: any.
class ServerControl {
 public:
  virtual ~ServerControl() = default;
  virtual Readiness readiness() const = 0;
  virtual std::vector<SessionSummary> sessions(BuildingId building) const = 0;   ///< 0 = all
  /// Prometheus text exposition of every metric.
  virtual std::string metrics() const = 0;
  virtual std::vector<PartDescription> parts() const = 0;
  virtual std::vector<std::string> presets() const = 0;
  virtual Result<std::string> preset_json(const std::string& name) const = 0;
  /// A building was created or its description or survey changed: rebuild its snapshot off the callers' threads.
  virtual void building_changed(BuildingId building) = 0;
  /// A building was made or put back: `served` is called when its first snapshot is in force or could not be made, on any thread.
  virtual void building_made(BuildingId building, std::function<void()> served) = 0;
  /// Version of the snapshot in force; 0 = none.
  virtual std::uint64_t radio_map_version(BuildingId building) const = 0;
};

}  // namespace wayfuse
