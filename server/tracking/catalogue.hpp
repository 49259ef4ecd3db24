#pragma once

#include <memory>
#include <span>

#include "server/tracking/filter.hpp"
#include "server/tracking/motion_model.hpp"
#include "server/tracking/resampler.hpp"
#include "wayfuse/proto/part.hpp"

namespace wayfuse {

struct MotionModelRow {
  PartDescription description;
  std::shared_ptr<const MotionModel> (*make)(const PartSettings& settings);
};
struct ResamplerRow {
  PartDescription description;
  std::shared_ptr<const Resampler> (*make)(const PartSettings& settings);
};
struct FilterRow {
  PartDescription description;
  std::unique_ptr<Filter> (*make)(const PartSettings& settings, std::shared_ptr<const MotionModel> motion,
                                  std::shared_ptr<const Resampler> resampler);
  bool particles = false;          ///< takes measurements without a Gaussian form, needs a resampler
  bool linear_only = false;        ///< refuses models whose Jacobian depends on the state
};

std::span<const MotionModelRow> motion_model_catalogue();
std::span<const ResamplerRow> resampler_catalogue();
std::span<const FilterRow> filter_catalogue();

}  // namespace wayfuse
