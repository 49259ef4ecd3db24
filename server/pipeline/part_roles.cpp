#include "server/pipeline/part_roles.hpp"

#include <array>

#include "server/pipeline/walker_cloud.hpp"
#include "server/pipeline/floor_vote.hpp"
#include "server/pipeline/fusion_tracker.hpp"
#include "server/pipeline/reading_gate.hpp"
#include "server/pipeline/recovery.hpp"
#include "server/tracking/heading_filter.hpp"

namespace wayfuse {

std::span<const Role> pipeline_roles() {
  static constexpr std::array roles = {
      Role{"readings", "fresh", "which readings of a scan count, and when they were heard"},
      Role{"locator", "none", "what a scan says about the place"},
      Role{"measurement", "fix", "how the locator's answer weighs on the filter"},
      Role{"floor", "vote", "how floor votes become one floor"},
      Role{"gnss", "fix", "what a satellite fix does"},
      Role{"heading", "reported", "how the phone's heading is turned into the walker's"},
      Role{"motion", "still", "how the state moves between evidence"},
      Role{"speed", "none", "whether the phone's speed is a measurement"},
      Role{"azimuth", "none", "whether the phone's heading is a measurement"},
      Role{"filter", "particle", "how the uncertainty is kept"},
      Role{"resampler", "systematic", "how a particle filter renews its particles"},
      Role{"corrector", "none", "what is added to the filter's estimate"},
      Role{"recovery", "restart", "what happens when the filter and the radio disagree for long"},
  };
  return roles;
}

std::span<const PartDescription> pipeline_parts() {
  static const std::array parts = {
      PartDescription{"readings", "fresh", "readings heard since the last scan, not older than a limit, at their own time",
                      {{"max_age_s", ReadingGateSettings{}.max_age_s, 0.1, 600,
                        "older readings are dropped: phones hand out caches; larger keeps stale places", "-"},
                       {"delay_s", ReadingGateSettings{}.delay_s, -5, 10,
                        "added to the time a reading was heard: clock offset and smoothing inside the phone", "-"},
                       {"drop_repeats", 1, 0, 1, "1: a transmitter whose reading did not advance is dropped", "-", true}}},
      PartDescription{"readings", "all", "every reading, at the scan's arrival", {}},
      PartDescription{"measurement", "fix", "the locator's point with its sigma [P1 eq. 13]",
                      {{"sigma_m", 0, 0, 100, "per axis; 0 = the locator's own; larger trusts the walking more", "[P1 eq. 13]"},
                       {"sigma_scale", 1, 0.01, 100, "factor on the locator's own sigma; larger trusts the walking more", "-"},
                       {"gate_sigmas", 0, 0, 100, "a fix farther off is not applied; 0 = every fix is", "[P4]"}}},
      PartDescription{"measurement", "ranges", "the locator's distances, each with its sigma [P3 eq. 3]",
                      {{"sigma_scale", 1, 0.01, 100, "factor on the ranges' sigmas; larger trusts the walking more", "-"}}},
      PartDescription{"measurement", "field", "the locator's likelihood at every particle",
                      {{"weight", FieldSettings{}.weight, 0.01, 10, "power of the likelihood; smaller discounts scans that err together", "-"},
                       {"outlier", FieldSettings{}.outlier, 0, 1, "likelihood no particle falls below, against the best one's", "-"}}},
      PartDescription{"measurement", "none", "scans are not used", {}},
      PartDescription{"floor", "vote", "recursive vote over floors with hysteresis",
                      {{"memory", FloorVoteSettings{}.memory, 0, 1, "weight of the past in each vote; 0 = the newest scan alone", "-"},
                       {"margin", FloorVoteSettings{}.margin, 0, 0.9, "lead another floor needs before the floor changes", "-"}}},
      PartDescription{"gnss", "fix", "a point with the sigma the receiver states; needs a georeferenced building", {}},
      PartDescription{"gnss", "start", "satellite fixes start the track and then fall silent [P5]",
                      {{"start_s", 20, 0, 3600, "seconds from the first fix during which they count", "[P5]"}}},
      PartDescription{"gnss", "none", "satellite fixes are not used", {}},
      PartDescription{"heading", "reported", "the phone's heading, turned into the building's frame", {}},
      PartDescription{"heading", "track-kalman", "corrected by the direction of the filter's own track [P1 eq. 17]",
                      {{"turn_sigma_rad_rts", HeadingFilterSettings{}.turn_sigma_rad_rts, 0, 3,
                        "random walk of the phone's heading error; larger follows the track", "[P1 eq. 17]"},
                       {"track_sigma_m", HeadingFilterSettings{}.track_sigma_m, 0.01, 100,
                        "error of the track across its direction; larger trusts the phone", "[P1 eq. 17]"},
                       {"piece_m", HeadingFilterSettings{}.piece_m, 1, 100,
                        "length of track a direction is read off; larger is steadier and sees a drift later", "[P1 eq. 17]"}}},
      PartDescription{"speed", "none", "speed is not a measurement", {}},
      PartDescription{"speed", "speed", "the phone's speed measures the state's [P5 eq. 2]",
                      {{"sigma_mps", 0, 0, 10, "0 = as the phone states it; larger trusts the motion model", "[P5 eq. 4]"}}},
      PartDescription{"azimuth", "direction", "the phone's heading measures the direction of the state's velocity [P5 eq. 2]",
                      {{"sigma_rad", 0, 0, 3, "0 = as the phone states it; larger trusts the motion model", "[P5 eq. 4]"}}},
      PartDescription{"azimuth", "resolved", "speed and heading as one velocity along and across the heading, linear [P5 eq. 4]",
                      {{"sigma_rad", 0, 0, 3, "0 = as the phone states it; larger trusts the motion model", "[P5 eq. 4]"},
                       {"sigma_mps", 0, 0, 10, "of the speed, likewise", "[P5 eq. 4]"}}},
      PartDescription{"azimuth", "none", "heading is not a measurement", {}},
      walkers_description(),
      PartDescription{"recovery", "restart", "start again from the fix after it disagreed several times in a row",
                      {{"gate_sigmas", RecoverySettings{}.gate_sigmas, 1, 100, "distance that counts as disagreement", "-"},
                       {"misses", RecoverySettings{}.misses, 1, 100, "disagreements in a row before the restart", "-", true}}},
      PartDescription{"recovery", "none", "never", {}},
      PartDescription{"corrector", "none", "the filter's estimate is published as it is", {}},
      PartDescription{"corrector", "back-propagation", "networks add the residual they learnt from the survey's walks [P4]",
                      {{"iterations", BackPropagationSettings{}.iterations, 1, 100000, "training passes at most", "[P4]", true}}},
  };
  return parts;
}

}  // namespace wayfuse
