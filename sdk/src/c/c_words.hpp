#pragma once

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>

#include "wayfuse/proto/fix.hpp"
#include "wayfuse/proto/message.hpp"
#include "wayfuse/proto/result.hpp"
#include "wayfuse/sdk/marg.hpp"
#include "wayfuse/sdk/motion_tracker.hpp"
#include "wayfuse/sdk/position_now.hpp"
#include "wayfuse/sdk/scan_planner.hpp"
#include "wayfuse/sdk/wayfuse.h"

/// Between the C interface's words and the SDK's types.
namespace wayfuse {

/// Notes why for wayfuse_last_error, and says `status`.
wayfuse_status refuse(wayfuse_status status, std::string_view why) noexcept;
std::string_view last_refusal() noexcept;
std::string_view status_words(wayfuse_status status) noexcept;

wayfuse_status status_of(const Fault& fault) noexcept;
inline wayfuse_status status_of(const Result<void>& result) noexcept { return result ? WAYFUSE_OK : status_of(result.fault()); }

inline wayfuse_text text_of(std::string_view text) { return {text.data(), text.size()}; }
inline std::string string_of(wayfuse_text text) { return text.length ? std::string(text.data, text.length) : std::string(); }

/// Sets a growing struct to nothing, of the size its user knows.
template <typename Words>
void init_words(Words* words, std::size_t size) noexcept {
  if (!words || size < sizeof words->size) return;
  std::memset(static_cast<void*>(words), 0, size);
  words->size = size;
}
/// Fills as much of a growing struct as its user knows.
template <typename Words>
wayfuse_status give_words(const Words& made, Words* into) {
  const std::size_t size = into->size;
  if (size < sizeof into->size) return refuse(WAYFUSE_BAD_INPUT, "size is not set: use the struct's init function");
  std::memcpy(static_cast<void*>(into), &made, std::min(size, sizeof made));
  into->size = size;
  return WAYFUSE_OK;
}
/// An older user's struct is shorter, a newer one's longer: what this library does not know must be nothing.
wayfuse_status copy_options(const wayfuse_options& given, wayfuse_options& own);

MargSample marg_of(const wayfuse_marg_sample& sample);
Result<RssScan> scan_of(int64_t time_us, const wayfuse_reading* readings, std::size_t count);
wayfuse_position words_of(const LivePosition& live);
wayfuse_position words_of(const FusedPosition& fused);
wayfuse_scan_advice words_of(const ScanAdvice& advice);
wayfuse_calibration words_of(const MotionCalibration& calibration);
/// Precondition: it was checked with the options.
MotionCalibration calibration_of(const wayfuse_calibration& calibration);

}  // namespace wayfuse
