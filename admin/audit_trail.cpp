#include "admin/audit_trail.hpp"

#include <algorithm>
#include <optional>

namespace wayfuse {
namespace {

constexpr std::size_t kActionBytes = 64;
constexpr std::size_t kSubjectBytes = 256;

// `PUT zones/{zone}`: what the building is stands in a column of its own.
std::string action_of(const Route& route) {
  std::string_view pattern = route.pattern;
  for (const std::string_view prefix : {std::string_view("/v1/"), std::string_view("buildings/{building}/")}) {
    if (pattern.starts_with(prefix)) pattern.remove_prefix(prefix.size());
  }
  return (route.method + " " + std::string(pattern)).substr(0, kActionBytes);
}

// `zone 4`. It comes from a path and so from anybody: only what is plain is kept.
std::string subject_of(const PathValues& values) {
  std::string subject;
  for (const auto& [name, value] : values) {
    if (name != "building") subject += (subject.empty() ? "" : ", ") + name + " " + value;
  }
  std::ranges::replace_if(subject, [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
  return subject.substr(0, kSubjectBytes);
}

/// Two things come in either order: the answer and the line's durability. The second lets the answer go.
struct Held {
  std::mutex mutex;
  std::optional<Response> response;
  std::optional<Result<void>> written;
  Respond respond;

  void go() {
    std::optional<Response> answer;
    {
      const std::lock_guard lock(mutex);
      if (!response || !written || !respond) return;
      answer = *written ? std::move(*response) : problem(written->fault());
      response.reset();
    }
    respond(std::move(*answer));
  }
};

}  // namespace

bool AuditTrail::read_lately(const std::string& what) {
  const std::lock_guard lock(mutex_);
  const auto last = reads_.find(what);
  return last != reads_.end() && clock_.now() - last->second < kOneReading;
}

void AuditTrail::was_read(const std::string& what) {
  const std::lock_guard lock(mutex_);
  if (reads_.size() >= kRemembered) reads_.clear();
  reads_[what] = clock_.now();
}

Respond AuditTrail::held_back(const Route& route, const PathValues& values, const Principal& who, BuildingId building,
                              Respond respond) {
  AuditRecord line;
  line.at = clock_.wall_now();
  line.key_id = who.key_id;
  line.building = building;
  line.action = action_of(route);
  line.subject = subject_of(values);
  std::string reading;
  if (route.method == "GET") {
    reading = std::to_string(line.key_id) + ' ' + std::to_string(building.value) + ' ' + line.action + ' ' + line.subject;
    if (read_lately(reading)) return respond;
  }
  const auto held = std::make_shared<Held>();
  held->respond = std::move(respond);
  store_.audit(std::move(line), [this, held, reading](Result<void> written) {
    if (written && !reading.empty()) was_read(reading);
    {
      const std::lock_guard lock(held->mutex);
      held->written = std::move(written);
    }
    held->go();
  });
  return [held](Response response) {
    {
      const std::lock_guard lock(held->mutex);
      held->response = std::move(response);
    }
    held->go();
  };
}

}  // namespace wayfuse
