#pragma once

#include <algorithm>

#include "proto/src/wire/fields.hpp"

/// The field tables of the messages; see fields.hpp.
namespace wayfuse::wire {

// clang-format off
template <> inline constexpr std::string_view kWireName<Hello> = "hello";
template <> inline constexpr std::string_view kWireName<SampleBatch> = "samples";
template <> inline constexpr std::string_view kWireName<SurveyBatch> = "survey";
template <> inline constexpr std::string_view kWireName<SurveyWalk> = "survey_walk";
template <> inline constexpr std::string_view kWireName<Subscribe> = "subscribe";
template <> inline constexpr std::string_view kWireName<TokenRefresh> = "token";
template <> inline constexpr std::string_view kWireName<ClockProbe> = "clock_probe";
template <> inline constexpr std::string_view kWireName<Goodbye> = "goodbye";
template <> inline constexpr std::string_view kWireName<Welcome> = "welcome";
template <> inline constexpr std::string_view kWireName<Ack> = "ack";
template <> inline constexpr std::string_view kWireName<SurveyAck> = "survey_ack";
template <> inline constexpr std::string_view kWireName<Position> = "position";
template <> inline constexpr std::string_view kWireName<NoFix> = "no_fix";
template <> inline constexpr std::string_view kWireName<Observation> = "observation";
template <> inline constexpr std::string_view kWireName<ZoneEvent> = "zone_event";
template <> inline constexpr std::string_view kWireName<TokenAccepted> = "token_accepted";
template <> inline constexpr std::string_view kWireName<ClockAnswer> = "clock_answer";
template <> inline constexpr std::string_view kWireName<ScanHint> = "scan_hint";
template <> inline constexpr std::string_view kWireName<Ticket> = "ticket";
template <> inline constexpr std::string_view kWireName<FaultReport> = "fault";
template <> inline constexpr std::string_view kWireName<GoAway> = "go_away";
// clang-format on

// ---------------------------------------------------------------- client -> server

template <typename V, Of<Resume> S>
void describe(V& v, S& resume) {
  v.required("session", resume.session, kKey);
  v.required("epoch", resume.epoch, kCounter);
  v.required("acked_through", resume.acked_through, kCounter);
  v.defaulted("ticket", resume.ticket, Bytes{Limits::kTicketBytes});
}

template <typename V, Of<Hello> S>
void describe(V& v, S& hello) {
  v.required("role", hello.role, Choice{kRoleNames});
  v.defaulted("building", hello.building, kCounter);
  v.defaulted("token", hello.token, kName);
  v.defaulted("device_model", hello.device_model, kName);
  v.defaulted("app", hello.app, kName);
  v.defaulted("pipeline", hello.pipeline, kName);
  v.required("phone_time_us", hello.phone_time, kPhoneTime);
  v.optional("resume", hello.resume, Object{});
}

template <typename V, Of<Sample> S>
void describe(V& v, S& sample) {
  v.alternatives("kind", sample.body);
}

template <typename V, Of<SampleBatch> S>
void describe(V& v, S& batch) {
  std::uint64_t first = batch.samples.empty() ? 1 : batch.samples.front().sequence;
  v.required("first_sequence", first, Integer{1, 9'000'000'000'000'000});
  v.required("samples", batch.samples, List{1, Limits::kSamplesPerBatch, Object{}});
  if constexpr (V::kReads) {
    for (Sample& sample : batch.samples) sample.sequence = first++;
  } else {
    v.expect("samples", FaultCode::kOutOfRange, "the sample numbers are not consecutive", [&] {
      return std::ranges::all_of(batch.samples, [&](const Sample& sample) { return sample.sequence == first++; });
    });
  }
}

template <typename V, Of<SurveyBatch> S>
void describe(V& v, S& batch) {
  v.required("idempotency_key", batch.idempotency_key, kKey);
  v.required("points", batch.points, List{1, Limits::kPointsPerBatch, Object{}});
}

template <typename V, Of<WayPoint> S>
void describe(V& v, S& point) {
  v.required("time_us", point.time, kPhoneTime);
  v.required("place", point.place, Object{});
  v.defaulted("sigma_m", point.sigma_m, kSurveySigma);
}

template <typename V, Of<SurveyWalk> S>
void describe(V& v, S& walk) {
  v.required("idempotency_key", walk.idempotency_key, kKey);
  v.required("walk", walk.walk, kSomeName);
  v.defaulted("part", walk.part, Integer{0, 9999});
  v.required("last", walk.last, Flag{});
  v.defaulted("device_model", walk.device_model, kName);
  v.required("wall_time_us", walk.wall_time, kUnixTime);
  v.required("phone_time_us", walk.phone_time, kPhoneTime);
  v.required("marks", walk.marks, List{0, Limits::kMarksPerWalkPart, Object{}});
  v.required("motion", walk.motion, List{0, Limits::kMotionPerWalkPart, Object{}});
  v.required("scans", walk.scans, List{0, Limits::kScansPerWalkPart, Object{}});
  constexpr const char* kOrder = "the times go backwards";
  v.expect("marks", FaultCode::kOutOfRange, kOrder, [&] { return std::ranges::is_sorted(walk.marks, {}, &WayPoint::time); });
  v.expect("motion", FaultCode::kOutOfRange, kOrder,
           [&] { return std::ranges::is_sorted(walk.motion, {}, &MotionReport::time); });
  v.expect("scans", FaultCode::kOutOfRange, kOrder, [&] { return std::ranges::is_sorted(walk.scans, {}, &RssScan::time); });
}

template <typename V, Of<Subscribe> S>
void describe(V& v, S& subscribe) {
  v.defaulted("floors", subscribe.floors, List{0, Limits::kFloorsPerMessage, kFloor});
  v.defaulted("tracked", subscribe.tracked, List{0, Limits::kNamesPerFilter, kKey});
  v.defaulted("min_interval_us", subscribe.min_interval, kDurationUs);
  v.defaulted("positions", subscribe.positions, Flag{}, true);
  v.defaulted("zone_events", subscribe.zone_events, Flag{});
}

template <typename V, Of<TokenRefresh> S>
void describe(V& v, S& refresh) {
  v.required("token", refresh.token, kSomeName);
}

template <typename V, Of<ClockProbe> S>
void describe(V& v, S& probe) {
  v.required("phone_time_us", probe.phone_time, kPhoneTime);
}

template <typename V, Of<Goodbye> S>
void describe(V& v, S& goodbye) {
  v.defaulted("reason", goodbye.reason, kName);
}

// ---------------------------------------------------------------- server -> client

template <typename V, Of<FloorName> S>
void describe(V& v, S& floor) {
  v.required("floor", floor.floor, kFloor);
  v.required("label", floor.label, kName);
}

template <typename V, Of<Welcome> S>
void describe(V& v, S& welcome) {
  v.required("session", welcome.session, kKey);
  v.required("tracked", welcome.tracked, kKey);
  v.required("epoch", welcome.epoch, kCounter);
  v.required("applied_through", welcome.applied_through, kCounter);
  v.required("recovered", welcome.recovered, Flag{});
  v.defaulted("building", welcome.building, kCounter);
  v.defaulted("building_name", welcome.building_name, kName);
  v.defaulted("floors", welcome.floors, List{0, Limits::kFloorsPerMessage, Object{}});
  v.optional("georeference", welcome.georeference, Object{});
  v.defaulted("magnetic_field", welcome.magnetic_field, Object{});
  v.defaulted("pipeline", welcome.pipeline, kName);
  v.defaulted("radio_map_version", welcome.radio_map_version, kCounter);
  v.required("server_wall_time_us", welcome.server_wall_time, kUnixTime);
  v.required("keep_alive_us", welcome.keep_alive, kDurationUs);
  v.required("sample_ring_us", welcome.sample_ring, kDurationUs);
  v.defaulted("token_expires_in_us", welcome.token_expires_in, kDurationUs);
  v.defaulted("is_recorded", welcome.is_recorded, Flag{});
}

template <typename V, Of<Ack> S>
void describe(V& v, S& ack) {
  v.required("epoch", ack.epoch, kCounter);
  v.required("through", ack.through, kCounter);
}

template <typename V, Of<SurveyAck> S>
void describe(V& v, S& ack) {
  v.required("idempotency_key", ack.idempotency_key, kKey);
  v.required("stored", ack.stored, Integer{0, 1'000'000'000});
  v.required("survey_version", ack.survey_version, kCounter);
}

template <typename V, Of<Position> S>
void describe(V& v, S& position) {
  v.required("position", position.position, Object{});
  v.required("applied_through", position.applied_through, kCounter);
}

template <typename V, Of<NoFix> S>
void describe(V& v, S& no_fix) {
  v.required("at_us", no_fix.at, kPhoneTime);
  v.required("reason", no_fix.reason, Object{});
}

template <typename V, Of<Observed> S>
void describe(V& v, S& observed) {
  v.required("tracked", observed.tracked, kKey);
  v.required("position", observed.position, Object{});
  v.required("received_at_us", observed.received_at, kUnixTime);
  v.defaulted("gone", observed.gone, Flag{});
}

template <typename V, Of<Observation> S>
void describe(V& v, S& observation) {
  v.required("tracked", observation.tracked, List{0, Limits::kObservedPerMessage, Object{}});
}

template <typename V, Of<ZoneEvent> S>
void describe(V& v, S& event) {
  v.required("tracked", event.tracked, kKey);
  v.required("zone", event.zone, kKey);
  v.defaulted("zone_name", event.zone_name, kName);
  v.required("transition", event.transition, Choice{kTransitionNames});
  v.required("at_us", event.at, kUnixTime);
  v.required("floor", event.floor, kFloor);
  v.required("probability", event.probability, kProbability);
  v.defaulted("id", event.id, Text{0, Limits::kKeyBytes, true});
  v.defaulted("retracts", event.retracts, Text{0, Limits::kKeyBytes, true});
}

template <typename V, Of<TokenAccepted> S>
void describe(V& v, S& accepted) {
  v.defaulted("expires_in_us", accepted.expires_in, kDurationUs);
}

template <typename V, Of<ClockAnswer> S>
void describe(V& v, S& answer) {
  v.required("phone_time_us", answer.phone_time, kPhoneTime);
  v.required("server_wall_time_us", answer.server_wall_time, kUnixTime);
}

template <typename V, Of<ScanHint> S>
void describe(V& v, S& hint) {
  v.required("interval_us", hint.interval, kDurationUs);
  v.defaulted("ranging", hint.ranging, Flag{});
  v.defaulted("reason", hint.reason, Cause{Limits::kStringBytes});
}

template <typename V, Of<Ticket> S>
void describe(V& v, S& ticket) {
  v.required("sealed", ticket.sealed, Bytes{Limits::kTicketBytes});
  v.required("applied_through", ticket.applied_through, kCounter);
  v.required("expires_in_us", ticket.expires_in, kDurationUs);
}

template <typename V, Of<FaultReport> S>
void describe(V& v, S& report) {
  v.required("fault", report.fault, Object{});
  v.defaulted("sequence", report.sequence, kCounter);
  v.defaulted("idempotency_key", report.idempotency_key, Text{0, Limits::kKeyBytes, true});
  v.defaulted("retry_after_us", report.retry_after, kDurationUs);
}

template <typename V, Of<GoAway> S>
void describe(V& v, S& go_away) {
  v.required("within_us", go_away.within, kDurationUs);
  v.defaulted("reason", go_away.reason, Cause{Limits::kStringBytes});
}

}  // namespace wayfuse::wire
