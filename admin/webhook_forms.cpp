#include "admin/webhook_forms.hpp"

#include <sodium.h>

#include <nlohmann/json.hpp>

#include "admin/json_field.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostZones = 1000;

std::string shown(const std::string& secret) {
  std::string text(sodium_base64_encoded_len(secret.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(text.data(), text.size(), reinterpret_cast<const unsigned char*>(secret.data()), secret.size(),
                    sodium_base64_VARIANT_ORIGINAL);
  text.pop_back();  // its final zero
  return "whsec_" + text;
}

Json form_of(const WebhookRecord& webhook, const WebhookState& state) {
  Json json{{"id", webhook.id},
            {"url", webhook.url},
            {"zones", webhook.zones},
            {"enabled", webhook.enabled},
            {"created_at_us", webhook.created_at.time_since_epoch().count()},
            {"waiting", state.waiting},
            {"delivered", state.delivered},
            {"failed_attempts", state.failed_attempts},
            {"dead_letters", state.dead},
            {"dropped", state.dropped}};
  json["last_failure"] = state.last_failure.empty() ? Json(nullptr) : Json(state.last_failure);
  return json;
}

}  // namespace

Result<WebhookRecord> parse_webhook(std::string_view json) {
  return JsonField::reading([&] {
    const JsonField whole = JsonField::object_in(json);
    WebhookRecord webhook;
    webhook.url = whole.member("url").text(2048);
    if (const auto zones = whole.maybe("zones")) {
      for (const JsonField& zone : zones->list(kMostZones)) {
        webhook.zones.push_back(static_cast<std::uint64_t>(zone.whole(1, std::int64_t{1} << 53)));
      }
    }
    webhook.enabled = whole.flag("enabled", true);
    return webhook;
  });
}

std::string to_json(const WebhookRecord& webhook, const WebhookState& state, bool with_secret) {
  Json json = form_of(webhook, state);
  if (with_secret) json["secret"] = shown(webhook.secret);
  return json.dump();
}

std::string to_json(const std::vector<std::pair<WebhookRecord, WebhookState>>& webhooks, std::uint64_t next) {
  Json json;
  json["webhooks"] = Json::array();
  for (const auto& [webhook, state] : webhooks) json["webhooks"].push_back(form_of(webhook, state));
  if (next != 0) json["next"] = next;
  return json.dump();
}

std::string to_json(const std::vector<WebhookAttempt>& attempts) {
  const auto spelled = [](WebhookAttempt::Outcome outcome) {
    switch (outcome) {
      case WebhookAttempt::Outcome::kDelivered: return "delivered";
      case WebhookAttempt::Outcome::kWaits: return "waits";
      case WebhookAttempt::Outcome::kDead: break;
    }
    return "dead";
  };
  Json json;
  json["deliveries"] = Json::array();
  for (const WebhookAttempt& attempt : attempts) {
    json["deliveries"].push_back({{"event", attempt.event_id},
                                  {"at_us", attempt.at.time_since_epoch().count()},
                                  {"attempt", attempt.attempt},
                                  {"status", attempt.status == 0 ? Json(nullptr) : Json(attempt.status)},
                                  {"took_us", attempt.took.count()},
                                  {"outcome", spelled(attempt.outcome)},
                                  {"failure", attempt.failure.empty() ? Json(nullptr) : Json(attempt.failure)}});
  }
  return json.dump();
}

std::string to_json(const std::vector<DeadLetter>& letters) {
  Json json;
  json["dead_letters"] = Json::array();
  for (const DeadLetter& letter : letters) {
    json["dead_letters"].push_back({{"event", letter.event_id},
                                    {"at_us", letter.at.time_since_epoch().count()},
                                    {"attempts", letter.attempts},
                                    {"failure", letter.failure}});
  }
  return json.dump();
}

}  // namespace wayfuse
