#pragma once

namespace wayfuse {

struct HeadingFilterSettings {
  double turn_sigma_rad_rts = 0.03;   ///< random walk of the predicted heading, rad per root second: larger follows the track
  double track_sigma_m = 2.0;         ///< of the particle track across its direction: larger trusts the phone
  double piece_m = 6.0;               ///< length of track a direction is read off: larger is steadier and sees a drift later
};

/// The Kalman filter on heading [P1 eq. 17]: predicted by the phone's turn, corrected by the direction of the particle track.
///
/// Differs from [P1 eq. 17]: the turn over an interval is the change of the phone's own heading, which integrates the
/// gyroscope at full rate, not one gyroscope sample times the interval; R falls with the length of the track piece it
/// was measured on. Innovations wrap to (-pi, pi]. Thread: confined to one session.
class HeadingFilter {
 public:
  explicit HeadingFilter(const HeadingFilterSettings& settings) : settings_(settings) {}

  bool started() const { return started_; }
  void start(double heading_rad, double sigma_rad);
  /// phi- = phi + turn, P- = P + Q.
  void predict(double turn_rad, double dt_s);
  /// K = P-/(P- + R), phi = phi- + K (phi_PF - phi-), P = (1 - K) P-. `track_m` is the length the direction was measured on.
  void update(double track_heading_rad, double track_m);
  /// The same with R given.
  void update_with_variance(double measured_rad, double variance_rad2);

  double heading_rad() const { return heading_rad_; }
  double variance_rad2() const { return variance_rad2_; }

 private:
  HeadingFilterSettings settings_;
  double heading_rad_ = 0.0;
  double variance_rad2_ = 0.0;
  bool started_ = false;
};

}  // namespace wayfuse
