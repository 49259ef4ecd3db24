#pragma once

#include <memory>
#include <vector>

#include "server/pipeline/tracker.hpp"

namespace wayfuse {

/// A pipeline that does not hear the given transmitters (ascending): their readings are taken out of every scan before any part
/// sees it. The map behind it must have been built without them.
std::shared_ptr<const TrackerFactory> deaf_to(std::vector<Bssid> distrusted, std::shared_ptr<const TrackerFactory> pipeline);

}  // namespace wayfuse
