#include "sdk/src/c/c_words.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace wayfuse {
namespace {

constexpr std::size_t kOptionsOfVersion1 = offsetof(wayfuse_options, on_disconnected) + sizeof(wayfuse_on_disconnected);
constexpr std::size_t kTextMost = 1 << 20;
constexpr std::size_t kReadingsListed = 1 << 16;  // no system lists more: a count beyond is a mistake

// No allocation on the way of a refusal; one a thread.
struct Refusal {
  char text[512] = "";
  std::size_t length = 0;
};
thread_local Refusal refusal;

Vector3 vector_of(const double (&axes)[3]) {
  return {axes[0], axes[1], axes[2]};
}

// What an application kept in a file may be anything.
wayfuse_status check_calibration(const wayfuse_calibration& kept) {
  if (kept.size < sizeof kept) return refuse(WAYFUSE_BAD_OPTIONS, "calibration.size is not set: use wayfuse_calibration_init");
  const auto within = [](const double (&axes)[3], double most) {
    return std::all_of(axes, axes + 3, [most](double axis) { return std::abs(axis) <= most; });
  };
  if (!within(kept.turn_rate_bias_radps, 1.0)) return refuse(WAYFUSE_BAD_OPTIONS, "calibration.turn_rate_bias_radps: outside -1..1");
  if (!(kept.bias_sigma_radps >= 0.0 && kept.bias_sigma_radps <= 1.0))
    return refuse(WAYFUSE_BAD_OPTIONS, "calibration.bias_sigma_radps: outside 0..1");
  if (!within(kept.field_offset_ut, 2000.0)) return refuse(WAYFUSE_BAD_OPTIONS, "calibration.field_offset_ut: outside -2000..2000");
  if (!(kept.step_scale >= 0.7 && kept.step_scale <= 1.4))
    return refuse(WAYFUSE_BAD_OPTIONS, "calibration.step_scale: outside 0.7..1.4");
  if (!(kept.step_scale_sigma >= 0.0 && kept.step_scale_sigma <= 1.0))
    return refuse(WAYFUSE_BAD_OPTIONS, "calibration.step_scale_sigma: outside 0..1");
  return WAYFUSE_OK;
}

wayfuse_status check_options(const wayfuse_options& options) {
  const std::pair<const wayfuse_text*, const char*> texts[] = {{&options.url, "url"},
                                                               {&options.token, "token"},
                                                               {&options.device_model, "device_model"},
                                                               {&options.app, "app"},
                                                               {&options.pipeline, "pipeline"},
                                                               {&options.ca_pem, "ca_pem"},
                                                               {&options.pin, "pin"},
                                                               {&options.heading_estimator, "heading_estimator"}};
  for (const auto& [text, name] : texts) {
    if (!text->data && text->length > 0) return refuse(WAYFUSE_NULL, std::string(name) + ": NULL with a length");
    if (text->length > kTextMost) return refuse(WAYFUSE_BAD_OPTIONS, std::string(name) + ": longer than 1 MiB");
  }
  if (options.role != WAYFUSE_TRACK && options.role != WAYFUSE_SURVEY) return refuse(WAYFUSE_BAD_OPTIONS, "role: no such role");
  if (options.platform < WAYFUSE_PLATFORM_UNLIMITED || options.platform > WAYFUSE_PLATFORM_IOS) {
    return refuse(WAYFUSE_BAD_OPTIONS, "platform: no such platform");
  }
  if (options.role == WAYFUSE_SURVEY && options.building == 0)
    return refuse(WAYFUSE_BAD_OPTIONS, "building: a survey needs one");
  return options.calibration ? check_calibration(*options.calibration) : WAYFUSE_OK;
}

}  // namespace

wayfuse_status refuse(wayfuse_status status, std::string_view why) noexcept {
  refusal.length = std::min(why.size(), sizeof refusal.text);
  std::memcpy(refusal.text, why.data(), refusal.length);
  return status;
}

std::string_view last_refusal() noexcept {
  return {refusal.text, refusal.length};
}

std::string_view status_words(wayfuse_status status) noexcept {
  switch (status) {
    case WAYFUSE_OK:
      return "ok";
    case WAYFUSE_BAD_INPUT:
      return "bad input";
    case WAYFUSE_NULL:
      return "a pointer is NULL";
    case WAYFUSE_BAD_OPTIONS:
      return "bad options";
    case WAYFUSE_NO_POSITION:
      return "no position yet";
    case WAYFUSE_BUSY:
      return "busy, try again later";
    case WAYFUSE_WRONG_STATE:
      return "not in this role or state";
    case WAYFUSE_WRONG_THREAD:
      return "not from inside a callback";
    case WAYFUSE_NO_MEMORY:
      return "out of memory";
    case WAYFUSE_INTERNAL:
      return "internal error";
  }
  return "unknown status";
}

wayfuse_status status_of(const Fault& fault) noexcept {
  wayfuse_status status = WAYFUSE_BAD_INPUT;
  if (fault.code == FaultCode::kUnexpectedMessage) status = WAYFUSE_WRONG_STATE;
  if (fault.code == FaultCode::kOverloaded) status = WAYFUSE_BUSY;
  try {
    return refuse(status, to_string(fault));
  } catch (...) {
    return refuse(status, fault.cause);
  }
}

