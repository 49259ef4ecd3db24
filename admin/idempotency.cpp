#include "admin/idempotency.hpp"

#include <algorithm>

#include "admin/conditional.hpp"

namespace wayfuse {
namespace {

bool serves_as_key(const std::string& key) {
  return !key.empty() && key.size() <= 64 && std::ranges::all_of(key, [](unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
  });
}

}  // namespace

std::optional<Respond> IdempotencyLedger::begin(const Request& request, Respond respond) {
  const auto key = request.headers.find("idempotency-key");
  if (key == request.headers.end()) return respond;
  if (!serves_as_key(key->second)) {
    respond(problem({FaultCode::kBadText, "Idempotency-Key", "must be 1..64 of A-Z a-z 0-9 . _ -"}));
    return std::nullopt;
  }
  const std::string name = std::to_string(request.key_id) + ' ' + request.path + ' ' + key->second;
  const std::string body_hash = etag_of(request.body);
  std::optional<Response> known;
  {
    const std::lock_guard lock(mutex_);
    forget_old();
    const auto [entry, fresh] = entries_.try_emplace(name, Entry{body_hash, std::nullopt, clock_.now()});
    if (fresh) {
      oldest_first_.push_back(name);
    } else if (entry->second.body_hash != body_hash) {
      known = problem({FaultCode::kIdempotencyConflict, "Idempotency-Key", "it was used before with another body"});
    } else {
      known = entry->second.answer ? *entry->second.answer
                                   : problem({FaultCode::kConflict, "Idempotency-Key", "the first request is still under way"});
    }
  }
  if (known) {
    respond(*std::move(known));
    return std::nullopt;
  }
  return [this, name, respond = std::move(respond)](Response response) {
    finish(name, response);
    respond(std::move(response));
  };
}

void IdempotencyLedger::finish(const std::string& name, const Response& response) {
  const std::lock_guard lock(mutex_);
  const auto entry = entries_.find(name);
  if (entry == entries_.end()) return;
  if (response.status >= 500 || response.stream || response.body.size() > kLongestBody) {
    entries_.erase(entry);
    std::erase(oldest_first_, name);
  } else {
    entry->second.answer = response;
  }
}

void IdempotencyLedger::forget_old() {
  const ServerTime before = clock_.now() - kKept;
  while (!oldest_first_.empty() && (oldest_first_.size() >= kMost || entries_.at(oldest_first_.front()).at < before)) {
    entries_.erase(oldest_first_.front());
    oldest_first_.pop_front();
  }
}

}  // namespace wayfuse
