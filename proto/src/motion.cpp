#include "wayfuse/proto/motion.hpp"

namespace wayfuse {

double MotionReport::distance_m() const {
  if (at_rest) return 0.0;
  if (steps > 0) return steps * step_length_m;
  return speed_mps ? *speed_mps * seconds(interval) : 0.0;
}

}  // namespace wayfuse
