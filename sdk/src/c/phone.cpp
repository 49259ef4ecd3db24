#include "sdk/src/c/phone.hpp"

#include <algorithm>
#include <chrono>
#include <random>

#include "wayfuse/proto/codec.hpp"

namespace wayfuse {
namespace {

constexpr int kPostedMost = 4096;
constexpr std::size_t kScansAtOnePoint = 4096;

std::uint64_t system_seed() {
  std::random_device device;
  return (std::uint64_t{device()} << 32) ^ device();
}

UnixTime wall_now() {
  return UnixTime{std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch())};
}

Fault wrong_state(const char* cause) {
  return {FaultCode::kUnexpectedMessage, "", cause};
}

}  // namespace

Result<std::unique_ptr<Phone>> Phone::create(PhoneSettings settings, PhoneEvents events) {
  auto motion = MotionTracker::create(settings.motion);
  if (!motion) return motion.fault();
  if (settings.seed == 0) settings.seed = system_seed();
  std::unique_ptr<Phone> phone(new Phone(std::move(settings), std::move(events), std::move(motion).value()));
  auto links = phone->loop_.links(phone->settings_.link);
  if (!links) return links.fault();
  phone->client_ = std::make_unique<Client>(phone->settings_.client, phone->client_events(), *links, phone->loop_,
                                            Random(phone->settings_.seed));
  phone->thread_ = std::thread([raw = phone.get()] { raw->loop_.run(); });
  return phone;
}

Phone::Phone(PhoneSettings settings, PhoneEvents events, MotionTracker motion)
    : settings_(std::move(settings)),
      events_(std::move(events)),
      motion_(std::move(motion)),
      scans_(settings_.platform),
      surveyor_(settings_.client.device_model, Random(settings_.seed ^ 0x5eed)) {}

Phone::~Phone() {
  if (!thread_.joinable()) return;
  loop_.post([this] {
    client_->stop();
    client_.reset();
    loop_.stop();
  });
  thread_.join();
  loop_.run_for(std::chrono::milliseconds(50));  // what the goodbye needs on a healthy network
}

ClientEvents Phone::client_events() {
  ClientEvents told;
  told.welcomed = [this](const Welcome& welcome) {
    is_recorded_ = welcome.is_recorded;
    const std::lock_guard lock(mutex_);
    position_.welcomed(welcome);
    motion_.expect(welcome.magnetic_field);
    scans_.forget_hint();
  };
  told.position = [this](const Position& position) {
    {
      const std::lock_guard lock(mutex_);
      position_.fused(position.position, loop_.now());
      motion_.taught(position.position);
    }
    if (events_.position) events_.position(position.position);
  };
  told.scan_hint = [this](const ScanHint& hint) {
    const std::lock_guard lock(mutex_);
    scans_.hinted(hint);
  };
  told.state_changed = [this](ClientState state) {
    state_ = state;
    if (events_.state_changed) events_.state_changed(state);
  };
  told.no_fix = [this](const NoFix& no_fix) {
    if (events_.fault) events_.fault(no_fix.reason);
  };
  told.fault = [this](const FaultReport& report) {
    if (events_.fault) events_.fault(report.fault);
  };
  told.survey_stored = [this](const SurveyAck& ack) {
    if (client_) uploads_waiting_ = client_->uploads_waiting();
    if (events_.survey_stored) events_.survey_stored(ack);
  };
  told.samples_lost = events_.samples_lost;
  told.disconnected = events_.disconnected;
  return told;
}

Result<void> Phone::post(std::function<void()> task) {
  if (posted_.fetch_add(1) >= kPostedMost) {
    posted_.fetch_sub(1);
    return Fault{FaultCode::kOverloaded, "", "the phone's thread is behind; is a callback blocking it?"};
  }
  loop_.post([this, task = std::move(task)] {
    posted_.fetch_sub(1);
    if (client_) task();
  });
  return {};
}

Result<void> Phone::start() {
  return post([this] { client_->start(); });
}
Result<void> Phone::stop() {
  return post([this] { client_->stop(); });
}
Result<void> Phone::network_changed() {
  return post([this] { client_->network_changed(); });
}

