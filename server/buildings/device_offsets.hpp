#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "wayfuse/proto/fingerprint.hpp"

namespace wayfuse {

/// How much louder each phone model hears than the model that surveyed most, dB; models that agree within 1 dB, and those of
/// which nothing can be said, are left out.
///
/// From points of both models within 3 m of each other: the median of the differences over all transmitters both heard there,
/// from 60 differences and five places on. A median over many transmitters and places does not see the few that changed.
std::map<std::string, double> learn_device_offsets(std::span<const ReferencePoint> survey);

/// Takes the offsets out of every reading, within what a level can be.
void apply_device_offsets(const std::map<std::string, double>& offsets_db, std::vector<ReferencePoint>& survey);

}  // namespace wayfuse