wayfuse_status copy_options(const wayfuse_options& given, wayfuse_options& own) {
  init_words(&own, sizeof own);
  if (given.size < kOptionsOfVersion1) return refuse(WAYFUSE_BAD_OPTIONS, "size is not set: use wayfuse_options_init");
  const auto* bytes = reinterpret_cast<const unsigned char*>(&given);
  std::memcpy(&own, bytes, std::min(given.size, sizeof own));
  if (given.size > 64 * sizeof own) return refuse(WAYFUSE_BAD_OPTIONS, "size: beyond reason");
  for (std::size_t at = sizeof own; at < given.size; ++at) {
    if (bytes[at] != 0) return refuse(WAYFUSE_BAD_OPTIONS, "an option is set that this library does not know");
  }
  return check_options(own);
}

MargSample marg_of(const wayfuse_marg_sample& sample) {
  MargSample made;
  made.time = PhoneTime{Duration{sample.time_us}};
  if (sample.has & WAYFUSE_HAS_ACCELERATION) made.acceleration_mps2 = vector_of(sample.acceleration_mps2);
  if (sample.has & WAYFUSE_HAS_TURN_RATE) made.turn_rate_radps = vector_of(sample.turn_rate_radps);
  if (sample.has & WAYFUSE_HAS_FIELD) made.field_ut = vector_of(sample.field_ut);
  if (sample.has & WAYFUSE_HAS_PRESSURE) made.pressure_hpa = sample.pressure_hpa;
  return made;
}

Result<RssScan> scan_of(int64_t time_us, const wayfuse_reading* readings, std::size_t count) {
  if (count > kReadingsListed) {
    return Fault{FaultCode::kTooLarge, "readings", std::to_string(count) + " readings, at most " + std::to_string(kReadingsListed)};
  }
  RssScan scan{PhoneTime{Duration{time_us}}, {}};
  scan.readings.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const wayfuse_reading& given = readings[i];
    int64_t age_us = 0;
    if (__builtin_sub_overflow(time_us, given.heard_us, &age_us)) {
      return Fault{FaultCode::kOutOfRange, "readings[" + std::to_string(i) + "].heard_us", "ages from the scan"};
    }
    ScanReading reading{Bssid{given.bssid}, given.rss_dbm, Duration{age_us}, given.frequency_mhz, std::nullopt, std::nullopt};
    if (given.has_range) {
      reading.range_m = given.range_m;
      reading.range_sigma_m = given.range_sigma_m;
    }
    scan.readings.push_back(reading);
  }
  keep_youngest(scan, Limits::kReadingsPerScan);
  return scan;
}

wayfuse_position words_of(const LivePosition& live) {
  wayfuse_position made;
  init_words(&made, sizeof made);
  made.at_us = live.at.time_since_epoch().count();
  made.x_m = live.place.point.x_m;
  made.y_m = live.place.point.y_m;
  made.floor = live.place.floor.value;
  if (live.geo) {
    made.has_geo = 1;
    made.latitude_deg = live.geo->latitude_deg;
    made.longitude_deg = live.geo->longitude_deg;
  }
  made.radius68_m = live.radius68_m;
  made.radius95_m = live.radius95_m;
  made.heading_rad = live.heading.radians();
  made.speed_mps = live.speed_mps;
  made.since_fused_us = live.since_fused.count();
  made.integrity = static_cast<int32_t>(live.integrity);
  return made;
}

wayfuse_position words_of(const FusedPosition& fused) {
  return words_of(LivePosition{fused.valid_at, fused.place, fused.geo, fused.radius68_m, fused.radius95_m, fused.heading,
                               fused.speed_mps, Duration{0}, fused.integrity});
}

wayfuse_scan_advice words_of(const ScanAdvice& advice) {
  wayfuse_scan_advice made;
  init_words(&made, sizeof made);
  made.possible = advice.possible ? 1 : 0;
  made.needed = advice.at ? 1 : 0;
  made.at_us = advice.at ? advice.at->time_since_epoch().count() : 0;
  made.why = text_of(advice.why);
  return made;
}

wayfuse_calibration words_of(const MotionCalibration& calibration) {
  wayfuse_calibration made;
  init_words(&made, sizeof made);
  const auto copy = [](const Vector3& from, double (&to)[3]) { to[0] = from.x, to[1] = from.y, to[2] = from.z; };
  copy(calibration.sensors.turn_rate_bias_radps, made.turn_rate_bias_radps);
  made.bias_sigma_radps = calibration.sensors.bias_sigma_radps;
  copy(calibration.sensors.field_offset_ut, made.field_offset_ut);
  made.step_scale = calibration.step_scale;
  made.step_scale_sigma = calibration.step_scale_sigma;
  return made;
}

MotionCalibration calibration_of(const wayfuse_calibration& calibration) {
  return {{vector_of(calibration.turn_rate_bias_radps), calibration.bias_sigma_radps, vector_of(calibration.field_offset_ut)},
          calibration.step_scale,
          calibration.step_scale_sigma};
}

}  // namespace wayfuse