Result<void> Phone::feed(const MargSample& sample) {
  if (settings_.client.role != Role::kTrack) return wrong_state("motion is for the track role");
  std::optional<MotionReport> report;
  {
    const std::lock_guard lock(mutex_);
    report = motion_.feed(sample);
    if (!report) return {};
    position_.moved(*report);
    scans_.moved(report->at_rest, report->time);
  }
  return post([this, report = *report] {
    const auto kept = client_->send(report);
    if (!kept && events_.fault) events_.fault(kept.fault());
  });
}

Result<void> Phone::feed(const RssScan& scan) {
  if (settings_.client.role != Role::kTrack) return survey_scan(scan);
  if (auto checked = check(scan, "scan"); !checked) return checked;
  return post([this, scan] {
    const auto kept = client_->send(scan);
    if (!kept && events_.fault) events_.fault(kept.fault());
  });
}

Result<void> Phone::feed(const GnssFix& fix) {
  if (settings_.client.role != Role::kTrack) return wrong_state("satellite fixes are for the track role");
  if (auto checked = check(fix, "gnss"); !checked) return checked;
  return post([this, fix] {
    const auto kept = client_->send(fix);
    if (!kept && events_.fault) events_.fault(kept.fault());
  });
}

std::optional<LivePosition> Phone::position_now() {
  const std::lock_guard lock(mutex_);
  return position_.at(loop_.now());
}

MotionCalibration Phone::calibration() {
  const std::lock_guard lock(mutex_);
  return motion_.calibration();
}

ScanAdvice Phone::next_scan() {
  const std::lock_guard lock(mutex_);
  return scans_.advise(loop_.now());
}

void Phone::scan_started() {
  const std::lock_guard lock(mutex_);
  scans_.started(loop_.now());
}

Result<void> Phone::survey_scan(const RssScan& scan) {
  if (auto checked = check(scan, "scan"); !checked) return checked;
  const std::lock_guard lock(mutex_);
  if (walking_) return surveyor_.scan(scan, wall_now());
  if (!standing_) return wrong_state("neither a walk nor a point has begun");
  if (standing_->scans.size() >= kScansAtOnePoint) return Fault{FaultCode::kTooLarge, "scans", "too many at one point"};
  standing_->scans.push_back(scan);
  return {};
}

Result<void> Phone::begin_walk(std::string name) {
  const std::lock_guard lock(mutex_);
  if (standing_) return wrong_state("the point before has not ended");
  auto begun = surveyor_.begin_walk(std::move(name));
  if (begun) walking_ = true;
  return begun;
}

Result<void> Phone::mark(PhoneTime time, Place place, double sigma_m) {
  const std::lock_guard lock(mutex_);
  return surveyor_.mark(time, place, sigma_m);
}

Result<void> Phone::end_walk() {
  const std::lock_guard lock(mutex_);
  if (auto ended = surveyor_.end_walk(); !ended) return ended;
  walking_ = false;
  return upload_batches();
}

Result<void> Phone::begin_point(Place place, double sigma_m) {
  const std::lock_guard lock(mutex_);
  if (walking_ || standing_) return wrong_state("the walk or point before has not ended");
  standing_ = StandingPoint{place, sigma_m, {}};
  return {};
}

Result<void> Phone::end_point() {
  const std::lock_guard lock(mutex_);
  if (!standing_) return wrong_state("no point has begun");
  StandingPoint point = std::move(*standing_);
  standing_.reset();
  for (std::size_t begin = 0; begin < point.scans.size() || begin == 0; begin += Limits::kScansPerPoint) {
    const auto first = point.scans.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last =
        point.scans.begin() + static_cast<std::ptrdiff_t>(std::min(point.scans.size(), begin + Limits::kScansPerPoint));
    if (auto added = surveyor_.add_point(point.place, point.sigma_m, {first, last}, wall_now()); !added) return added;
  }
  return upload_batches();
}

/// The mutex is held. What the client's queue does not take is told as a fault; a survey of that size needs a network first.
Result<void> Phone::upload_batches() {
  if (settings_.client.role != Role::kSurvey) return wrong_state("uploads are for the survey role");
  for (SurveyBatch& batch : surveyor_.take_batches()) {
    ++uploads_waiting_;
    auto posted = post([this, batch = std::move(batch)] {
      const auto queued = client_->upload(batch);
      uploads_waiting_ = client_->uploads_waiting();
      if (!queued && events_.fault) events_.fault(queued.fault());
    });
    if (!posted) return posted;
  }
  return {};
}

}  // namespace wayfuse
