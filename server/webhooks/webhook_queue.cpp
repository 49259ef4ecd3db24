#include "server/webhooks/webhook_queue.hpp"

#include <algorithm>
#include <cmath>

#include "wayfuse/proto/codec.hpp"

namespace wayfuse {
namespace {

std::string body_of(const NumberedZoneEvent& event) {
  return R"({"building":)" + std::to_string(event.building.value) + R"(,"event":)" + encode(event.event, Encoding::kJson) + "}";
}

bool wants(const WebhookRecord& webhook, const NumberedZoneEvent& event) {
  const auto is_it = [&](std::uint64_t zone) { return std::to_string(zone) == event.event.zone; };
  return webhook.enabled && (webhook.zones.empty() || std::ranges::any_of(webhook.zones, is_it));
}

}  // namespace

void WebhookQueue::put_webhooks(BuildingId building, const std::vector<WebhookRecord>& webhooks) {
  std::erase_if(lanes_, [&](const auto& entry) {
    return entry.first.first == building && std::ranges::find(webhooks, entry.first.second, &WebhookRecord::id) == webhooks.end();
  });
  for (const WebhookRecord& webhook : webhooks) {
    Lane& lane = lanes_[{building, webhook.id}];
    lane.record = webhook;
    for (WebhookDelivery& delivery : lane.waiting) delivery.url = webhook.url;
  }
}

void WebhookQueue::offer(const NumberedZoneEvent& event, ServerTime now) {
  for (auto& [key, lane] : lanes_) {
    if (key.first != event.building || !wants(lane.record, event)) continue;
    make_room(lane);
    lane.waiting.push_back({key.first, key.second, lane.record.url, lane.record.secret, event.event.id, event.event.at, body_of(event), 0, now, {}, {}, 0});
  }
}

std::optional<WebhookDelivery> WebhookQueue::take(ServerTime now) {
  for (auto& [key, lane] : lanes_) {
    if (lane.under_way) continue;
    const auto due = std::ranges::find_if(lane.waiting, [&](const WebhookDelivery& delivery) { return delivery.due <= now; });
    if (due == lane.waiting.end()) continue;
    WebhookDelivery delivery = std::move(*due);
    lane.waiting.erase(due);
    lane.under_way = true;
    ++delivery.attempts;
    return delivery;
  }
  return std::nullopt;
}

void WebhookQueue::done(const WebhookDelivery& delivery) {
  const auto lane = lanes_.find({delivery.building, delivery.webhook});
  if (lane == lanes_.end()) return;
  lane->second.under_way = false;
  lane->second.counts.delivered++;
  note(lane->second, delivery, WebhookAttempt::Outcome::kDelivered, {});
}

void WebhookQueue::failed(WebhookDelivery delivery, std::string failure, bool final, ServerTime now) {
  const auto found = lanes_.find({delivery.building, delivery.webhook});
  if (found == lanes_.end()) return;
  Lane& lane = found->second;
  lane.under_way = false;
  lane.counts.failed_attempts++;
  lane.counts.last_failure = failure;
  const bool over = final || delivery.attempts >= settings_.attempts;
  note(lane, delivery, over ? WebhookAttempt::Outcome::kDead : WebhookAttempt::Outcome::kWaits, failure);
  if (over) return bury(lane, std::move(delivery), std::move(failure));
  const double doubled = std::ldexp(seconds(settings_.first_wait), static_cast<int>(delivery.attempts) - 1);
  const double wait_s = std::min(doubled, seconds(settings_.longest_wait)) * (0.5 + 0.5 * random_.uniform());
  delivery.due = now + from_seconds(wait_s);
  make_room(lane);
  lane.waiting.push_back(std::move(delivery));
}

std::optional<ServerTime> WebhookQueue::next_due() const {
  std::optional<ServerTime> next;
  for (const auto& [key, lane] : lanes_) {
    if (lane.under_way) continue;
    for (const WebhookDelivery& delivery : lane.waiting) next = next ? std::min(*next, delivery.due) : delivery.due;
  }
  return next;
}

void WebhookQueue::make_room(Lane& lane) {
  while (lane.waiting.size() >= settings_.waiting_most) {
    WebhookDelivery oldest = std::move(lane.waiting.front());
    lane.waiting.pop_front();
    bury(lane, std::move(oldest), "more than " + std::to_string(settings_.waiting_most) + " events were waiting");
  }
}

void WebhookQueue::note(Lane& lane, const WebhookDelivery& delivery, WebhookAttempt::Outcome outcome, const std::string& failure) const {
  if (lane.attempts.size() >= settings_.attempts_most) lane.attempts.pop_front();
  lane.attempts.push_back({delivery.id, delivery.sent_at, delivery.attempts, delivery.status, delivery.took, outcome, failure});
}

std::vector<WebhookAttempt> WebhookQueue::attempts(BuildingId building, std::uint64_t webhook) const {
  const Lane* found = lane(building, webhook);
  if (!found) return {};
  return {found->attempts.rbegin(), found->attempts.rend()};
}

void WebhookQueue::bury(Lane& lane, WebhookDelivery delivery, std::string failure) {
  lane.dead.push_back({std::move(delivery), std::move(failure)});
  if (lane.dead.size() <= settings_.dead_most) return;
  lane.dead.pop_front();
  lane.counts.dropped++;
}

WebhookState WebhookQueue::state_of(const Lane& lane) {
  WebhookState state = lane.counts;
  state.waiting = lane.waiting.size() + (lane.under_way ? 1 : 0);
  state.dead = lane.dead.size();
  return state;
}

const WebhookQueue::Lane* WebhookQueue::lane(BuildingId building, std::uint64_t webhook) const {
  const auto found = lanes_.find({building, webhook});
  return found != lanes_.end() ? &found->second : nullptr;
}

WebhookState WebhookQueue::state(BuildingId building, std::uint64_t webhook) const {
  const Lane* found = lane(building, webhook);
  return found ? state_of(*found) : WebhookState();
}

std::vector<DeadLetter> WebhookQueue::dead_letters(BuildingId building, std::uint64_t webhook) const {
  std::vector<DeadLetter> letters;
  if (const Lane* found = lane(building, webhook)) {
    for (const Dead& dead : found->dead) letters.push_back({dead.delivery.id, dead.delivery.at, dead.delivery.attempts, dead.failure});
  }
  return letters;
}

std::uint64_t WebhookQueue::retry_dead_letters(BuildingId building, std::uint64_t webhook, const std::string& event, ServerTime now) {
  const auto found = lanes_.find({building, webhook});
  if (found == lanes_.end()) return 0;
  Lane& lane = found->second;
  std::deque<Dead> stay;
  std::uint64_t count = 0;
  for (Dead& dead : lane.dead) {
    const bool wanted = event.empty() || dead.delivery.id == event;
    if (!wanted || lane.waiting.size() >= settings_.waiting_most) {
      stay.push_back(std::move(dead));
      continue;
    }
    WebhookDelivery delivery = std::move(dead.delivery);
    delivery.attempts = 0;
    delivery.due = now;
    delivery.url = lane.record.url;
    lane.waiting.push_back(std::move(delivery));
    ++count;
  }
  lane.dead = std::move(stay);
  return count;
}

WebhookState WebhookQueue::total() const {
  WebhookState total;
  for (const auto& [key, lane] : lanes_) {
    const WebhookState one = state_of(lane);
    total.waiting += one.waiting;
    total.delivered += one.delivered;
    total.failed_attempts += one.failed_attempts;
    total.dead += one.dead;
    total.dropped += one.dropped;
  }
  return total;
}

}  // namespace wayfuse
