#include "server/sessions/timeline.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sessions/session_house.hpp"

namespace wayfuse {
namespace {

/// Writes down what it was fed.
class WritingTracker final : public Tracker {
 public:
  void feed(const MotionReport& motion) override { note('m', motion.time); }
  void feed(const RssScan& scan) override { note('s', scan.time); }
  void feed(const GnssFix& fix) override { note('g', fix.time); }
  std::optional<FusedPosition> position(PhoneTime) const override { return std::nullopt; }
  Fault why_no_fix() const override { return {FaultCode::kNoKnownAccessPoint, "", ""}; }
  std::unique_ptr<Tracker> clone() const override { return std::make_unique<WritingTracker>(*this); }
  std::string written;

 private:
  void note(char kind, PhoneTime time) {
    written += kind + std::to_string(time.time_since_epoch() / std::chrono::milliseconds(100)) + " ";
  }
};

std::string written(const Timeline& timeline) {
  return dynamic_cast<const WritingTracker&>(timeline.tracker()).written;
}

SampleBody scan_at(double time_s) {
  return RssScan{at(time_s), {}};
}

TEST(Timeline, AppliesAtOnceWhatComesInOrder) {
  Timeline timeline(std::make_unique<WritingTracker>());
  EXPECT_TRUE(timeline.take({1, step_at(1.0)}));
  timeline.catch_up();
  EXPECT_EQ(written(timeline), "m10 ");
  EXPECT_TRUE(timeline.take({2, scan_at(1.2)}));
  timeline.catch_up();
  EXPECT_EQ(written(timeline), "m10 s12 ");
  EXPECT_EQ(timeline.rewinds(), 0u);
}

TEST(Timeline, GoesBackForAStragglerInsideTheWindow) {
  Timeline timeline(std::make_unique<WritingTracker>());
  for (int i = 1; i <= 50; ++i) {
    EXPECT_TRUE(timeline.take({static_cast<std::uint64_t>(i), step_at(0.1 * i)}));
    timeline.catch_up();
  }
  std::string in_order;
  for (int i = 1; i <= 50; ++i) in_order += (i == 31 ? "s30 " : "") + ("m" + std::to_string(i)) + " ";
  EXPECT_TRUE(timeline.take({51, scan_at(3.0)}));  // exactly two seconds before the newest: still inside
  timeline.catch_up();
  EXPECT_EQ(written(timeline), in_order);
  EXPECT_EQ(timeline.rewinds(), 1u);
}

TEST(Timeline, RefusesWhatIsOlderThanTheWindow) {
  Timeline timeline(std::make_unique<WritingTracker>());
  EXPECT_TRUE(timeline.take({1, step_at(10.0)}));
  EXPECT_FALSE(timeline.take({2, scan_at(7.999)}));
  EXPECT_TRUE(timeline.take({3, scan_at(8.0)}));
  timeline.catch_up();
  EXPECT_EQ(written(timeline), "s80 m100 ");
}

// R16: any permutation within the reorder window ends in the same state.
TEST(Timeline, EveryOrderOfArrivalInsideTheWindowEndsTheSame) {
  std::vector<SampleBody> walk;
  for (int i = 0; i < 80; ++i) {
    walk.push_back(step_at(0.2 * i + 0.05));
    if (i % 5 == 0) walk.push_back(scan_at(0.2 * i + 0.05));  // the same instant as the step
  }
  Random random(11);
  std::string expected;
  for (int trial = 0; trial < 200; ++trial) {
    // Each piece arrives up to 1.9 s after its time.
    std::vector<std::pair<double, SampleBody>> arrivals;
    for (const SampleBody& body : walk) {
      const double delay_s = trial == 0 ? 0.0 : 1.9 * random.uniform();
      arrivals.emplace_back(seconds(time_of(body).time_since_epoch()) + delay_s, body);
    }
    std::ranges::stable_sort(arrivals, {}, &std::pair<double, SampleBody>::first);
    Timeline timeline(std::make_unique<WritingTracker>());
    std::uint64_t sequence = 0;
    for (const auto& [_, body] : arrivals) {
      ASSERT_TRUE(timeline.take({++sequence, body}));
      if (random.below(3) == 0) timeline.catch_up();
    }
    timeline.catch_up();
    if (trial == 0) expected = written(timeline);
    ASSERT_EQ(written(timeline), expected) << "trial " << trial;
  }
}

/// Its trackers go on with what the older one wrote, and sign it.
class SigningFactory final : public TrackerFactory {
 public:
  explicit SigningFactory(std::string name) : name_(std::move(name)) {}
  std::unique_ptr<Tracker> make_tracker(Random, const std::optional<KnownStart>&) const override { return nullptr; }
  std::unique_ptr<Tracker> take_over(const Tracker& older) const override {
    auto taken = std::make_unique<WritingTracker>(dynamic_cast<const WritingTracker&>(older));
    taken->written += name_ + " ";
    return taken;
  }
  const PipelineSpec& spec() const override { return spec_; }

