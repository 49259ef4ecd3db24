#include "server/tracking/catalogue.hpp"

#include <array>

#include "server/tracking/gaussian_filters.hpp"
#include "server/tracking/particle_filter.hpp"
#include "server/tracking/resamplers.hpp"
#include "server/tracking/still_motion.hpp"
#include "server/tracking/walk_motion.hpp"

namespace wayfuse {
namespace {

template <typename Kind>
std::unique_ptr<Filter> gaussian(const PartSettings&, std::shared_ptr<const MotionModel> motion, std::shared_ptr<const Resampler>) {
  return std::make_unique<Kind>(std::move(motion));
}

}  // namespace

std::span<const MotionModelRow> motion_model_catalogue() {
  static const std::array rows = {
      MotionModelRow{
          {"motion", "walk", "heading and distance move the walker, acceleration noise blurs [P1 eq. 12]",
           {{"acceleration_sigma_mps2", WalkSettings{}.acceleration_sigma_mps2, 0.0, 20.0,
             "of the unknown acceleration; 0 = as the phone states its own errors; larger spreads the particles faster",
             "[P1 eq. 12]"}}},
          [](const PartSettings& s) -> std::shared_ptr<const MotionModel> {
            return std::make_shared<WalkMotion>(WalkSettings{s["acceleration_sigma_mps2"]});
          }},
      MotionModelRow{{"motion", "still", "nothing is known of the motion: the place stays and blurs",
                      {{"wander_m_rts", StillSettings{}.wander_m_rts, 0.0, 10.0,
                        "random walk, metres per root second; larger forgets sooner", "-"}}},
                     [](const PartSettings& s) -> std::shared_ptr<const MotionModel> {
                       return std::make_shared<StillMotion>(StillSettings{s["wander_m_rts"]});
                     }},
  };
  return rows;
}

std::span<const ResamplerRow> resampler_catalogue() {
  static const std::array rows = {
      ResamplerRow{{"resampler", "multinomial", "independent draws; the noisiest [P1 eqs. 15-16]", {}},
                   [](const PartSettings&) -> std::shared_ptr<const Resampler> { return std::make_shared<MultinomialResampler>(); }},
      ResamplerRow{{"resampler", "systematic", "one draw, evenly spaced pointers; the least noise", {}},
                   [](const PartSettings&) -> std::shared_ptr<const Resampler> { return std::make_shared<SystematicResampler>(); }},
      ResamplerRow{{"resampler", "residual", "sure copies first, the rest drawn", {}},
                   [](const PartSettings&) -> std::shared_ptr<const Resampler> { return std::make_shared<ResidualResampler>(); }},
      ResamplerRow{{"resampler", "perturbing", "systematic, then a random offset to a share of the particles [P3]",
                    {{"share", PerturbingSettings{}.share, 0.0, 1.0,
                      "of the particles moved; larger recovers sooner and blurs more", "[P3]"},
                     {"sigma_m", PerturbingSettings{}.sigma_m, 0.0, 50.0, "of the move on each axis", "[P3]"}}},
                   [](const PartSettings& s) -> std::shared_ptr<const Resampler> {
                     return std::make_shared<PerturbingResampler>(PerturbingSettings{s["share"], s["sigma_m"]});
                   }},
  };
  return rows;
}

std::span<const FilterRow> filter_catalogue() {
  static const std::array rows = {
      FilterRow{{"filter", "particle", "sequential importance resampling [P1 eqs. 11-16]",
                 {{"particles", ParticleFilterSettings{}.particles, 10, 100000,
                   "number of hypotheses; the error falls with its root, the cost grows with it", "[P1]", true},
                  {"resample_below", ParticleFilterSettings{}.resample_below, 0.0, 1.0,
                   "effective share that triggers resampling; 1 = after every update as in the papers", "[P1 eq. 15]"}}},
                [](const PartSettings& s, std::shared_ptr<const MotionModel> motion,
                   std::shared_ptr<const Resampler> resampler) -> std::unique_ptr<Filter> {
                  return std::make_unique<ParticleFilter>(ParticleFilterSettings{s.count("particles"), s["resample_below"]},
                                                          std::move(motion), std::move(resampler));
                },
                true, false},
      FilterRow{{"filter", "kalman", "Kalman filter; takes linear models only [P4 eqs. 1-7]", {}}, gaussian<ExtendedKalmanFilter>, false,
                true},
      FilterRow{{"filter", "extended-kalman", "Kalman filter linearised at the mean [P5]", {}}, gaussian<ExtendedKalmanFilter>},
      FilterRow{{"filter", "newest-fix", "no memory: the newest fix, moved on by the motion", {}}, gaussian<NewestFixFilter>},
  };
  return rows;
}

}  // namespace wayfuse
