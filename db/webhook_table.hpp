#pragma once

#include <vector>

#include "db/sqlite.hpp"
#include "db/webhook_record.hpp"

namespace wayfuse {

/// Each in one transaction; throw StoreError.
std::vector<WebhookRecord> read_webhooks(SqliteConnection& connection);
WebhookRecord write_webhook(SqliteConnection& connection, WebhookRecord webhook);
void remove_webhook(SqliteConnection& connection, std::uint64_t id);

}  // namespace wayfuse
