#pragma once

#include <functional>
#include <memory>

#include "admin/http.hpp"
#include "admin/zone_control.hpp"
#include "wayfuse/proto/result.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// Where a follower begins.
struct EventStreamBegin {
  std::uint64_t after = 0;         ///< the first event told is the next one
  bool missed = false;             ///< events before it are lost to this follower
};

/// By `Last-Event-ID` (a header, or `last_event_id` in the query): an id of this server goes on behind it, one of an earlier
/// run begins with what is kept and says that events are missing, none begins now. A text that is no id is a fault.
Result<EventStreamBegin> event_stream_begin(const Request& request, const ZoneControl& zones);

/// Zone events of one building as server-sent events (WHATWG HTML 9.2): `event: zone_event` with the protocol's own message
/// as data, and `event: missed` where some fell out of the server's memory. A comment every 15 s keeps the line alive; it ends
/// when `still_allowed` says no. `zones` must outlive it; what it reads from is the server's one bounded log, so a slow reader
/// costs nobody memory.
std::shared_ptr<BodySource> event_stream(ZoneControl& zones, BuildingId building, EventStreamBegin begin, const Clock& clock,
                                         std::function<bool()> still_allowed);

}  // namespace wayfuse
