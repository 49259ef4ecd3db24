#include "sdk/src/client/upload_queue.hpp"

#include <algorithm>

#include "wayfuse/proto/codec.hpp"

namespace wayfuse {
namespace {

Result<void> check_upload(const ClientMessage& message) {
  if (auto checked = check(message); !checked) return checked;
  const std::size_t bytes = encode(message, Encoding::kJson).size();
  if (bytes <= Limits::kMessageBytes) return {};
  return Fault{FaultCode::kTooLarge, "",
               std::to_string(bytes) + " bytes as JSON, at most " + std::to_string(Limits::kMessageBytes)};
}

}  // namespace

const std::string& key_of(const SurveyUpload& upload) {
  return std::visit([](const auto& body) -> const std::string& { return body.idempotency_key; }, upload);
}

UploadQueue::Waiting* UploadQueue::find(std::string_view key) {
  const auto found =
      std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& waiting) { return key_of(waiting.upload) == key; });
  return found == waiting_.end() ? nullptr : &*found;
}

Result<void> UploadQueue::push(SurveyUpload upload) {
  if (waiting_.size() >= most_) {
    return Fault{FaultCode::kTooLarge, "",
                 std::to_string(waiting_.size()) + " uploads wait already; try again when one is stored"};
  }
  const ClientMessage message = std::visit([](const auto& body) { return ClientMessage(body); }, upload);
  if (auto checked = check_upload(message); !checked) return checked;
  if (find(key_of(upload))) {
    return Fault{FaultCode::kIdempotencyConflict, "idempotency_key", "an upload under this key waits already"};
  }
  waiting_.push_back({std::move(upload), false, PhoneTime::min()});
  return {};
}

const SurveyUpload* UploadQueue::next(PhoneTime now) {
  std::size_t on_the_way = 0;
  for (Waiting& waiting : waiting_) {
    if (waiting.due <= now) {
      waiting.sent = true;
      waiting.due = now + patience_;
      return &waiting.upload;
    }
    if (waiting.sent && ++on_the_way >= kOnTheWay) return nullptr;
  }
  return nullptr;
}

void UploadQueue::unsend(std::string_view key) {
  if (Waiting* waiting = find(key)) {
    waiting->sent = false;
    waiting->due = PhoneTime::min();
  }
}

void UploadQueue::rewind() {
  for (Waiting& waiting : waiting_) {
    if (waiting.sent) waiting.due = PhoneTime::min();
    waiting.sent = false;
  }
}

bool UploadQueue::settle(std::string_view key) {
  const auto found =
      std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& waiting) { return key_of(waiting.upload) == key; });
  if (found == waiting_.end()) return false;
  waiting_.erase(found);
  return true;
}

void UploadQueue::retry(std::string_view key, PhoneTime at) {
  if (Waiting* waiting = find(key)) {
    waiting->sent = false;
    waiting->due = at;
  }
}

std::optional<PhoneTime> UploadQueue::due() const {
  std::optional<PhoneTime> earliest;
  std::size_t on_the_way = 0;
  for (const Waiting& waiting : waiting_) {
    if (!earliest || waiting.due < *earliest) earliest = waiting.due;
    if (waiting.sent && ++on_the_way >= kOnTheWay) break;
  }
  return earliest;
}

}  // namespace wayfuse
