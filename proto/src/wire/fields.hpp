#pragma once

#include <array>
#include <concepts>
#include <string_view>

#include "proto/src/wire/kinds.hpp"
#include "wayfuse/proto/message.hpp"

/// The field tables of the vocabulary: what a message is made of. One table a type, read by encoder, decoder, checker and
/// documentation, so that they cannot differ. Messages themselves: message_fields.hpp.
///
/// `required` = must be there; `optional` = absent when it holds no value; `defaulted` = absent when it equals the default.
namespace wayfuse::wire {

template <typename Self, typename T>
concept Of = std::same_as<std::remove_const_t<Self>, T>;

inline constexpr double kPi = std::numbers::pi;
inline constexpr std::int64_t kMostInteger = Limits::kLargestInteger;

inline constexpr Integer kPhoneTime{-kMostInteger, kMostInteger, "us"};
inline constexpr Integer kUnixTime{0, kMostInteger, "us"};
inline constexpr Integer kCounter{0, kMostInteger};
inline constexpr Integer kDurationUs{0, kMostInteger, "us"};
inline constexpr Integer kReadingAge{0, 600'000'000, "us"};
inline constexpr Integer kInterval{0, 60'000'000, "us"};
inline constexpr Integer kFloor{-200, 1000};
inline constexpr Real kLocalMetres{-100'000.0, 100'000.0, "m"};
inline constexpr Real kSigmaMetres{0.0, 100'000.0, "m"};
inline constexpr Real kSurveySigma{0.0, 1000.0, "m"};
inline constexpr Real kProbability{0.0, 1.0, ""};
inline constexpr Text kName{0, Limits::kStringBytes};
inline constexpr Text kSomeName{1, Limits::kStringBytes};
inline constexpr Text kKey{1, Limits::kKeyBytes, true};
inline constexpr Real kAngleSigma{0.0, 180.0, "deg", 1e6, kDegreesPerRadian};

inline constexpr std::array<std::string_view, 3> kReferenceNames = {"magnetic", "true", "arbitrary"};
inline constexpr std::array<std::string_view, 3> kIntegrityNames = {"ok", "degraded", "suspect"};
inline constexpr std::array<std::string_view, 3> kRoleNames = {"track", "survey", "observe"};
inline constexpr std::array<std::string_view, 2> kTransitionNames = {"entered", "left"};

/// The alternative's name in a tagged map: `type` of messages, `kind` of samples.
template <typename T>
inline constexpr std::string_view kWireName = "";
// clang-format off
template <> inline constexpr std::string_view kWireName<MotionReport> = "motion";
template <> inline constexpr std::string_view kWireName<RssScan> = "scan";
template <> inline constexpr std::string_view kWireName<GnssFix> = "gnss";
// clang-format on

template <typename V, Of<Place> S>
void describe(V& v, S& place) {
  v.required("x_m", place.point.x_m, kLocalMetres);
  v.required("y_m", place.point.y_m, kLocalMetres);
  v.required("floor", place.floor, kFloor);
}

template <typename V, Of<GeoPoint> S>
void describe(V& v, S& point) {
  v.required("latitude_deg", point.latitude_deg, Real{-90.0, 90.0, "deg", 1e9});
  v.required("longitude_deg", point.longitude_deg, Real{-180.0, 180.0, "deg", 1e9});
}

template <typename V, Of<Georeference> S>
void describe(V& v, S& georeference) {
  v.required("origin", georeference.origin, Object{});
  v.required("y_axis_azimuth_deg", georeference.y_axis_azimuth_rad, Real{-360.0, 360.0, "deg", 1e9, kDegreesPerRadian});
}

template <typename V, Of<MagneticField> S>
void describe(V& v, S& field) {
  v.required("declination_deg", field.declination_rad, Real{-180.0, 180.0, "deg", 1e6, kDegreesPerRadian});
  v.required("dip_deg", field.dip_rad, Real{-90.0, 90.0, "deg", 1e6, kDegreesPerRadian});
  v.required("norm_ut", field.norm_ut, Real{0.0, 200.0, "uT"});
}

template <typename V, Of<ScanReading> S>
void describe(V& v, S& reading) {
  v.required("bssid", reading.bssid, Address{});
  v.required("rss_dbm", reading.rss_dbm, Real{-120.0, 0.0, "dBm"});
  v.defaulted("age_us", reading.age, kReadingAge);
  v.defaulted("frequency_mhz", reading.frequency_mhz, Integer{0, 65'535, "MHz"});
  v.optional("range_m", reading.range_m, Real{-50.0, 10'000.0, "m"});
  v.optional("range_sigma_m", reading.range_sigma_m, Real{0.0, 10'000.0, "m"});
}

template <typename V, Of<RssScan> S>
void describe(V& v, S& scan) {
  v.required("time_us", scan.time, kPhoneTime);
  v.required("readings", scan.readings, List{0, Limits::kReadingsPerScan, Object{}});
}

template <typename V, Of<MotionReport> S>
void describe(V& v, S& motion) {
  constexpr Real kField{-5000.0, 5000.0, "uT"};
  v.required("time_us", motion.time, kPhoneTime);
  v.required("interval_us", motion.interval, kInterval);
  v.required("azimuth_deg", motion.heading, Compass{});
  v.required("azimuth_sigma_deg", motion.heading_sigma_rad, kAngleSigma);
  v.required("reference", motion.reference, Choice{kReferenceNames});
  v.defaulted("turn_rate_degps", motion.turn_rate_radps, Real{-2000.0, 2000.0, "deg/s", 1e6, -kDegreesPerRadian});
  v.defaulted("steps", motion.steps, Integer{0, 1000});
  v.defaulted("step_length_m", motion.step_length_m, Real{0.0, 3.0, "m"});
  v.optional("speed_mps", motion.speed_mps, Real{0.0, 20.0, "m/s"});
  v.defaulted("distance_sigma_m", motion.distance_sigma_m, Real{0.0, 10'000.0, "m"});
  v.defaulted("turning", motion.turning, Flag{});
  v.defaulted("at_rest", motion.at_rest, Flag{});
  v.optional("climb_m", motion.climb_m, Real{-1000.0, 1000.0, "m"});
  v.optional("field_horizontal_ut", motion.field_horizontal_ut, Real{0.0, 5000.0, "uT"});
  v.optional("field_vertical_ut", motion.field_vertical_ut, kField);
}

template <typename V, Of<GnssFix> S>
void describe(V& v, S& fix) {
  v.required("time_us", fix.time, kPhoneTime);
  v.required("point", fix.point, Object{});
  v.required("sigma_m", fix.sigma_m, Real{0.0, 10'000.0, "m"});
  v.optional("speed_mps", fix.speed_mps, Real{0.0, 1000.0, "m/s"});
  v.optional("course_azimuth_deg", fix.course_azimuth_rad, Compass{});
}

template <typename V, Of<ReferencePoint> S>
void describe(V& v, S& point) {
  v.required("place", point.place, Object{});
  v.defaulted("sigma_m", point.sigma_m, kSurveySigma);
  v.defaulted("device_model", point.device_model, kName);
  v.defaulted("walk", point.walk, kName);
  v.required("surveyed_at_us", point.surveyed_at, kUnixTime);
  v.required("scans", point.scans, List{1, Limits::kScansPerPoint, Object{}});
}

template <typename V, Of<Covariance> S>
void describe(V& v, S& covariance) {
  constexpr Real kVariance{0.0, 1e10, "m2"};
  v.required("xx_m2", covariance.xx_m2, kVariance);
  v.required("xy_m2", covariance.xy_m2, Real{-1e10, 1e10, "m2"});
  v.required("yy_m2", covariance.yy_m2, kVariance);
}

template <typename V, Of<FloorProbability> S>
void describe(V& v, S& floor) {
  v.required("floor", floor.floor, kFloor);
  v.required("probability", floor.probability, kProbability);
}

template <typename V, Of<Contributions> S>
void describe(V& v, S& from) {
  v.required("transmitters_used", from.transmitters_used, Integer{0, 100'000});
  v.required("transmitters_unknown", from.transmitters_unknown, Integer{0, 100'000});
  v.required("scan_age_us", from.scan_age, kDurationUs);
  v.required("steps_since_scan", from.steps_since_scan, Integer{0, 1'000'000'000});
  v.defaulted("gnss", from.gnss, Flag{});
}

template <typename V, Of<FusedPosition> S>
void describe(V& v, S& position) {
  v.required("valid_at_us", position.valid_at, kPhoneTime);
  v.required("building", position.building, kCounter);
  v.required("place", position.place, Object{});
  v.optional("geo", position.geo, Object{});
  v.required("floors", position.floors, List{0, Limits::kFloorsPerMessage, Object{}});
  v.required("covariance", position.covariance, Object{});
  v.required("radius68_m", position.radius68_m, kSigmaMetres);
  v.required("radius95_m", position.radius95_m, kSigmaMetres);
  v.required("azimuth_deg", position.heading, Compass{});
  v.required("azimuth_sigma_deg", position.heading_sigma_rad, kAngleSigma);
  v.required("speed_mps", position.speed_mps, Real{0.0, 100.0, "m/s"});
  v.required("radio_map_version", position.radio_map_version, kCounter);
  v.required("integrity", position.integrity, Choice{kIntegrityNames});
  v.required("from", position.from, Object{});
}

template <typename V, Of<Fault> S>
void describe(V& v, S& fault) {
  v.required("code", fault.code, Integer{1, 65'535});
  v.information("name", face_of(fault.code).name);
  v.defaulted("field", fault.field, Cause{Limits::kStringBytes});
  v.defaulted("cause", fault.cause, Cause{Limits::kCauseBytes});
}

}  // namespace wayfuse::wire
