#include "server/pipeline/weighted_places.hpp"

#include <algorithm>
#include <cmath>

namespace wayfuse {

std::vector<WeightedPlace> weighted_places(const ParticleCloud& cloud, BuildingPoint origin, std::size_t most) {
  const std::size_t count = std::min(most, cloud.size());
  std::vector<WeightedPlace> places(count);
  if (count == 0) return places;
  const float heaviest = *std::ranges::max_element(cloud.log_weight());  // weights need not be normalised between scans
  double sum = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = k * cloud.size() / count;
    places[k] = {{origin.x_m + static_cast<double>(cloud.x_m()[i]), origin.y_m + static_cast<double>(cloud.y_m()[i])},
                 std::exp(static_cast<double>(cloud.log_weight()[i] - heaviest))};
    sum += places[k].weight;
  }
  // Where all the weight lies on particles that were not picked, those that were count alike.
  for (WeightedPlace& place : places) place.weight = sum > 0.0 ? place.weight / sum : 1.0 / static_cast<double>(count);
  return places;
}

}  // namespace wayfuse
