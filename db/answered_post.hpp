#pragma once

#include <cstdint>
#include <string>

#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// A POST that is to happen once, and what is known of its answer.
struct AnsweredPost {
  enum class State : std::uint8_t {
    kUnderWay = 0,     ///< begun; how it ended was not written down
    kKept = 1,
    kNotKept = 2,      ///< answered; the answer holds a secret or is too long
  };
  std::string name;                    ///< of key, path and idempotency key: a hash, 1..128 bytes
  std::string body_hash;
  UnixTime at;                         ///< when it began
  State state = State::kUnderWay;
  std::string answer = {};             ///< as its owner spells it
};

}  // namespace wayfuse
