#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "admin/webhook_control.hpp"

/// The JSON of webhooks.
namespace wayfuse {

/// `{"url":.., "zones":[..], "enabled":..}`; whether the URL may be a target is the server's word.
Result<WebhookRecord> parse_webhook(std::string_view json);
/// The secret is `whsec_` and base64, and shown only when it was made.
std::string to_json(const WebhookRecord& webhook, const WebhookState& state, bool with_secret);
std::string to_json(const std::vector<std::pair<WebhookRecord, WebhookState>>& webhooks, std::uint64_t next);
std::string to_json(const std::vector<DeadLetter>& letters);
std::string to_json(const std::vector<WebhookAttempt>& attempts);

}  // namespace wayfuse
