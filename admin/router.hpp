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
};

/// Who is asking, once its key was found.
struct Principal {
  std::uint64_t key_id = 0;                ///< 0 = nobody
  std::string name;
  std::vector<Scope> scopes;
  BuildingId building;                     ///< 0 = all
  std::optional<UnixTime> expires_at;
  bool may(Scope scope, BuildingId on) const;
};

/// Finds the principal behind a bearer token, in constant time over the keys; kNotAuthenticated if there is none.
class Access {
 public:
  virtual ~Access() = default;
  virtual Result<Principal> principal_of(std::string_view bearer_token) const = 0;
};

/// Method and pattern to handler; checks the scope before the handler runs. Thread: any, immutable after set-up.
class Router {
 public:
  explicit Router(const Access& access) : access_(access) {}
  void add(Route route);
  void handle(const Request& request, Respond respond) const;
  std::span<const Route> routes() const { return routes_; }

 private:
  const Access& access_;
  std::vector<Route> routes_;
};

}  // namespace wayfuse
