#include "server/app.hpp"

#include <fcntl.h>
#include <sodium.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "admin/api.hpp"
#include "admin/maps_api.hpp"
#include "server/metrics.hpp"
#include "server/quality/map_gate.hpp"

namespace wayfuse {
namespace {

// The server must be gone 10 s after SIGTERM [SAFETY C20]; the store's last commit and the joins need a part of that.
constexpr Duration kDrainMost = std::chrono::seconds(8);
constexpr Duration kForgetEvery = std::chrono::hours(1);
constexpr Duration kGoneShown = std::chrono::seconds(30);
constexpr Duration kVersionsApart = std::chrono::seconds(2);
constexpr int kReviewEverySweeps = 60;

std::uint64_t random_bits() {
  std::uint64_t bits = 0;
  randombytes_buf(&bits, sizeof bits);
  return bits;
}

std::string random_text(std::size_t bytes) {
  std::string random(bytes, '\0');
  randombytes_buf(random.data(), random.size());
  std::string text(sodium_base64_encoded_len(bytes, sodium_base64_VARIANT_URLSAFE_NO_PADDING), '\0');
  sodium_bin2base64(text.data(), text.size(), reinterpret_cast<const unsigned char*>(random.data()), random.size(),
                    sodium_base64_VARIANT_URLSAFE_NO_PADDING);
  text.pop_back();  // its final zero
  return text;
}

SessionNames random_names() {
  return {[] { return random_text(24); }, [] { return "phone-" + random_text(6); }, random_bits};
}

std::uint64_t random_epoch() {
  return 1 + random_bits() % static_cast<std::uint64_t>(Limits::kLargestInteger);
}

void allow_many_descriptors() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

Result<void> write_secret(const std::filesystem::path& file, const std::string& secret) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  const std::string line = secret + "\n";
  const bool written = descriptor >= 0 && ::write(descriptor, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  const int error = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (!written) return Fault{FaultCode::kStorageFailed, "server.first_key_file", file.string() + ": " + std::strerror(error)};
  return {};
}

}  // namespace

App::App(ServerConfig config, std::unique_ptr<DatabaseDirectory> store)
    : config_(std::move(config)),
      log_(config_.log_level),
      store_(std::move(store)),
      workers_(config_.workers),
      keeper_(*store_, shelf_, [this](std::function<void()> task) { workers_.run(std::move(task)); }, keeper_settings()),
      access_points_(*store_, shelf_, [this] { return clock_.wall_now(); }, [this](BuildingId building) { keeper_.refresh(building); }),
      maps_(*store_, shelf_, keeper_, access_points_, [this](std::function<void()> task) { workers_.run(std::move(task)); },
            [this] { return clock_.wall_now(); }),
      sessions_(random_epoch(), random_names(), config_.shelf),
      zones_(*store_, clock_, sessions_.epoch(), config_.zones),
      webhooks_(*store_, zones_, clock_, config_.webhooks, random_bits()),
      session_world_{.clock = clock_,
                     .buildings = shelf_,
                     .sessions = sessions_,
                     .board = board_,
                     .store = *store_,
                     .counters = session_counters_,
                     .survey_changed = [this](BuildingId building) { keeper_.refresh(building); },
                     .settings = config_.sessions,
                     .zones = &zones_,
                     .heard = [this](std::uint64_t session, const Building& building, const RssScan& scan, const FusedPosition& position) {
                       access_points_.hear(session, building, scan, position);
                     },
                     .recordings = &recordings_,
                     .prepare = [this](std::shared_ptr<const Building> building, const std::string& pipeline) {
                       if (!building->is_first_to_prepare(pipeline)) return;
                       workers_.run([building = std::move(building), pipeline] { static_cast<void>(building->pipeline(pipeline)); });
                     }} {}

// Surveys of one building become one version every few seconds at most; a worse one does not come into force.
BuildingKeeper::Settings App::keeper_settings() {
  return {.least_between = kVersionsApart,
          .judge = [this](const Building& candidate, const Building* live,
                          const std::vector<StoredQualityWalk>& walks) { return judge_map(candidate, live, walks, clock_.wall_now()); },
          .now = [this] { return clock_.now(); },
          .wall_now = [this] { return clock_.wall_now(); }};
}

App::~App() {
  drain();
}

Result<std::unique_ptr<App>> App::start(ServerConfig config) {
  if (sodium_init() < 0) return Fault{FaultCode::kInternal, "", "libsodium does not start"};
  allow_many_descriptors();
  auto store = DatabaseDirectory::open(config.data, {});
  if (!store) return store.fault();
  std::unique_ptr<App> app(new App(std::move(config), *std::move(store)));
  if (const auto opened = app->open(); !opened) return opened.fault();
  return app;
}

Result<void> App::open() {
  auto keys = KeyRing::open(*store_, clock_);
  if (!keys) return keys.fault();
  keys_ = *std::move(keys);
  audit_ = std::make_unique<AuditTrail>(*store_, clock_);
  if (const auto loaded = ledger_.load(); !loaded) return loaded;
  router_ = std::make_unique<Router>(*keys_, audit_.get(), &ledger_);
  add_building_routes(*router_, *store_, *this);
  add_survey_routes(*router_, *store_, *this);
  add_operation_routes(*router_, *store_, *this, zones_);
  add_explanation_routes(*router_, *this);
  add_recording_routes(*router_, recording_desk_);
  add_zone_routes(*router_, *store_, zones_, *keys_, clock_);
  add_plan_routes(*router_, *store_, *this, zones_, [this](std::function<void()> task) { workers_.run(std::move(task)); });
  add_webhook_routes(*router_, *store_, webhooks_, clock_);
  add_data_routes(*router_, *store_, *this, zones_, webhooks_, clock_);
  add_map_routes(*router_, *store_, maps_);
  add_radio_routes(*router_, maps_);
  add_key_routes(*router_, *keys_, clock_);
  add_session_token_routes(*router_, *store_, *keys_);
  add_openapi_routes(*router_);
  add_console_routes(*router_);
  net_world_ = std::make_unique<NetWorld>(session_world_, *router_, *keys_, clock_, net_counters_, config_.net,
                                          [this](std::string_view what) { log_.error("accident", {{"what", std::string(what)}}); });
  auto listener = Listener::open(*net_world_);
  if (!listener) return listener.fault();
  listener_ = *std::move(listener);
  if (const auto made = make_first_key(); !made) return made.fault();

  const std::vector<BuildingId> there = store_->buildings();
  for (const BuildingId id : there) {
    keeper_.refresh(id);
    zones_.zones_changed(id);
    webhooks_.webhooks_changed(id);
  }
  webhooks_.start();
  listener_->every(kForgetEvery, [this] { forget(); });
  listener_->every(std::chrono::seconds(1), [this] { sweep(); });
  listener_->start(config_.io_threads);
  keeper_.wait_for_first_round(there);  // surveyors may already upload again: to wait for quiet would be to wait for them
  for (const auto& [id, fault] : store_->quarantined()) {
    log_.error("building_quarantined", {{"building", std::to_string(id.value)}, {"fault", to_string(fault)}});
  }
  for (const auto& [id, fault] : keeper_.failures()) {
    log_.error("building_not_ready", {{"building", std::to_string(id.value)}, {"fault", to_string(fault)}});
  }
  ready_ = true;
  log_.info("ready", {{"port", std::to_string(port())}, {"buildings", std::to_string(shelf_.all().size())}});
  return {};
}

Result<void> App::make_first_key() {
  if (!keys_->empty()) return {};
  auto issued = keys_->issue("first", {Scope::kAdmin, Scope::kSurvey, Scope::kTrack, Scope::kObserve}, {}, std::nullopt);
  if (!issued) return issued.fault();
  log_.info("first_key_made");
  if (!config_.first_key_file.empty()) return write_secret(config_.first_key_file, issued->key);
  first_key_ = issued->key;
  return {};
}

std::string App::url() const {
  const bool tls = !config_.net.tls_certificate.empty();
  const bool v6 = config_.net.address.find(':') != std::string::npos;
  return (tls ? "https://" : "http://") + (v6 ? "[" + config_.net.address + "]" : config_.net.address) + ":" +
         std::to_string(port());
}

void App::sweep() {
  for (const std::string& tracked : sessions_.sweep(clock_.now())) board_.gone(tracked, clock_.wall_now());
  board_.sweep(clock_.wall_now() - kGoneShown);
  recordings_.sweep();
  zones_.tick();
  keeper_.tick();
  if (++sweeps_ % kReviewEverySweeps == 0) access_points_.review();
}

// Retention [C19]. What fails now is tried again in an hour.
void App::forget() {
  const auto forgotten = store_->forget_audit(clock_.wall_now() - config_.audit_kept);
  if (!forgotten) log_.error("audit_not_forgotten", {{"fault", to_string(forgotten.fault())}});
}

void App::reload(const ServerConfig& wanted) {
  log_.set_level(wanted.log_level);
  for (const ConfigSetting& setting : config_settings()) {
    if (!setting.reloads && setting.show(wanted) != setting.show(config_)) log_.warn("restart_needed", {{"key", std::string(setting.key)}});
  }
  if (const auto loaded = listener_->reload_tls(); !loaded) return refuse_reload(loaded.fault());
  log_.info("reloaded");
}

void App::refuse_reload(const Fault& fault) {
  log_.error("reload_failed", {{"fault", to_string(fault)}});
}

// The order matters: while clients leave, the store still answers; when it has closed, its answers still find their strands.
void App::drain() {
  if (drained_) return;
  drained_ = true;
  ready_ = false;
  log_.info("draining", {{"connections", std::to_string(net_counters_.connections.load())}});
  if (listener_) listener_->drain(config_.drain_within, kDrainMost);
  webhooks_.stop();
  keeper_.stop();
  store_->close();
  workers_.stop();
  if (listener_) listener_->stop();
  log_.info("stopped");
  log_.flush();
}

Readiness App::readiness() const {
  Readiness readiness{ready_, {}};
  if (net_world_ && net_world_->draining) readiness.reasons.emplace_back("draining");
  if (!ready_ && readiness.reasons.empty()) readiness.reasons.emplace_back("radio maps are being built");
  return readiness;
}

std::vector<SessionSummary> App::sessions(BuildingId building) const {
  return board_.sessions(building);
}

std::string App::metrics() const {
  return metrics_text(session_world_, net_counters_, net_world_->budget, keeper_, zones_, webhooks_, access_points_.counts(), ready_);
}

std::vector<PartDescription> App::parts() const {
  return part_catalogue();
}

std::vector<std::string> App::presets() const {
  return preset_names();
}

Result<std::string> App::preset_json(const std::string& name) const {
  const auto spec = preset(name);
  if (!spec) return spec.fault();
  return to_json(*spec);
}

void App::building_changed(BuildingId building) {
  const auto there = store_->buildings();
  if (std::ranges::find(there, building) == there.end()) recordings_.erase_all(building, "");  // removed, with all that was recorded in it
  keeper_.refresh(building);
}

void App::building_made(BuildingId building, std::function<void()> served) {
  keeper_.refresh(building, std::move(served));
}

std::uint64_t App::radio_map_version(BuildingId building) const {
  const auto snapshot = shelf_.find(building);
  return snapshot ? snapshot->map_version() : 0;
}

Result<Explanation> App::explain(const std::string& tracked, BuildingId building) const {
  const auto session = sessions_.find_tracked(tracked);
  const auto in = session ? session->building() : nullptr;
  if (!session || (building.value != 0 && (!in || in->record().id != building))) {
    return Fault{FaultCode::kNotFound, "tracked", "there is no live session of this name here"};
  }
  return session->explain();
}

}  // namespace wayfuse
