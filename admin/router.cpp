#include "admin/router.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include "admin/audit_trail.hpp"
#include "admin/bearer_token.hpp"
#include "admin/idempotency.hpp"

namespace wayfuse {
namespace {

std::vector<std::string_view> segments_of(std::string_view path) {
  std::vector<std::string_view> segments;
  while (!path.empty()) {
    path.remove_prefix(1);  // the slash
    const std::size_t end = std::min(path.find('/'), path.size());
    segments.push_back(path.substr(0, end));
    path.remove_prefix(end);
  }
  return segments;
}

std::optional<PathValues> match(std::string_view pattern, std::string_view path) {
  if (path.empty() || path.front() != '/') return std::nullopt;
  const auto wanted = segments_of(pattern);
  const auto given = segments_of(path);
  if (wanted.size() != given.size()) return std::nullopt;
  PathValues values;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i].size() > 2 && wanted[i].front() == '{') {
      if (given[i].empty()) return std::nullopt;
      values.emplace(wanted[i].substr(1, wanted[i].size() - 2), given[i]);
    } else if (wanted[i] != given[i]) {
      return std::nullopt;
    }
  }
  return values;
}

// The building a path speaks of; 0 = none. One that is not a number is nobody's building.
std::optional<BuildingId> building_in(const PathValues& values) {
  const auto found = values.find("building");
  if (found == values.end()) return BuildingId{};
  BuildingId id;
  const char* end = found->second.data() + found->second.size();
  const auto [rest, error] = std::from_chars(found->second.data(), end, id.value);
  if (error != std::errc() || rest != end || id.value == 0) return std::nullopt;
  return id;
}

}  // namespace

std::string_view bearer_token(const Request& request) {
  const auto found = request.headers.find("authorization");
  if (found == request.headers.end()) return {};
  const std::string_view value = found->second;
  constexpr std::string_view kScheme = "bearer ";
  const bool bearer = value.size() > kScheme.size() &&
                      std::ranges::equal(value.substr(0, kScheme.size()), kScheme,
                                         [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
  return bearer ? value.substr(kScheme.size()) : std::string_view();
}

bool Principal::may(Scope scope, BuildingId on) const {
  if (scope == Scope::kPublic) return true;
  const bool has = std::ranges::find(scopes, scope) != scopes.end();
  return has && (building.value == 0 || building == on);
}

void Router::add(Route route) {
  routes_.push_back(std::move(route));
}

Router::Found Router::find(const Request& request) const {
  Found found;
  for (const Route& candidate : routes_) {
    auto matched = match(candidate.pattern, request.path);
    if (!matched) continue;
    if (candidate.method == request.method) {
      found.route = &candidate;
      found.values = std::move(*matched);
      return found;
    }
    found.methods += (found.methods.empty() ? "" : ", ") + candidate.method;
  }
  return found;
}

Result<Principal> Router::admitted(const Route& route, const PathValues& values, const Request& request) const {
  auto principal = access_.principal_of(bearer_token(request));
  if (!principal) return principal.fault();
  const auto building = building_in(values);
  if (!building) return Fault{FaultCode::kUnknownBuilding, "building", "there is no such building for this key"};
  if (!principal->may(route.scope, {}) && !principal->may(route.scope, principal->building)) {
    return Fault{FaultCode::kNotAllowed, "", "the key's scope does not cover this"};
  }
  if (!principal->may(route.scope, *building)) {
    // A key for one building: another one does not exist for it, and what speaks of all buildings is not its business.
    if (building->value == 0) return Fault{FaultCode::kNotAllowed, "", "the key covers one building only"};
    return Fault{FaultCode::kUnknownBuilding, "building", "there is no such building for this key"};
  }
  if (principal->coarse && route.scope == Scope::kObserve && !route.coarse) {
    return Fault{FaultCode::kNotAllowed, "", "the key sees zones only"};
  }
  return principal;
}

void Router::handle(Request request, Respond respond) const {
  const Found found = find(request);
  if (!found.route && found.methods.empty()) {
    return respond(problem({FaultCode::kNotFound, "path", "there is nothing at this path"}));
  }
  if (!found.route) {
    Response response = problem({FaultCode::kNotFound, "method", "this path answers " + found.methods}, 405);
    response.headers["Allow"] = found.methods;
    return respond(std::move(response));
  }
  const Route& route = *found.route;
  if (route.scope == Scope::kPublic) return route.handler(request, found.values, std::move(respond));
  const auto principal = admitted(route, found.values, request);
  if (!principal) return respond(problem(principal.fault()));
  request.key_id = principal->key_id;
  request.coarse = principal->coarse;
  if (ledger_ && route.method == "POST") {
    auto once = ledger_->begin(request, std::move(respond));
    if (!once) return;
    respond = *std::move(once);
  }
  const bool changes = route.method != "GET" && route.scope == Scope::kAdmin;
  if (audit_ && (changes || route.shows_phones)) {
    respond = audit_->held_back(route, found.values, *principal, *building_in(found.values), std::move(respond));
  }
  route.handler(request, found.values, std::move(respond));
}

std::optional<std::size_t> Router::body_limit(const Request& header) const {
  const Found found = find(header);
  if (!found.route || found.route->body_bytes == 0) return std::nullopt;
  if (found.route->scope != Scope::kPublic && !admitted(*found.route, found.values, header)) return std::nullopt;
  return found.route->body_bytes;
}

}  // namespace wayfuse
