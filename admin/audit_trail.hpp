#pragma once

#include <map>
#include <mutex>
#include <string>

#include "admin/router.hpp"
#include "db/database_directory.hpp"

namespace wayfuse {

/// Writes down who changed or saw what: the key, the building, the route. Never a position, a token or a person [SAFETY C19].
///
/// Thread: any; one mutex, not held while calling out.
class AuditTrail {
 public:
  AuditTrail(DatabaseDirectory& store, const Clock& clock) : store_(store), clock_(clock) {}

  /// Queues the line now and lets the answer through once it is durable; a fault of the store is answered instead. Whatever
  /// the handler asks of the store comes behind the line.
  ///
  /// The same key reading the same thing again within a minute is not written again.
  Respond held_back(const Route& route, const PathValues& values, const Principal& who, BuildingId building, Respond respond);

 private:
  static constexpr Duration kOneReading = std::chrono::minutes(1);
  static constexpr std::size_t kRemembered = 4096;
  bool read_lately(const std::string& what);
  void was_read(const std::string& what);

  DatabaseDirectory& store_;
  const Clock& clock_;
  std::mutex mutex_;
  std::map<std::string, ServerTime> reads_;
};

}  // namespace wayfuse
