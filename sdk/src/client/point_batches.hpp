#pragma once

#include <utility>
#include <vector>

#include "wayfuse/proto/fingerprint.hpp"

namespace wayfuse {

/// Reference points on their way into messages, each with the bytes of its JSON spelling.
using SizedPoints = std::vector<std::pair<ReferencePoint, std::size_t>>;
using BytesOf = std::size_t (*)(const ReferencePoint&);
/// In a message as the codec spells it.
std::size_t encoded_bytes(const ReferencePoint& point);

/// Adds a point. What no message could carry is halved: first by scans, then by readings. The place stays the same, nothing is
/// dropped.
void add_point(ReferencePoint point, SizedPoints& points, BytesOf bytes_of = encoded_bytes);

/// The points in lists that fit a survey message each, in the same order. The same points give the same lists.
std::vector<std::vector<ReferencePoint>> in_messages(SizedPoints points);

}  // namespace wayfuse
