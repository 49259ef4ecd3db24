#include "sdk/src/client/point_batches.hpp"

#include <utility>

#include "wayfuse/proto/codec.hpp"

namespace wayfuse {
namespace {

constexpr std::size_t kBatchBytes = 60 * 1024;  // of points, as JSON; the rest of a frame is for key and wrapping

}  // namespace

std::size_t encoded_bytes(const ReferencePoint& point) { return encode(ClientMessage(SurveyBatch{"k", {point}}), Encoding::kJson).size(); }

void add_point(ReferencePoint point, SizedPoints& points, BytesOf bytes_of) {
  const std::size_t bytes = bytes_of(point);
  const bool many_scans = point.scans.size() > 1;
  if (bytes <= kBatchBytes || (!many_scans && point.scans.front().readings.size() < 2)) {
    points.emplace_back(std::move(point), bytes);
    return;
  }
  ReferencePoint rest = point;
  if (many_scans) {
    const auto half = static_cast<std::ptrdiff_t>(point.scans.size() / 2);
    rest.scans.erase(rest.scans.begin(), rest.scans.begin() + half);
    point.scans.erase(point.scans.begin() + half, point.scans.end());
  } else {
    auto& left = point.scans.front().readings;
    auto& right = rest.scans.front().readings;
    const auto half = static_cast<std::ptrdiff_t>(left.size() / 2);
    right.erase(right.begin(), right.begin() + half);
    left.erase(left.begin() + half, left.end());
  }
  add_point(std::move(point), points, bytes_of);
  add_point(std::move(rest), points, bytes_of);
}

std::vector<std::vector<ReferencePoint>> in_messages(SizedPoints points) {
  std::vector<std::vector<ReferencePoint>> messages;
  std::size_t bytes = 0;
  for (auto& [point, size] : points) {
    if (messages.empty() || bytes + size > kBatchBytes || messages.back().size() == Limits::kPointsPerBatch) {
      messages.emplace_back();
      bytes = 0;
    }
    messages.back().push_back(std::move(point));
    bytes += size;
  }
  return messages;
}

}  // namespace wayfuse
