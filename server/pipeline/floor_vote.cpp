#include "server/pipeline/floor_vote.hpp"

#include <algorithm>

#include "server/locating/locator.hpp"

namespace wayfuse {

FloorVote::FloorVote(const FloorVoteSettings& settings, std::span<const FloorOrdinal> floors) : settings_(settings) {
  for (const FloorOrdinal floor : floors) beliefs_.push_back({floor, 0.0});
}

double& FloorVote::belief(FloorOrdinal floor) {
  const auto found = std::ranges::find(beliefs_, floor, &FloorProbability::floor);
  if (found != beliefs_.end()) return found->probability;
  return beliefs_.emplace_back(FloorProbability{floor, 0.0}).probability;
}

void FloorVote::set(FloorOrdinal floor) {
  for (auto& each : beliefs_) each.probability = 0.0;
  belief(floor) = 1.0;
  floor_ = floor;
  started_ = true;
}

void FloorVote::update(std::span<const FloorProbability> votes) {
  if (votes.empty()) return;
  const double memory = started_ ? settings_.memory : 0.0;
  for (auto& each : beliefs_) each.probability *= memory;
  for (const FloorProbability& vote : votes) belief(vote.floor) += (1.0 - memory) * vote.probability;
  const auto best = std::ranges::max_element(beliefs_, {}, &FloorProbability::probability);
  const double lead = best->probability - belief(floor_);
  if (!started_ || settings_.memory == 0.0 || lead > settings_.margin) floor_ = best->floor;
  started_ = true;
}

std::vector<FloorProbability> FloorVote::probabilities() const {
  std::vector<FloorProbability> sorted;
  double sum = 0.0;
  for (const auto& each : beliefs_) {
    if (each.probability <= 0.0) continue;
    sorted.push_back(each);
    sum += each.probability;
  }
  for (auto& each : sorted) each.probability /= sum;
  most_probable_first(sorted);
  return sorted;
}

}  // namespace wayfuse
