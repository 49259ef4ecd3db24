#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wayfuse/proto/fingerprint.hpp"

namespace wayfuse {

/// How loud one phone model hears, next to the model that surveyed most, and what that rests on.
struct DeviceLevel {
  enum class Standing {
    kReference,  ///< surveyed most: the others are brought to its level
    kLearnt,     ///< `offset_db` is taken out of its readings
    kAgrees,     ///< hears like the reference within 1 dB: its readings stay as they are
    kUnknown,    ///< too little ground or too few transmitters shared with the others, or nameless: its readings stay as they are
  };
  std::string model;
  std::size_t points = 0;
  Standing standing = Standing::kUnknown;
  double offset_db = 0.0;        ///< louder than the reference, as found; taken out where `learnt` alone
  std::size_t places = 0;        ///< points within 3 m of levelled ones
  std::size_t transmitters = 0;  ///< heard by both sides there, four times and more
  bool operator==(const DeviceLevel&) const = default;
};

std::string_view name_of(DeviceLevel::Standing standing);  ///< `reference`, `learnt`, `agrees`, `unknown`

/// Of a survey by several phone models: how much louder each hears. By points, most first; empty for an empty survey.
///
/// The model with most points is the reference. Another one's point is held against the mean of the levelled points within 3 m, transmitter by
/// transmitter; of those differences the mean of the middle half a transmitter, and of these the same, so that neither transmitters that
/// changed in between nor one that was heard a thousand times decide. Models that met the reference come first, then those that met
/// them. It takes five places, five transmitters and 60 differences.
/// The same points give the same bits. Cost: pairs of points within 3 m of each other, times what they heard.
std::vector<DeviceLevel> learn_device_levels(std::span<const ReferencePoint> survey);

/// What is to be taken out, by model.
std::map<std::string, double> offsets_of(std::span<const DeviceLevel> levels);

/// Takes the offsets out of every reading, within what a level can be.
void apply_device_offsets(const std::map<std::string, double>& offsets_db, std::vector<ReferencePoint>& survey);

}  // namespace wayfuse
