#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "admin/http.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/result.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

class AuditTrail;
class IdempotencyLedger;

/// What a key may do. A route must name one: there is no default [SAFETY C1].
enum class Scope : std::uint8_t { kPublic, kTrack, kSurvey, kObserve, kAdmin };

/// Path parameters by name: `/v1/buildings/{building}/points` -> building.
using PathValues = std::map<std::string, std::string>;
using Handler = std::function<void(const Request&, const PathValues&, Respond)>;

struct Route {
  std::string method;
  std::string pattern;
  Scope scope;
  std::string summary;
  Handler handler;
  bool shows_phones = false;       ///< where phones are: each read is written into the audit before it is answered [C19]
  bool coarse = false;             ///< open to observers that see zones only; such a handler looks at Request::coarse
  std::size_t body_bytes = 0;      ///< longest body it takes, from a key that may call it; 0 = the server's own limit
};

/// Who is asking, once its key was found.
struct Principal {
  std::uint64_t key_id = 0;                ///< 0 = nobody
  std::string name;
  std::vector<Scope> scopes;
  BuildingId building;                     ///< 0 = all
  std::optional<UnixTime> expires_at;
  bool coarse = false;                     ///< sees zones, never coordinates
  bool may(Scope scope, BuildingId on) const;
};

/// Finds the principal behind a bearer token, in constant time over the keys; kNotAuthenticated if there is none.
class Access {
 public:
  virtual ~Access() = default;
  virtual Result<Principal> principal_of(std::string_view bearer_token) const = 0;
};

/// Method and pattern to handler; checks the scope before the handler runs. What changes something, and what shows where
/// phones are, is in the audit before it is answered. Thread: any, immutable after set-up.
class Router {
 public:
  /// Without audit and ledger nothing is written down and no POST is known again: for tests of other things.
  explicit Router(const Access& access, AuditTrail* audit = nullptr, IdempotencyLedger* ledger = nullptr)
      : access_(access), audit_(audit), ledger_(ledger) {}
  void add(Route route);
  void handle(Request request, Respond respond) const;
  /// How long a body may be that is announced by this header: more than the usual only for who may send it.
  std::optional<std::size_t> body_limit(const Request& header) const;
  std::span<const Route> routes() const { return routes_; }

 private:
  struct Found {
    const Route* route = nullptr;
    PathValues values;
    std::string methods;               ///< others that this path answers
  };
  Found find(const Request& request) const;
  Result<Principal> admitted(const Route& route, const PathValues& values, const Request& request) const;

  const Access& access_;
  AuditTrail* const audit_;
  IdempotencyLedger* const ledger_;
  std::vector<Route> routes_;
};

}  // namespace wayfuse
