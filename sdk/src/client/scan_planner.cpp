#include "wayfuse/sdk/scan_planner.hpp"

#include <algorithm>

namespace wayfuse {
namespace {

using namespace std::chrono_literals;

/// So many scans in any window of that length.
struct Throttle {
  std::size_t scans;
  Duration window;
};

constexpr Duration kMargin = 1s;  // the platform's clock is not ours

std::optional<Throttle> throttle_of(ScanPlatform platform) {
  switch (platform) {
    case ScanPlatform::kAndroidForeground:
      return Throttle{4, 120s};
    case ScanPlatform::kAndroidBackground:
      return Throttle{1, 1800s};
    default:
      return std::nullopt;
  }
}

/// Without a server's wish: evenly within the throttle while walking, a few a while at rest.
Duration usual_interval(ScanPlatform platform, bool at_rest) {
  if (at_rest) return std::max<Duration>(120s, platform == ScanPlatform::kAndroidBackground ? 1800s : 0s);
  const auto throttle = throttle_of(platform);
  return throttle ? throttle->window / static_cast<int>(throttle->scans) : 5s;
}

}  // namespace

void ScanPlanner::started(PhoneTime now) {
  starts_.push_back(now);
  if (starts_.size() > 4) starts_.pop_front();
}

void ScanPlanner::moved(bool at_rest, PhoneTime now) {
  if (!at_rest) {
    resting_since_.reset();
  } else if (!resting_since_) {
    resting_since_ = now;
  }
}

ScanAdvice ScanPlanner::advise(PhoneTime now) const {
  if (platform_ == ScanPlatform::kIos)
    return {false, std::nullopt, "iOS lets no application scan: positions rest on motion and satellite fixes"};
  const bool at_rest = resting_since_ && now - *resting_since_ >= 10s;
  if (hint_ && hint_->interval == Duration{0}) return {true, std::nullopt, "the server needs no scan for now"};
  const Duration interval = at_rest ? std::max(usual_interval(platform_, true), hint_ ? hint_->interval : Duration{0})
                                    : (hint_ ? hint_->interval : usual_interval(platform_, false));
  PhoneTime at = starts_.empty() ? now : std::max(now, starts_.back() + interval);
  std::string_view why = at_rest ? "at rest: few scans are enough" : "evidence for the position";
  const auto throttle = throttle_of(platform_);
  if (throttle && starts_.size() >= throttle->scans) {
    const PhoneTime allowed = starts_[starts_.size() - throttle->scans] + throttle->window + kMargin;
    if (allowed > at) {
      at = allowed;
      why = "the platform's limit: sooner it would hand out old results";
    }
  }
  return {true, at, why};
}

}  // namespace wayfuse
