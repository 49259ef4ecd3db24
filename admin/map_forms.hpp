#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "admin/map_control.hpp"

/// The JSON of radio maps, quality walks, expected accuracy and access points.
namespace wayfuse {

/// A version as it is listed; `measured` empty = no quality walk was replayed on it with today's pipeline.
std::string to_json(const RadioMapRecord& map, bool live, const std::vector<MapQuality>& measured);
std::string to_json(const Publication& publication);
std::string to_json(const QualityWalkRecord& walk);
std::string to_json(const MapComparisonView& comparison);
std::string to_json(const ExpectedAccuracy& accuracy);
std::string to_json(const SurveyPlan& plan);
std::string to_json(const AccessPointView& view);
/// `{"items":[..]}` of documents already spelled; `next` is what to go on after, 0 = this was the last page.
std::string items_json(const std::vector<std::string>& items, std::uint64_t next = 0);

/// `{"expected_live": 3, "override": false, "reason": ".."}`; an override needs a reason.
Result<MapPromotion> parse_promotion(std::string_view json);
/// `{"reason": ".."}`; an empty body has none.
Result<std::string> parse_reason(std::string_view json);
/// `{"trust": "auto" | "always" | "never"}`.
Result<AccessPointTrust> parse_trust(std::string_view json);

}  // namespace wayfuse
