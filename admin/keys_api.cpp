#include <algorithm>

#include "admin/api.hpp"
#include "admin/json_forms.hpp"
#include "admin/query_values.hpp"

namespace wayfuse {
namespace {

void make_key(KeyRing& keys, const Clock& clock, const Request& request, Respond respond) {
  const auto wanted = parse_key(request.body, clock.wall_now());
  if (!wanted) return respond(problem(wanted.fault()));
  std::vector<Scope> scopes;
  for (const std::string& name : wanted->scopes) scopes.push_back(*scope_of(name));
  const auto issued = keys.issue(wanted->name, scopes, wanted->building, wanted->expires_at, wanted->coarse);
  if (!issued) return respond(problem(issued.fault()));
  Response response = json_response(201, to_json(issued->record, issued->key));
  response.headers["cache-control"] = "no-store";
  respond(std::move(response));
}

void list_keys(const KeyRing& keys, const Request& request, Respond respond) {
  const auto page = page_asked_in(request);
  if (!page) return respond(problem(page.fault()));
  std::vector<KeyRecord> known = keys.keys();
  std::ranges::sort(known, {}, &KeyRecord::id);
  const std::uint64_t next = cut_to(*page, known, [](const KeyRecord& key) { return key.id; });
  respond(json_response(200, to_json(known, next)));
}

void revoke_key(KeyRing& keys, const PathValues& path, Respond respond) {
  const auto id = id_in(path, "key");
  if (!id) return respond(problem(id.fault()));
  const auto revoked = keys.revoke(*id);
  respond(revoked ? json_response(204, "") : problem(revoked.fault()));
}

}  // namespace

void add_key_routes(Router& router, KeyRing& keys, const Clock& clock) {
  router.add({"GET", "/v1/keys", Scope::kAdmin, "API keys, without the keys themselves",
              [&](const Request& request, const PathValues&, Respond respond) { list_keys(keys, request, std::move(respond)); }});
  router.add({"POST", "/v1/keys", Scope::kAdmin, "Make a key; its secret is shown this once",
              [&](const Request& request, const PathValues&, Respond respond) { make_key(keys, clock, request, std::move(respond)); }});
  router.add({"DELETE", "/v1/keys/{key}", Scope::kAdmin, "Revoke a key",
              [&](const Request&, const PathValues& path, Respond respond) { revoke_key(keys, path, std::move(respond)); }});
}

}  // namespace wayfuse
