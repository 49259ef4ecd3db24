#include "server/sessions/scan_wishes.hpp"

namespace wayfuse {
namespace {

constexpr int kAgreed = 3;
constexpr double kGoodRadius_m = 6.0;        // of the 68 % circle
constexpr double kSureOfFloor = 0.9;
constexpr double kStill_mps = 0.1;
constexpr Duration kInDoubt = std::chrono::seconds(2);
constexpr Duration kWalking = std::chrono::seconds(5);

bool is_good(const FusedPosition& position) {
  const bool floor_known = position.floors.empty() || position.floors.front().probability >= kSureOfFloor;
  return position.integrity == Integrity::kOk && position.radius68_m <= kGoodRadius_m && floor_known;
}

}  // namespace

std::optional<ScanHint> ScanWishes::after(const FusedPosition& position) {
  if (!is_good(position)) return settle(Wish::kDoubt);
  return settle(position.speed_mps < kStill_mps ? Wish::kResting : Wish::kWalking);
}

std::optional<ScanHint> ScanWishes::without_position() { return settle(Wish::kDoubt); }

std::optional<ScanHint> ScanWishes::settle(Wish wish) {
  agreed_ = wish == wished_ ? agreed_ + 1 : 1;
  wished_ = wish;
  if (wish == told_ || agreed_ < kAgreed) return std::nullopt;
  told_ = wish;
  switch (wish) {
    case Wish::kResting: return ScanHint{Duration{0}, false, "at rest, the position is good"};
    case Wish::kWalking: return ScanHint{kWalking, false, "walking, the position is good"};
    default: return ScanHint{kInDoubt, true, "the position is in doubt"};
  }
}

}  // namespace wayfuse
