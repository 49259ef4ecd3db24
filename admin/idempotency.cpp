#include "admin/idempotency.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "admin/conditional.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::json;

bool serves_as_key(const std::string& key) {
  return !key.empty() && key.size() <= 64 && std::ranges::all_of(key, [](unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
  });
}

bool holds_secret(const Response& response) {
  const auto found = response.headers.find("cache-control");
  return found != response.headers.end() && found->second.find("no-store") != std::string::npos;
}

std::string spelled(const Response& response) {
  return Json{{"status", response.status}, {"content_type", response.content_type}, {"headers", response.headers}, {"body", response.body}}.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Response read_back(const AnsweredPost& post) {
  switch (post.state) {
    case AnsweredPost::State::kKept: break;
    case AnsweredPost::State::kUnderWay:
      return problem({FaultCode::kConflict, "Idempotency-Key", "the server ended while the first request was under way: look whether it happened, then ask with another key"});
    case AnsweredPost::State::kNotKept:
      return problem({FaultCode::kConflict, "Idempotency-Key", "it happened before the server's last start, and its answer was not kept: it held a secret or was long"});
  }
  const Json json = Json::parse(post.answer, nullptr, false);
  if (!json.is_object()) return problem({FaultCode::kConflict, "Idempotency-Key", "it happened, and its answer cannot be read back"});
  Response response;
  response.status = json.value("status", 200);
  response.content_type = json.value("content_type", response.content_type);
  response.headers = json.value("headers", response.headers);
  response.body = json.value("body", "");
  return response;
}

}  // namespace

Result<void> IdempotencyLedger::load() {
  const auto posts = store_.answered_posts();
  if (!posts) return posts.fault();
  const std::lock_guard lock(mutex_);
  for (const AnsweredPost& post : *posts) {
    if (entries_.emplace(post.name, Entry{post.body_hash, read_back(post), post.at}).second) oldest_first_.push_back(post.name);
  }
  forget_old();
  return {};
}

std::optional<Respond> IdempotencyLedger::begin(const Request& request, Respond respond) {
  const auto key = request.headers.find("idempotency-key");
  if (key == request.headers.end()) return respond;
  if (!serves_as_key(key->second)) {
    respond(problem({FaultCode::kBadText, "Idempotency-Key", "must be 1..64 of A-Z a-z 0-9 . _ -"}));
    return std::nullopt;
  }
  const std::string name = etag_of(std::to_string(request.key_id) + ' ' + request.path + ' ' + key->second);
  const std::string body_hash = etag_of(request.body);
  const UnixTime at = clock_.wall_now();
  std::optional<Response> known;
  {
    const std::lock_guard lock(mutex_);
    forget_old();
    const auto [entry, fresh] = entries_.try_emplace(name, Entry{body_hash, std::nullopt, at});
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
  store_.note_answered(name, AnsweredPost{name, body_hash, at}, at - kKept, [](const Result<void>&) {});
  return [this, name, body_hash, at, respond = std::move(respond)](Response response) {
    finish(name, body_hash, at, std::move(response), respond);
  };
}

void IdempotencyLedger::finish(const std::string& name, const std::string& body_hash, UnixTime at, Response response, const Respond& respond) {
  const bool passing = response.status >= 500 || response.stream || response.body.size() > kLongestBody;
  {
    const std::lock_guard lock(mutex_);
    const auto entry = entries_.find(name);
    if (entry != entries_.end() && passing) {
      entries_.erase(entry);
      std::erase(oldest_first_, name);
    } else if (entry != entries_.end()) {
      entry->second.answer = response;
    }
  }
  std::optional<AnsweredPost> record;
  if (!passing) {
    const bool kept = !holds_secret(response) && response.body.size() <= kLongestWritten;
    record = AnsweredPost{name, body_hash, at, kept ? AnsweredPost::State::kKept : AnsweredPost::State::kNotKept, kept ? spelled(response) : ""};
  }
  store_.note_answered(name, std::move(record), at - kKept, [response = std::move(response), respond](const Result<void>&) { respond(response); });
}

void IdempotencyLedger::forget_old() {
  const UnixTime before = clock_.wall_now() - kKept;
  while (!oldest_first_.empty() && (oldest_first_.size() >= kMost || entries_.at(oldest_first_.front()).at < before)) {
    entries_.erase(oldest_first_.front());
    oldest_first_.pop_front();
  }
}

}  // namespace wayfuse
