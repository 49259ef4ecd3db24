#include "sdk/src/simulator/tracked_phone.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace wayfuse::simulator {
namespace {

constexpr const char* kWifiAlone = "wknn";   // the preset with the fingerprint fix and nothing else

MotionTracker default_tracker() {
  auto tracker = MotionTracker::create({});
  if (!tracker) throw std::logic_error("the default heading estimator is not in the catalogue");
  return std::move(tracker).value();
}

Heading in_building(const Welcome& welcome, const MotionReport& motion) {
  const Georeference frame = welcome.georeference.value_or(Georeference{});   // without one, y is taken for north
  if (motion.reference != HeadingReference::kMagnetic) return frame.to_building(motion.heading);
  return frame.to_building(motion.heading.turned_by(-welcome.magnetic_field.declination_rad));
}

}  // namespace

void ErrorLog::add(const Place& estimate, const Place& truth) {
  errors_m_.push_back(distance_m(estimate.point, truth.point));
  floors_right_ += estimate.floor == truth.floor;
}

void ErrorLog::append(const ErrorLog& other) {
  errors_m_.insert(errors_m_.end(), other.errors_m_.begin(), other.errors_m_.end());
  floors_right_ += other.floors_right_;
}

double ErrorLog::mean_m() const {
  if (errors_m_.empty()) return 0.0;
  return std::accumulate(errors_m_.begin(), errors_m_.end(), 0.0) / static_cast<double>(errors_m_.size());
}

double ErrorLog::percentile_m(double share) const {
  if (errors_m_.empty()) return 0.0;
  std::vector<double> sorted = errors_m_;
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size() - 1));
  std::ranges::nth_element(sorted, sorted.begin() + rank);
  return sorted[static_cast<std::size_t>(rank)];
}

double ErrorLog::floor_share() const {
  return errors_m_.empty() ? 0.0 : static_cast<double>(floors_right_) / static_cast<double>(errors_m_.size());
}

TrackedPhone::TrackedPhone(std::unique_ptr<PhoneFeed> feed, TrackedPhoneSettings settings, Client::LinkFactory links,
                           Scheduler& scheduler, Random random)
    : feed_(std::move(feed)), motion_(default_tracker()) {
  settings.client.device_model = feed_->device_model();
  main_ = std::make_unique<Client>(settings.client, events_into(fused_, true), links, scheduler, random.split());
  if (settings.compare) {
    ClientSettings wifi = settings.client;
    wifi.pipeline = kWifiAlone;
    wifi_client_ = std::make_unique<Client>(std::move(wifi), events_into(wifi_alone_, false), links, scheduler, random.split());
  }
}

ClientEvents TrackedPhone::events_into(ErrorLog& log, bool main) {
  ClientEvents events;
  events.position = [this, &log, main](const Position& position) {
    if (const auto truth = feed_->truth_at(position.position.valid_at)) log.add(position.position.place, *truth);
    if (!main) return;
    ++positions_;
    motion_.taught(position.position);
    position_ = position.position;
  };
  events.fault = [this](const FaultReport& report) { fault_ = report.fault; };
  events.samples_lost = [this](std::uint64_t first, std::uint64_t last) { samples_lost_ += last - first + 1; };
  if (main) {
    events.welcomed = [this](const Welcome& welcome) {
      motion_.expect(welcome.magnetic_field);
      welcome_ = welcome;
      reckon();
    };
  }
  return events;
}

void TrackedPhone::start() {
  main_->start();
  if (wifi_client_) wifi_client_->start();
}

void TrackedPhone::stop() {
  main_->stop();
  if (wifi_client_) wifi_client_->stop();
}

bool TrackedPhone::all_acknowledged() const {
  const auto done = [](const Client& client) { return client.acked_through() == client.last_sequence(); };
  return done(*main_) && (!wifi_client_ || done(*wifi_client_));
}

bool TrackedPhone::settled() const {
  const auto over = [](const Client& client) { return client.state() == ClientState::kEnded; };
  return all_acknowledged() || over(*main_) || (wifi_client_ && over(*wifi_client_));
}

void TrackedPhone::reckon() {
  if (!welcome_) return;
  for (const MotionReport& motion : unreckoned_) {
    const auto truth = feed_->truth_at(motion.time);
    if (!reckoned_) {
      reckoned_ = truth;
      continue;
    }
    const Heading heading = in_building(*welcome_, motion);
    reckoned_->point.x_m += motion.distance_m() * heading.cos();
    reckoned_->point.y_m += motion.distance_m() * heading.sin();
    if (!truth) continue;
    reckoned_->floor = truth->floor;   // reckoning has no floor of its own: it is given the true one
    reckoned_log_.add(*reckoned_, *truth);
  }
  unreckoned_.clear();
}

void TrackedPhone::live_through(const RecordedEvent& event) {
  std::optional<SampleBody> sample;
  if (const auto* marg = std::get_if<MargSample>(&event)) {
    if (const auto report = motion_.feed(*marg)) {
      sample = *report;
      unreckoned_.push_back(*report);
      reckon();
    }
  } else if (const auto* scan = std::get_if<RssScan>(&event)) {
    sample = *scan;
  } else if (const auto* fix = std::get_if<GnssFix>(&event)) {
    sample = *fix;
  }
  if (!sample) return;
  for (Client* client : {main_.get(), wifi_client_.get()}) {
    if (!client) continue;
    if (const auto sent = client->send(*sample); !sent) fault_ = sent.fault();
  }
}

bool TrackedPhone::advance(PhoneTime now) {
  while (feed_->next_time() <= now) {
    const auto event = feed_->next();
    if (!event) return false;
    live_through(*event);
  }
  return true;
}

}  // namespace wayfuse::simulator
