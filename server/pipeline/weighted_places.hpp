#pragma once

#include "server/pipeline/tracker.hpp"
#include "server/tracking/particle_cloud.hpp"

namespace wayfuse {

/// Tracker::cloud() of particles in a frame whose origin is at `origin` in the building's.
std::vector<WeightedPlace> weighted_places(const ParticleCloud& cloud, BuildingPoint origin, std::size_t most);

}  // namespace wayfuse
