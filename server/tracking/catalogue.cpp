#include "server/tracking/catalogue.hpp"

#include <array>
#include <numbers>

#include "server/tracking/gaussian_filters.hpp"
#include "server/tracking/particle_filter.hpp"
#include "server/tracking/resamplers.hpp"
#include "server/tracking/steps_motion.hpp"
#include "server/tracking/still_motion.hpp"
#include "server/tracking/unscented_filter.hpp"
#include "server/tracking/velocity_motion.hpp"
#include "server/tracking/walk_motion.hpp"

namespace wayfuse {
namespace {

template <typename Kind>
std::unique_ptr<Filter> gaussian(const PartSettings&, std::shared_ptr<const MotionModel> motion, std::shared_ptr<const Resampler>) {
  return std::make_unique<Kind>(std::move(motion));
}

const VelocitySettings kVelocity;
const StepsSettings kSteps;

VelocitySettings along_a_street(const PartSettings& s) {
  return {std::numbers::pi / 2 - s["axis_azimuth_deg"] * std::numbers::pi / 180.0, s["along_sigma_m_rts"], s["along_sigma_mps_rts"],
          s["across_sigma_m_rts"], s["across_sigma_mps_rts"]};
}

}  // namespace

std::span<const MotionModelRow> motion_model_catalogue() {
  static const std::array rows = {
      MotionModelRow{
          {"motion", "walk", "heading and distance move the walker, acceleration noise blurs [P1 eq. 12]",
           {{"acceleration_sigma_mps2", WalkSettings{}.acceleration_sigma_mps2, 0.0, 20.0,
             "of the unknown acceleration; 0 = as the phone states its own errors; larger spreads the particles faster",
             "[P1 eq. 12]"},
            {"blur_m_rts", WalkSettings{}.blur_m_rts, 0.0, 10.0,
             "least blur, metres per root second; larger follows the fixes sooner and is noisier", "-"}}},
          [](const PartSettings& s) -> std::shared_ptr<const MotionModel> {
            return std::make_shared<WalkMotion>(WalkSettings{s["acceleration_sigma_mps2"], s["blur_m_rts"]});
          }},
      MotionModelRow{
          {"motion", "steps", "dead reckoning a step at a time, errors drawn per particle [P2, P3 eq. 7]",
           {{"length_share", kSteps.length_share, 0, 1, "sigma of a step's length as a share of it, where the phone states none", "[P3 eq. 8]"},
            {"heading_sigma_rad", kSteps.heading_sigma_rad, 0, 3, "drawn anew for every step; larger follows the fixes", "[P3]"},
            {"bias_sigma_rad", kSteps.bias_sigma_rad, 0, 3.2, "each particle's constant heading error at the start; 0 = none", "-"},
            {"bias_drift_rad_rts", kSteps.bias_drift_rad_rts, 0, 1, "random walk of that error, per root second", "-"},
            {"scale_sigma", kSteps.scale_sigma, 0, 0.5, "each particle's constant stride factor about 1; 0 = none", "-"}}},
          [](const PartSettings& s) -> std::shared_ptr<const MotionModel> {
            return std::make_shared<StepsMotion>(StepsSettings{s["length_share"], s["heading_sigma_rad"], s["bias_sigma_rad"],
                                                               s["bias_drift_rad_rts"], s["scale_sigma"]});
          }},
      MotionModelRow{{"motion", "constant-velocity", "position and velocity, no control [P4 eqs. 1-2]",
                      {{"sigma_m_rts", kVelocity.along_sigma_m_rts, 0, 100, "random walk of the position, per root second", "[P4]"},
                       {"sigma_mps_rts", kVelocity.along_sigma_mps_rts, 0, 100,
                        "random walk of the velocity, per root second; larger follows turns and noise", "[P4]"}}},
                     [](const PartSettings& s) -> std::shared_ptr<const MotionModel> {
                       return std::make_shared<VelocityMotion>(
                           VelocitySettings{0.0, s["sigma_m_rts"], s["sigma_mps_rts"], s["sigma_m_rts"], s["sigma_mps_rts"]});
                     }},
      MotionModelRow{{"motion", "street", "position and velocity along and across a street, no control [P5 eqs. 1, 3]",
                      {{"axis_azimuth_deg", 90, -360, 360, "of the street, clockwise from the frame's y axis", "[P5 eq. 1]"},
                       {"along_sigma_m_rts", 0.05, 0, 100, "random walk of the position along, per root second", "[P5 eq. 3]"},
                       {"along_sigma_mps_rts", 0.2, 0, 100, "random walk of the speed along", "[P5 eq. 3]"},
                       {"across_sigma_m_rts", 0.05, 0, 100, "random walk of the position across", "[P5 eq. 3]"},
                       {"across_sigma_mps_rts", 0.1, 0, 100, "random walk of the speed across", "[P5 eq. 3]"}}},
                     [](const PartSettings& s) -> std::shared_ptr<const MotionModel> {
                       return std::make_shared<VelocityMotion>(along_a_street(s));
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

std::string_view words_of(Takes takes) {
  switch (takes) {
    case Takes::kFixes: return "fixes";
    case Takes::kLinear: return "linear measurements";
    case Takes::kGaussian: return "measurements with a Gaussian form";
    case Takes::kAny: break;
  }
  return "measurements";
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
                Takes::kAny},
      FilterRow{{"filter", "kalman", "Kalman filter; takes linear models only [P4 eqs. 1-7]", {}}, gaussian<ExtendedKalmanFilter>,
                Takes::kLinear},
      FilterRow{{"filter", "extended-kalman", "Kalman filter linearised at the mean [P5]", {}}, gaussian<ExtendedKalmanFilter>},
      FilterRow{{"filter", "unscented-kalman", "Kalman filter through sigma points [P5]",
                 {{"alpha", UnscentedSettings{}.alpha, 0.001, 2, "spread of the sigma points; smaller stays nearer the mean", "[P5]"}}},
                [](const PartSettings& s, std::shared_ptr<const MotionModel> motion,
                   std::shared_ptr<const Resampler>) -> std::unique_ptr<Filter> {
                  return std::make_unique<UnscentedKalmanFilter>(std::move(motion), UnscentedSettings{.alpha = s["alpha"]});
                }},
      FilterRow{{"filter", "newest-fix", "no memory: the newest fix, moved on by the motion", {}}, gaussian<NewestFixFilter>,
                Takes::kFixes},
  };
  return rows;
}

}  // namespace wayfuse
