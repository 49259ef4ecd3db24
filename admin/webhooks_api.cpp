#include <sodium.h>

#include <algorithm>

#include "admin/api.hpp"
#include "admin/conditional.hpp"
#include "admin/query_values.hpp"
#include "admin/webhook_forms.hpp"

namespace wayfuse {
namespace {

constexpr std::size_t kMostWebhooks = 100;
constexpr std::size_t kSecretBytes = 32;

struct WebhookRooms {
  DatabaseDirectory& databases;
  WebhookControl& webhooks;
  const Clock& clock;
};

Result<WebhookRecord> webhook_in(BuildingDatabase& database, std::uint64_t id) {
  auto webhooks = database.webhooks();
  if (!webhooks) return webhooks.fault();
  const auto found = std::ranges::find(*webhooks, id, &WebhookRecord::id);
  if (found == webhooks->end()) return Fault{FaultCode::kNotFound, "webhook", "there is no webhook " + std::to_string(id)};
  return std::move(*found);
}

// The ETag covers what an operator sets, not how deliveries go.
Response webhook_response(int status, const WebhookRecord& webhook, const WebhookState& state, bool with_secret = false) {
  Response response = json_response(status, to_json(webhook, state, with_secret));
  response.headers["etag"] = etag_of(to_json(webhook, {}, false));
  return response;
}

void list_webhooks(WebhookRooms rooms, BuildingId id, const Request& request, Respond respond) {
  const auto page = page_in(request);
  if (!page) return respond(problem(page.fault()));
  rooms.databases.with_building(id, [rooms, id, page = *page, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    auto webhooks = (*database)->webhooks();
    if (!webhooks) return respond(problem(webhooks.fault()));
    std::erase_if(*webhooks, [&](const WebhookRecord& webhook) { return webhook.id <= page.after; });
    const bool more = webhooks->size() > page.most;
    if (more) webhooks->resize(page.most);
    std::vector<std::pair<WebhookRecord, WebhookState>> rows;
    for (const WebhookRecord& webhook : *webhooks) rows.emplace_back(webhook, rooms.webhooks.state(id, webhook.id));
    respond(json_response(200, to_json(rows, more ? webhooks->back().id : 0)));
  });
}

void make_webhook(WebhookRooms rooms, BuildingId id, const Request& request, Respond respond) {
  auto webhook = parse_webhook(request.body);
  if (!webhook) return respond(problem(webhook.fault()));
  if (const auto good = rooms.webhooks.check_target(webhook->url); !good) return respond(problem(good.fault()));
  webhook->created_at = rooms.clock.wall_now();
  webhook->secret.resize(kSecretBytes);
  randombytes_buf(webhook->secret.data(), webhook->secret.size());
  rooms.databases.with_building(id, [rooms, id, webhook = *std::move(webhook), respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto there = (*database)->webhooks();
    if (!there) return respond(problem(there.fault()));
    if (there->size() >= kMostWebhooks) return respond(problem({FaultCode::kTooLarge, "webhooks", "a building has at most 100 webhooks"}));
    const auto made = (*database)->put_webhook(webhook);
    if (!made) return respond(problem(made.fault()));
    rooms.webhooks.webhooks_changed(id);
    Response response = webhook_response(201, *made, {}, true);
    response.headers["location"] = "/v1/buildings/" + std::to_string(id.value) + "/webhooks/" + std::to_string(made->id);
    response.headers["cache-control"] = "no-store";
    respond(std::move(response));
  });
}

void show_webhook(WebhookRooms rooms, BuildingId id, std::uint64_t webhook_id, const Request&, Respond respond) {
  rooms.databases.with_building(id, [rooms, id, webhook_id, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto webhook = webhook_in(**database, webhook_id);
    respond(webhook ? webhook_response(200, *webhook, rooms.webhooks.state(id, webhook_id)) : problem(webhook.fault()));
  });
}

void replace_webhook(WebhookRooms rooms, BuildingId id, std::uint64_t webhook_id, const Request& request, Respond respond) {
  const auto wanted = parse_webhook(request.body);
  if (!wanted) return respond(problem(wanted.fault()));
  if (const auto good = rooms.webhooks.check_target(wanted->url); !good) return respond(problem(good.fault()));
  rooms.databases.with_building(id, [rooms, id, webhook_id, wanted = *wanted, request, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    auto webhook = webhook_in(**database, webhook_id);
    if (!webhook) return respond(problem(webhook.fault()));
    if (auto refused = changed_since(request, to_json(*webhook, {}, false))) return respond(*std::move(refused));
    webhook->url = wanted.url;
    webhook->zones = wanted.zones;
    webhook->enabled = wanted.enabled;
    const auto stored = (*database)->put_webhook(*webhook);
    if (!stored) return respond(problem(stored.fault()));
    rooms.webhooks.webhooks_changed(id);
    respond(webhook_response(200, *stored, rooms.webhooks.state(id, webhook_id)));
  });
}

void remove_webhook(WebhookRooms rooms, BuildingId id, std::uint64_t webhook_id, const Request& request, Respond respond) {
  rooms.databases.with_building(id, [rooms, id, webhook_id, request, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto webhook = webhook_in(**database, webhook_id);
    if (!webhook) return respond(problem(webhook.fault()));
    if (auto refused = changed_since(request, to_json(*webhook, {}, false))) return respond(*std::move(refused));
    const auto removed = (*database)->remove_webhook(webhook_id);
    if (!removed) return respond(problem(removed.fault()));
    rooms.webhooks.webhooks_changed(id);
    respond(json_response(204, ""));
  });
}

void show_dead_letters(WebhookRooms rooms, BuildingId id, std::uint64_t webhook_id, const Request&, Respond respond) {
  rooms.databases.with_building(id, [rooms, id, webhook_id, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto webhook = webhook_in(**database, webhook_id);
    respond(webhook ? json_response(200, to_json(rooms.webhooks.dead_letters(id, webhook_id))) : problem(webhook.fault()));
  });
}

void show_deliveries(WebhookRooms rooms, BuildingId id, std::uint64_t webhook_id, const Request&, Respond respond) {
  rooms.databases.with_building(id, [rooms, id, webhook_id, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto webhook = webhook_in(**database, webhook_id);
    respond(webhook ? json_response(200, to_json(rooms.webhooks.attempts(id, webhook_id))) : problem(webhook.fault()));
  });
}

void retry_dead_letters(WebhookRooms rooms, BuildingId id, std::uint64_t webhook_id, const Request& request, Respond respond) {
  const auto named = request.query.find("event");
  const std::string event = named != request.query.end() ? named->second : std::string();
  rooms.databases.with_building(id, [rooms, id, webhook_id, event, respond](Result<BuildingDatabase*> database) {
    if (!database) return respond(problem(database.fault()));
    const auto webhook = webhook_in(**database, webhook_id);
    if (!webhook) return respond(problem(webhook.fault()));
    const std::uint64_t retried = rooms.webhooks.retry_dead_letters(id, webhook_id, event);
    if (!event.empty() && retried == 0) {
      return respond(problem({FaultCode::kNotFound, "event", "'" + event + "' is no dead letter of this webhook, or too many events wait already"}));
    }
    respond(json_response(202, R"({"retried":)" + std::to_string(retried) + "}"));
  });
}

using OnWebhook = void (*)(WebhookRooms, BuildingId, std::uint64_t, const Request&, Respond);

Handler on_webhook(WebhookRooms rooms, OnWebhook handler) {
  return [rooms, handler](const Request& request, const PathValues& path, Respond respond) {
    const auto building = building_in(path);
    if (!building) return respond(problem(building.fault()));
    const auto webhook = id_in(path, "webhook");
    if (!webhook) return respond(problem(webhook.fault()));
    handler(rooms, *building, *webhook, request, std::move(respond));
  };
}

}  // namespace

void add_webhook_routes(Router& router, DatabaseDirectory& databases, WebhookControl& webhooks, const Clock& clock) {
  const WebhookRooms rooms{databases, webhooks, clock};
  const std::string all = "/v1/buildings/{building}/webhooks";
  const std::string one = all + "/{webhook}";
  router.add({"GET", all, Scope::kAdmin, "Webhooks and how their deliveries go",
              on_building([rooms](BuildingId id, const Request& request, Respond respond) {
                list_webhooks(rooms, id, request, std::move(respond));
              })});
  router.add({"POST", all, Scope::kAdmin, "Make a webhook; its secret is shown this once",
              on_building([rooms](BuildingId id, const Request& request, Respond respond) {
                make_webhook(rooms, id, request, std::move(respond));
              })});
  router.add({"GET", one, Scope::kAdmin, "One webhook", on_webhook(rooms, show_webhook)});
  router.add({"PUT", one, Scope::kAdmin, "Replace a webhook's target, zones and switch", on_webhook(rooms, replace_webhook)});
  router.add({"GET", one + "/deliveries", Scope::kAdmin, "The newest attempts at delivering, and what came of each", on_webhook(rooms, show_deliveries)});
  router.add({"GET", one + "/dead-letters", Scope::kAdmin, "Events that could not be delivered", on_webhook(rooms, show_dead_letters)});
  router.add({"POST", one + "/dead-letters/retry", Scope::kAdmin, "Try them again", on_webhook(rooms, retry_dead_letters)});
  router.add({"DELETE", one, Scope::kAdmin, "Remove a webhook", on_webhook(rooms, remove_webhook)});
}

}  // namespace wayfuse
