#pragma once

#include <memory>
#include <span>
#include <string_view>

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
/// Which measurements a filter understands; each kind takes what the ones before it take, too.
enum class Takes {
  kFixes,     ///< points
  kLinear,    ///< whose Jacobian does not depend on the state
  kGaussian,  ///< that have a Gaussian form
  kAny,       ///< of particles, which need a resampler
};
/// `linear measurements`, as in a fault: the filter takes ... only.
std::string_view words_of(Takes takes);

struct FilterRow {
  PartDescription description;
  std::unique_ptr<Filter> (*make)(const PartSettings& settings, std::shared_ptr<const MotionModel> motion,
                                  std::shared_ptr<const Resampler> resampler);
  Takes takes = Takes::kGaussian;
};

std::span<const MotionModelRow> motion_model_catalogue();
std::span<const ResamplerRow> resampler_catalogue();
std::span<const FilterRow> filter_catalogue();

}  // namespace wayfuse
