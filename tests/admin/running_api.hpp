#pragma once

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "admin/api.hpp"
#include "admin/audit_trail.hpp"
#include "admin/idempotency.hpp"
#include "admin/maps_api.hpp"
#include "server/webhooks/webhook_sender.hpp"
#include "server/zones/zone_watch.hpp"
#include "tests/admin/fake_maps.hpp"
#include "tests/admin/fake_recordings.hpp"
#include "tests/admin/schema_check.hpp"

namespace wayfuse {

/// The whole admin API over a real store in a temporary folder, without a server around it.
class RunningApi {
 public:
  class FixedClock final : public Clock {
   public:
    ServerTime now() const override { return ServerTime{} + shift; }
    UnixTime wall_now() const override { return UnixTime{std::chrono::seconds(1'800'000'000)} + shift; }
    Duration shift{0};
  };

  /// Remembers what the API told it and shows two sessions.
  class FakeServer final : public ServerControl {
   public:
    Readiness readiness() const override { return {ready, ready ? std::vector<std::string>{} : std::vector<std::string>{"draining"}}; }
    std::vector<SessionSummary> sessions(BuildingId building) const override {
      std::vector<SessionSummary> found;
      for (const std::uint64_t id : {1u, 2u}) {
        if (building.value != 0 && building.value != id) continue;
        SessionSummary session;
        session.tracked = "phone-" + std::to_string(id);
        session.building = {id};
        found.push_back(session);
      }
      return found;
    }
    std::string metrics() const override { return "# TYPE wayfuse_sessions gauge\nwayfuse_sessions 2\n"; }
    std::vector<PartDescription> parts() const override { return {{"locator", "wknn", "Nearest", {{"k", 4, 1, 64, "neighbours", "[P1]"}}}}; }
    std::vector<std::string> presets() const override { return {"default", "p1"}; }
    Result<std::string> preset_json(const std::string& name) const override {
      if (name == "p1") return std::string(R"({"name":"p1","parts":{}})");
      return Fault{FaultCode::kUnknownName, "pipeline", "'" + name + "' is none of default, p1"};
    }
    void building_changed(BuildingId building) override { changed.push_back(building); }
    void building_made(BuildingId building, std::function<void()> served) override {
      changed.push_back(building);
      served();
    }
    std::uint64_t radio_map_version(BuildingId) const override { return 7; }

    bool ready = true;
    std::vector<BuildingId> changed;
  };

  /// Knows phone-1 in building 1 only.
  class FakeSessions final : public SessionControl {
   public:
    Result<Explanation> explain(const std::string& tracked, BuildingId building) const override {
      if (tracked == "phone-3") return Fault{FaultCode::kConflict, "position", "there is none: nothing heard"};
      if (tracked != "phone-1" || building.value > 1) return Fault{FaultCode::kNotFound, "tracked", "there is no live session of this name here"};
      Explanation explanation{.tracked = tracked, .pipeline = "p1", .position = {}, .readings = {}, .surveyed_points = 8,
                              .doubts = {"it rains"}, .remarks = {}, .particles = {{{1.5, 2.5}, 1.0}}};
      explanation.position.building = {1};
      explanation.position.integrity = Integrity::kDegraded;
      explanation.position.floors = {{FloorOrdinal{2}, 0.75}, {FloorOrdinal{1}, 0.25}};
      explanation.position.from.scan_age = std::chrono::milliseconds(1500);
      explanation.readings = {{Bssid{1}, -61.0, std::chrono::milliseconds(300), "", -55.0, 24}, {Bssid{2}, -70.0, {}, "not on the map", {}, 0}};
      return explanation;
    }
  };

  struct Answer {
    int status;
    std::string body;
    std::map<std::string, std::string> headers;
    std::string content_type;
    std::shared_ptr<BodySource> stream;
    nlohmann::json json() const { return nlohmann::json::parse(body); }
  };

  RunningApi() {
    folder = std::filesystem::temp_directory_path() /
             ("wayfuse-admin-" + std::to_string(::getpid()) + "-" + std::to_string(counter()++));
    DatabaseDirectory::Options options;
    options.own_thread = false;
    auto opened = DatabaseDirectory::open(folder, options);
    if (!opened) throw std::runtime_error(to_string(opened.fault()));
    store = std::move(*opened);
    auto ring = KeyRing::open(*store, clock);
    if (!ring) throw std::runtime_error(to_string(ring.fault()));
    keys = std::move(*ring);
    audit = std::make_unique<AuditTrail>(*store, clock);
    ledger = std::make_unique<IdempotencyLedger>(*store, clock);
    router = std::make_unique<Router>(*keys, audit.get(), ledger.get());
    zones = std::make_unique<ZoneWatch>(*store, clock, 1000, ZoneRules{});
    add_building_routes(*router, *store, server);
    add_survey_routes(*router, *store, server);
    add_operation_routes(*router, *store, server, *zones);
    add_explanation_routes(*router, sessions);
    add_recording_routes(*router, recordings);
    add_zone_routes(*router, *store, *zones, *keys, clock);
    webhooks = std::make_unique<WebhookSender>(*store, *zones, clock, WebhookSettings{}, 1);
    add_plan_routes(*router, *store, server, *zones, [](std::function<void()> task) { task(); });
    add_webhook_routes(*router, *store, *webhooks, clock);
    add_data_routes(*router, *store, server, *zones, *webhooks, clock);
    add_map_routes(*router, *store, maps);
    add_radio_routes(*router, maps);
    add_key_routes(*router, *keys, clock);
    add_session_token_routes(*router, *store, *keys);
    add_openapi_routes(*router);
    add_console_routes(*router);
    admin = issue({Scope::kAdmin, Scope::kSurvey, Scope::kTrack, Scope::kObserve}, {});
  }
  ~RunningApi() {
    store->close();
    std::filesystem::remove_all(folder);
  }

  std::string issue(std::vector<Scope> scopes, BuildingId building, std::optional<UnixTime> expires = {}, bool coarse = false) {
    return keys->issue("test", std::move(scopes), building, expires, coarse)->key;
  }

  Answer ask(const std::string& method, std::string path, const std::string& key, std::string body = {},
             std::map<std::string, std::string> headers = {}) {
    Request request;
    request.headers = std::move(headers);
    request.method = method;
    if (const auto mark = path.find('?'); mark != std::string::npos) {
      std::istringstream query(path.substr(mark + 1));
      for (std::string pair; std::getline(query, pair, '&');) {
        const auto equals = std::min(pair.find('='), pair.size());
        request.query[pair.substr(0, equals)] = equals < pair.size() ? pair.substr(equals + 1) : "";
      }
      path.resize(mark);
    }
    request.path = path;
    request.body = std::move(body);
    if (!key.empty()) request.headers["authorization"] = "Bearer " + key;
    std::optional<Response> response;
    router->handle(request, [&](Response answer) { response = std::move(answer); });
    if (!response) throw std::logic_error(method + " " + path + " was not answered");
    Answer answer{response->status, response->body, response->headers, response->content_type, response->stream};
    // Every answer that any test provokes is one that the description knows, body and all.
    EXPECT_EQ(description().misfit(method, path, {answer.status, answer.content_type, answer.body, answer.headers}), "") << method << " " << path;
    return answer;
  }

  std::filesystem::path folder;
  FixedClock clock;
  FakeServer server;
  FakeSessions sessions;
  FakeMaps maps;
  FakeRecordings recordings;
  std::unique_ptr<DatabaseDirectory> store;
  std::unique_ptr<KeyRing> keys;
  std::unique_ptr<AuditTrail> audit;
  std::unique_ptr<IdempotencyLedger> ledger;
  std::unique_ptr<ZoneWatch> zones;
  std::unique_ptr<WebhookSender> webhooks;  // not started: it keeps its queue
  std::unique_ptr<Router> router;
  std::string admin;

 private:
  // What the server itself hands out.
  const ApiDescription& description() {
    static const ApiDescription described = [this] {
      std::string document;
      Request request;
      request.method = "GET";
      request.path = "/v1/openapi.json";
      router->handle(request, [&](Response response) { document = std::move(response.body); });
      return ApiDescription(nlohmann::json::parse(document));
    }();
    return described;
  }

  static int& counter() {
    static int count = 0;
    return count;
  }
};

}  // namespace wayfuse
