#include "admin/event_stream.hpp"

#include <charconv>

#include "wayfuse/proto/codec.hpp"

namespace wayfuse {
namespace {

constexpr Duration kAliveEvery = std::chrono::seconds(15);
constexpr std::size_t kEventsAtOnce = 64;

class EventStream final : public BodySource {
 public:
  EventStream(ZoneControl& zones, BuildingId building, EventStreamBegin begin, const Clock& clock, std::function<bool()> still_allowed)
      : zones_(zones), building_(building), told_(begin.after), missed_(begin.missed), clock_(clock), still_allowed_(std::move(still_allowed)) {}

  std::optional<std::string> next() override {
    std::string text = begun_ ? "" : "retry: 2000\n\n";
    begun_ = true;
    for (;;) {
      const auto news = zones_.events_after(told_, building_, kEventsAtOnce);
      if (missed_ || news.missed) text += "event: missed\ndata: {\"type\":\"missed\"}\n\n";
      missed_ = false;
      const bool more = news.through != told_;
      told_ = news.through;
      for (const NumberedZoneEvent& event : news.events) {
        text += "id: " + event.event.id + "\nevent: zone_event\ndata: " + encode(event.event, Encoding::kJson) + "\n\n";
      }
      if (!text.empty() || !more) break;
    }
    if (!text.empty()) said_at_ = clock_.now();
    return text;
  }

  void on_ready(std::function<void()> wake) override { listening_ = zones_.on_event(std::move(wake)); }

  std::optional<std::string> idle() override {
    if (clock_.now() - said_at_ < kAliveEvery) return std::string();
    if (!still_allowed_()) return std::nullopt;
    said_at_ = clock_.now();
    return std::string(": alive\n\n");
  }

 private:
  ZoneControl& zones_;
  const BuildingId building_;
  std::uint64_t told_;
  bool missed_;
  bool begun_ = false;
  const Clock& clock_;
  const std::function<bool()> still_allowed_;
  ServerTime said_at_{};
  std::shared_ptr<void> listening_;
};

}  // namespace

Result<EventStreamBegin> event_stream_begin(const Request& request, const ZoneControl& zones) {
  std::string id;
  if (const auto header = request.headers.find("last-event-id"); header != request.headers.end()) id = header->second;
  if (const auto query = request.query.find("last_event_id"); query != request.query.end()) id = query->second;
  if (id.empty()) return EventStreamBegin{zones.newest_event(), false};
  std::uint64_t epoch = 0;
  std::uint64_t number = 0;
  const char* end = id.data() + id.size();
  const auto first = std::from_chars(id.data(), end, epoch);
  const bool dash = first.ec == std::errc{} && first.ptr != end && *first.ptr == '-';
  const auto second = dash ? std::from_chars(first.ptr + 1, end, number) : first;
  if (!dash || second.ec != std::errc{} || second.ptr != end) {
    return Fault{FaultCode::kOutOfRange, "Last-Event-ID", "is no id of a zone event"};
  }
  if (epoch != zones.event_epoch()) return EventStreamBegin{0, true};
  return EventStreamBegin{number, false};
}

std::shared_ptr<BodySource> event_stream(ZoneControl& zones, BuildingId building, EventStreamBegin begin, const Clock& clock,
                                         std::function<bool()> still_allowed) {
  return std::make_shared<EventStream>(zones, building, begin, clock, std::move(still_allowed));
}

}  // namespace wayfuse
