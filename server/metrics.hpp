#pragma once

#include <string>

#include "server/maps/access_point_desk.hpp"
#include "server/buildings/building_keeper.hpp"
#include "server/net/net_world.hpp"
#include "server/webhooks/webhook_sender.hpp"
#include "server/zones/zone_watch.hpp"
#include "server/sessions/session_world.hpp"

namespace wayfuse {

/// The state of the server in Prometheus' text exposition format 0.0.4. No ids, names or positions [SAFETY C19].
std::string metrics_text(const SessionWorld& sessions, const NetCounters& net, const MemoryBudget& budget,
                         const BuildingKeeper& buildings, const ZoneWatch& zones, const WebhookSender& webhooks,
                         const AccessPointCounts& access_points, bool ready);

}  // namespace wayfuse
