#pragma once

#include <span>
#include <string>
#include <string_view>

#include "wayfuse/proto/fingerprint.hpp"

namespace wayfuse {

/// SHA-256 of a stored content, 32 raw bytes.
std::string sha256(std::string_view content);
/// Lower-case hexadecimal digits.
std::string hex(std::string_view bytes);
/// BLAKE2b-256 over every bit of a survey's points, in their order; raw. Precondition: they came from the store.
std::string hash_of_points(std::span<const ReferencePoint> points);

}  // namespace wayfuse
