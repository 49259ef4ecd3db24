#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>

#include "proto/src/wire/text.hpp"
#include "wayfuse/proto/fault.hpp"
#include "wayfuse/proto/message.hpp"

/// What must hold for every parser, whatever the bytes: shared by the fuzz targets.
namespace wayfuse::fuzzing {

inline void demand(bool holds, const char* what, const std::string& detail = "") {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s %s\n", what, detail.c_str());
  std::abort();
}

/// A fault found in hostile input can itself be sent and shown: short, UTF-8, without control characters. Most inputs end
/// here, so this is cheap.
inline void fault_is_presentable(const Fault& fault) {
  demand(!fault.cause.empty(), "a fault says its cause");
  demand(face_of(fault.code).code == fault.code, "a fault's code is in the table");
  for (const std::string& text : {std::cref(fault.field), std::cref(fault.cause)}) {
    demand(text.size() <= Limits::kCauseBytes, "a fault is short", text);
    demand(wire::is_utf8(text) && !wire::has_controls(text), "a fault can be shown", text);
  }
}

inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace wayfuse::fuzzing
