#include "admin/router.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include "admin/bearer_token.hpp"

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

void Router::handle(const Request& request, Respond respond) const {
  const Route* route = nullptr;
  std::optional<PathValues> values;
  std::string methods;
  for (const Route& candidate : routes_) {
    auto matched = match(candidate.pattern, request.path);
    if (!matched) continue;
    if (candidate.method == request.method) {
      route = &candidate;
      values = std::move(matched);
      break;
    }
    methods += (methods.empty() ? "" : ", ") + candidate.method;
  }
  if (!route && methods.empty()) return respond(problem({FaultCode::kNotFound, "path", "there is nothing at this path"}));
  if (!route) {
    Response response = problem({FaultCode::kNotFound, "method", "this path answers " + methods}, 405);
    response.headers["Allow"] = methods;
    return respond(std::move(response));
  }
  if (route->scope == Scope::kPublic) return route->handler(request, *values, std::move(respond));
  const auto principal = access_.principal_of(bearer_token(request));
  if (!principal) return respond(problem(principal.fault()));
  const auto building = building_in(*values);
  if (!building) return respond(problem({FaultCode::kUnknownBuilding, "building", "there is no such building for this key"}));
  if (!principal->may(route->scope, {}) && !principal->may(route->scope, principal->building)) {
    return respond(problem({FaultCode::kNotAllowed, "", "the key's scope does not cover this"}));
  }
  if (!principal->may(route->scope, *building)) {
    // A key for one building: another one does not exist for it, and what speaks of all buildings is not its business.
    return respond(problem(building->value != 0
                               ? Fault{FaultCode::kUnknownBuilding, "building", "there is no such building for this key"}
                               : Fault{FaultCode::kNotAllowed, "", "the key covers one building only"}));
  }
  route->handler(request, *values, std::move(respond));
}

}  // namespace wayfuse
