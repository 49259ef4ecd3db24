#include "admin/maps_api.hpp"

#include <algorithm>
#include <charconv>

#include "admin/api.hpp"
#include "admin/map_forms.hpp"
#include "db/content_hash.hpp"

namespace wayfuse {
namespace {

constexpr std::uint64_t kMostPerPage = 1000;
constexpr std::size_t kNameBytes = 256;

Result<std::uint64_t> whole(const Request& request, const char* name, std::uint64_t standard, std::uint64_t least, std::uint64_t most) {
  const auto found = request.query.find(name);
  if (found == request.query.end()) return standard;
  std::uint64_t value = 0;
  const char* end = found->second.data() + found->second.size();
  const auto [stop, error] = std::from_chars(found->second.data(), end, value);
  if (error != std::errc{} || stop != end || value < least || value > most) {
    return Fault{FaultCode::kOutOfRange, name,
                 "'" + found->second + "' is no whole number in " + std::to_string(least) + ".." + std::to_string(most)};
  }
  return value;
}

struct Page {
  std::uint64_t after = 0;
  std::uint64_t most = 100;
};
Result<Page> page_of(const Request& request) {
  const auto after = whole(request, "after", 0, 0, INT64_MAX);
  if (!after) return after.fault();
  const auto most = whole(request, "most", 100, 1, kMostPerPage);
  if (!most) return most.fault();
  return Page{*after, *most};
}

/// One page of `all`, ascending by `key`, each spelled by `spell`.
template <typename List, typename Key, typename Spell>
std::string page_json(const List& all, const Page& page, Key key, Spell spell) {
  std::vector<std::string> items;
  std::uint64_t last = 0;
  bool more = false;
  for (const auto& entry : all) {
    if (std::invoke(key, entry) <= page.after) continue;
    if (items.size() == page.most) {
      more = true;
      break;
    }
    items.push_back(spell(entry));
    last = std::invoke(key, entry);
  }
  return items_json(items, more ? last : 0);
}

/// Answers with what `read` makes of the building's database.
void answer_from(DatabaseDirectory& databases, BuildingId id, Respond respond, int status,
                 std::function<Result<std::string>(BuildingDatabase&)> read) {
  databases.with_building(id, [respond = std::move(respond), status, read = std::move(read)](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    auto body = read(**database);
    respond(body ? json_response(status, *std::move(body)) : problem(body.fault()));
  });
}

Result<std::string> map_json(BuildingDatabase& database, const RadioMapRecord& map) {
  const auto live = database.live_map();
  if (!live) return live.fault();
  const auto measured = database.qualities(map.version);
  if (!measured) return measured.fault();
  return to_json(map, *live == map.version, *measured);
}

Result<std::string> one_map(BuildingDatabase& database, std::uint64_t version) {
  const auto maps = database.maps();
  if (!maps) return maps.fault();
  const auto map = std::ranges::find(*maps, version, &RadioMapRecord::version);
  if (map == maps->end()) return Fault{FaultCode::kNotFound, "version", "there is no radio map " + std::to_string(version)};
  return map_json(database, *map);
}

Result<std::string> list_maps(BuildingDatabase& database, const Page& page) {
  const auto maps = database.maps();
  if (!maps) return maps.fault();
  std::optional<Fault> fault;
  std::string body = page_json(*maps, page, &RadioMapRecord::version, [&](const RadioMapRecord& map) {
    auto json = map_json(database, map);
    if (!json) fault = json.fault();
    return json ? *std::move(json) : std::string();
  });
  if (fault) return *fault;
  return body;
}

void build_map(DatabaseDirectory& databases, MapControl& maps, BuildingId id, Respond respond) {
  maps.build_map(id, [&databases, id, respond](Result<std::uint64_t> version) {
    if (!version) return respond(problem(version.fault()));
    const std::string at = "/v1/buildings/" + std::to_string(id.value) + "/maps/" + std::to_string(*version);
    answer_from(databases, id, [respond, at](Response response) {
      if (response.status == 201) response.headers["location"] = at;
      respond(std::move(response));
    }, 201, [number = *version](BuildingDatabase& database) { return one_map(database, number); });
  });
}

void promote(MapControl& maps, BuildingId id, std::uint64_t version, const Request& request, Respond respond) {
  auto promotion = parse_promotion(request.body);
  if (!promotion) return respond(problem(promotion.fault()));
  promotion->version = version;
  promotion->by_key = request.key_id;
  maps.promote_map(id, *promotion, [respond](Result<MapPromoted> promoted) {
    if (!promoted) return respond(problem(promoted.fault()));
    if (promoted->publication) return respond(json_response(201, to_json(*promoted->publication)));
    // The gate's refusal carries what it rests on.
    std::string why;
    for (const std::string& reason : promoted->comparison.reasons) why += (why.empty() ? "" : "; ") + reason;
    Response refusal = problem({FaultCode::kConflict, "version", "it is worse than the live one: " + why + ". Give override and a reason to promote it all the same"});
    refusal.body.insert(refusal.body.rfind('}'), ",\"comparison\":" + to_json(promoted->comparison));
    respond(std::move(refusal));
  });
}

Result<std::string> name_of(const Request& request) {
  const auto given = request.query.find("name");
  const std::string name = given != request.query.end() ? given->second : "walk " + hex(sha256(request.body)).substr(0, 8);
  if (name.empty() || name.size() > kNameBytes) return Fault{FaultCode::kOutOfRange, "name", "must have 1 to 256 bytes"};
  if (std::ranges::any_of(name, [](unsigned char c) { return c < 0x20 || c == 0x7f; })) {
    return Fault{FaultCode::kBadText, "name", "holds control characters"};
  }
  return name;
}

void add_walk(DatabaseDirectory& databases, MapControl& maps, BuildingId id, const Request& request, Respond respond) {
  const auto name = name_of(request);
  if (!name) return respond(problem(name.fault()));
  const auto facts = maps.check_recording(request.body);
  if (!facts) return respond(problem(facts.fault()));
  answer_from(databases, id, std::move(respond), 201,
              [&maps, id, draft = QualityWalkDraft{*name, facts->device_model, facts->recorded_at, request.body}](BuildingDatabase& database) -> Result<std::string> {
                const auto added = database.add_quality_walk(draft);
                if (!added) return added.fault();
                maps.walks_changed(id);
                return to_json(*added);
              });
}

void remove_walk(DatabaseDirectory& databases, MapControl& maps, BuildingId id, std::uint64_t walk, Respond respond) {
  databases.with_building(id, [&maps, id, walk, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto removed = (*database)->remove_quality_walk(walk);
    if (removed) maps.walks_changed(id);
    respond(removed ? json_response(204, "") : problem(removed.fault()));
  });
}

/// A handler on the building and the number its path names.
Handler on_numbered(const char* name, std::function<void(BuildingId, std::uint64_t, const Request&, Respond)> handler) {
  return [name, handler = std::move(handler)](const Request& request, const PathValues& path, Respond respond) {
    const auto building = building_in(path);
    if (!building) return respond(problem(building.fault()));
    const auto number = id_in(path, name);
    if (!number) return respond(problem(number.fault()));
    handler(*building, *number, request, std::move(respond));
  };
}

/// A handler for a page of something read from the building's database.
Handler paged(DatabaseDirectory& databases, std::function<Result<std::string>(BuildingDatabase&, const Page&)> read) {
  return on_building([&databases, read = std::move(read)](BuildingId id, const Request& request, Respond respond) {
    const auto page = page_of(request);
    if (!page) return respond(problem(page.fault()));
    answer_from(databases, id, std::move(respond), 200, [read, page = *page](BuildingDatabase& database) { return read(database, page); });
  });
}

void add_version_routes(Router& router, DatabaseDirectory& databases, MapControl& maps) {
  router.add({"GET", "/v1/buildings/{building}/maps", Scope::kAdmin, "Radio maps as versions, with their measured quality",
              paged(databases, list_maps)});
  router.add({"POST", "/v1/buildings/{building}/maps", Scope::kAdmin, "Build a version from the survey as it stands and measure it",
              on_building([&](BuildingId id, const Request&, Respond respond) { build_map(databases, maps, id, std::move(respond)); })});
  router.add({"GET", "/v1/buildings/{building}/maps/publications", Scope::kAdmin, "Who put which version in force when, and why",
              paged(databases, [](BuildingDatabase& database, const Page& page) -> Result<std::string> {
                const auto publications = database.publications();
                if (!publications) return publications.fault();
                return page_json(*publications, page, &Publication::id, [](const Publication& entry) { return to_json(entry); });
              })});
  router.add({"POST", "/v1/buildings/{building}/maps/rollback", Scope::kAdmin, "Back to what was in force before",
              on_building([&](BuildingId id, const Request& request, Respond respond) {
                const auto reason = parse_reason(request.body);
                if (!reason) return respond(problem(reason.fault()));
                maps.roll_back_map(id, request.key_id, *reason, [respond](Result<Publication> back) {
                  respond(back ? json_response(201, to_json(*back)) : problem(back.fault()));
                });
              })});
  router.add({"GET", "/v1/buildings/{building}/maps/{version}", Scope::kAdmin, "One radio map",
              on_numbered("version", [&](BuildingId id, std::uint64_t version, const Request&, Respond respond) {
                answer_from(databases, id, std::move(respond), 200, [version](BuildingDatabase& database) { return one_map(database, version); });
              })});
  router.add({"GET", "/v1/buildings/{building}/maps/{version}/comparison", Scope::kAdmin, "A version against the live one, walk by walk",
              on_numbered("version", [&](BuildingId id, std::uint64_t version, const Request& request, Respond respond) {
                const auto pipeline = request.query.find("pipeline");
                maps.compare_map(id, version, pipeline == request.query.end() ? "" : pipeline->second, [respond](Result<MapComparisonView> comparison) {
                  respond(comparison ? json_response(200, to_json(*comparison)) : problem(comparison.fault()));
                });
              })});
  router.add({"POST", "/v1/buildings/{building}/maps/{version}/promotion", Scope::kAdmin, "Put a version in force, unless it is worse",
              on_numbered("version", [&](BuildingId id, std::uint64_t version, const Request& request, Respond respond) {
                promote(maps, id, version, request, std::move(respond));
              })});
}

}  // namespace

void add_map_routes(Router& router, DatabaseDirectory& databases, MapControl& maps) {
  add_version_routes(router, databases, maps);
  router.add({"GET", "/v1/buildings/{building}/quality-walks", Scope::kAdmin, "Recorded walks that maps are measured by",
              paged(databases, [](BuildingDatabase& database, const Page& page) -> Result<std::string> {
                const auto walks = database.quality_walks();
                if (!walks) return walks.fault();
                return page_json(*walks, page, &QualityWalkRecord::id, [](const QualityWalkRecord& walk) { return to_json(walk); });
              })});
  router.add({"POST", "/v1/buildings/{building}/quality-walks", Scope::kAdmin, "Add a recorded walk with its truth",
              on_building([&](BuildingId id, const Request& request, Respond respond) {
                add_walk(databases, maps, id, request, std::move(respond));
              })});
  router.add({"DELETE", "/v1/buildings/{building}/quality-walks/{walk}", Scope::kAdmin, "Remove a walk and what was measured by it",
              on_numbered("walk", [&](BuildingId id, std::uint64_t walk, const Request&, Respond respond) {
                remove_walk(databases, maps, id, walk, std::move(respond));
              })});
}

}  // namespace wayfuse
