#include "server/buildings/deaf_tracker.hpp"

#include <algorithm>

namespace wayfuse {
namespace {

using Distrusted = std::shared_ptr<const std::vector<Bssid>>;

class DeafTracker final : public Tracker {
 public:
  DeafTracker(Distrusted distrusted, std::unique_ptr<Tracker> tracker) : distrusted_(std::move(distrusted)), tracker_(std::move(tracker)) {}

  void feed(const MotionReport& motion) override { tracker_->feed(motion); }
  void feed(const GnssFix& fix) override { tracker_->feed(fix); }
  void feed(const RssScan& scan) override {
    const auto deaf = [&](const ScanReading& reading) { return std::ranges::binary_search(*distrusted_, reading.bssid); };
    if (std::ranges::none_of(scan.readings, deaf)) return tracker_->feed(scan);
    RssScan heard = scan;
    std::erase_if(heard.readings, deaf);
    tracker_->feed(heard);
  }
  std::optional<FusedPosition> position(PhoneTime at) const override { return tracker_->position(at); }
  Fault why_no_fix() const override { return tracker_->why_no_fix(); }
  std::vector<WeightedPlace> cloud(std::size_t most) const override { return tracker_->cloud(most); }
  std::vector<std::string> doubts(PhoneTime at) const override { return tracker_->doubts(at); }
  std::string left_out(const ScanReading& reading) const override {
    return std::ranges::binary_search(*distrusted_, reading.bssid) ? "the access point is distrusted" : tracker_->left_out(reading);
  }
  const Tracker& core() const override { return tracker_->core(); }
  std::unique_ptr<Tracker> clone() const override { return std::make_unique<DeafTracker>(distrusted_, tracker_->clone()); }

 private:
  Distrusted distrusted_;
  std::unique_ptr<Tracker> tracker_;
};

class DeafFactory final : public TrackerFactory {
 public:
  DeafFactory(std::vector<Bssid> distrusted, std::shared_ptr<const TrackerFactory> pipeline)
      : distrusted_(std::make_shared<const std::vector<Bssid>>(std::move(distrusted))), pipeline_(std::move(pipeline)) {}

  std::unique_ptr<Tracker> make_tracker(Random random, const std::optional<KnownStart>& start) const override {
    return std::make_unique<DeafTracker>(distrusted_, pipeline_->make_tracker(random, start));
  }
  std::unique_ptr<Tracker> take_over(const Tracker& older) const override {
    auto taken = pipeline_->take_over(older.core());
    return taken ? std::make_unique<DeafTracker>(distrusted_, std::move(taken)) : nullptr;
  }
  const PipelineSpec& spec() const override { return pipeline_->spec(); }
  std::vector<std::string> remarks() const override { return pipeline_->remarks(); }
  std::string learnt() const override { return pipeline_->learnt(); }

 private:
  Distrusted distrusted_;
  std::shared_ptr<const TrackerFactory> pipeline_;
};

}  // namespace

std::shared_ptr<const TrackerFactory> deaf_to(std::vector<Bssid> distrusted, std::shared_ptr<const TrackerFactory> pipeline) {
  if (distrusted.empty()) return pipeline;
  return std::make_shared<DeafFactory>(std::move(distrusted), std::move(pipeline));
}

}  // namespace wayfuse