 private:
  std::string name_;
  PipelineSpec spec_;
};

TEST(Timeline, AnExchangeHappensAtItsMomentOfEvidenceWhateverArrivesWhen) {
  Timeline timeline(std::make_unique<WritingTracker>());
  EXPECT_TRUE(timeline.take({1, step_at(1.0)}));
  EXPECT_TRUE(timeline.take({2, step_at(2.0)}));
  timeline.catch_up();
  timeline.exchange(std::make_shared<SigningFactory>("B"), Random(1), 2);
  EXPECT_TRUE(timeline.take({3, scan_at(2.0)}));  // of the very instant, and yet before it
  timeline.catch_up();
  EXPECT_EQ(written(timeline), "m10 m20 s20 B ");
  timeline.exchange(std::make_shared<SigningFactory>("C"), Random(1), 3);
  EXPECT_TRUE(timeline.take({4, step_at(3.0)}));
  EXPECT_TRUE(timeline.take({5, scan_at(1.5)}));  // a straggler is the older tracker's
  timeline.catch_up();
  EXPECT_EQ(written(timeline), "m10 s15 m20 s20 B C m30 ");
}

TEST(Timeline, LetsGoOfTheOlderPipelineOnceNoStragglerCanAskForIt) {
  Timeline timeline(std::make_unique<WritingTracker>());
  EXPECT_TRUE(timeline.take({1, step_at(1.0)}));
  timeline.catch_up();
  auto b = std::make_shared<SigningFactory>("B");
  const std::weak_ptr<const TrackerFactory> watched = b;
  timeline.exchange(std::move(b), Random(1), 1);
  for (std::uint64_t i = 2; !watched.expired() && i < 30; ++i) {
    EXPECT_TRUE(timeline.take({i, step_at(0.5 + 0.5 * static_cast<double>(i))}));
    timeline.catch_up();
  }
  EXPECT_TRUE(watched.expired());
  EXPECT_LE(seconds(timeline.newest()->time_since_epoch()), 1.0 + 2.0 * seconds(Timeline::kCopyEvery + Timeline::kWindow));
}

TEST(Timeline, AFloodShortensTheWindowInsteadOfFillingMemory) {
  Timeline timeline(std::make_unique<WritingTracker>());
  RssScan crowded{at(1.0), std::vector<ScanReading>(Limits::kReadingsPerScan)};
  for (std::uint64_t i = 0; i < 100; ++i) {
    crowded.time += Duration{1};
    EXPECT_TRUE(timeline.take({i + 1, crowded}));
    timeline.catch_up();
  }
  EXPECT_FALSE(timeline.take({101, scan_at(0.5)}));  // inside two seconds, but the copy it would need is gone
}

}  // namespace
}  // namespace wayfuse
