#include "db/webhook_table.hpp"

#include <charconv>

namespace wayfuse {
namespace {

// `4,17`: nobody asks for single ones.
std::string spell(const std::vector<std::uint64_t>& zones) {
  std::string text;
  for (const std::uint64_t zone : zones) text += (text.empty() ? "" : ",") + std::to_string(zone);
  return text;
}

std::vector<std::uint64_t> zones_in(std::string_view text) {
  std::vector<std::uint64_t> zones;
  while (!text.empty()) {
    std::uint64_t zone = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), zone);
    if (error != std::errc{}) throw StoreError({FaultCode::kStoreCorrupt, "webhook.zones", "is not a list of numbers"});
    zones.push_back(zone);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (!text.empty()) text.remove_prefix(1);
  }
  return zones;
}

StoreError unknown(std::uint64_t id) { return StoreError({FaultCode::kNotFound, "id", "there is no webhook " + std::to_string(id)}); }

}  // namespace

std::vector<WebhookRecord> read_webhooks(SqliteConnection& connection) {
  Statement select = connection.prepare("SELECT id, url, secret, zones, enabled, created_at_us FROM webhook ORDER BY id");
  std::vector<WebhookRecord> webhooks;
  while (select.step()) {
    webhooks.push_back({static_cast<std::uint64_t>(select.integer(0)), std::string(select.text(1)), std::string(select.blob(2)),
                        zones_in(select.text(3)), select.integer(4) != 0, UnixTime(Duration(select.integer(5)))});
  }
  return webhooks;
}

WebhookRecord write_webhook(SqliteConnection& connection, WebhookRecord webhook) {
  const std::string zones = spell(webhook.zones);
  Transaction transaction(connection);
  if (webhook.id == 0) {
    Statement insert = connection.prepare("INSERT INTO webhook (url, zones, enabled, secret, created_at_us) VALUES (?, ?, ?, ?, ?)");
    insert.bind_text(1, webhook.url).bind_text(2, zones).bind(3, std::int64_t{webhook.enabled}).bind_blob(4, webhook.secret);
    insert.bind(5, std::int64_t{webhook.created_at.time_since_epoch().count()}).run();
    webhook.id = static_cast<std::uint64_t>(connection.last_insert_id());
  } else {
    Statement update = connection.prepare("UPDATE webhook SET url = ?, zones = ?, enabled = ? WHERE id = ?");
    update.bind_text(1, webhook.url).bind_text(2, zones).bind(3, std::int64_t{webhook.enabled});
    if (update.bind(4, static_cast<std::int64_t>(webhook.id)).run() == 0) throw unknown(webhook.id);
  }
  transaction.commit();
  return webhook;
}

void remove_webhook(SqliteConnection& connection, std::uint64_t id) {
  Transaction transaction(connection);
  Statement erase = connection.prepare("DELETE FROM webhook WHERE id = ?");
  if (erase.bind(1, static_cast<std::int64_t>(id)).run() == 0) throw unknown(id);
  transaction.commit();
}

}  // namespace wayfuse
