#pragma once

#include <optional>
#include <string>

#include "db/zone_record.hpp"
#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/time.hpp"

namespace wayfuse {

/// When a phone counts as inside a zone. The defaults are measured: server/zones/README.md.
struct ZoneRules {
  double enter = 0.9;                                  ///< mass inside from which the evidence says in, 0.5..1
  double leave = 0.1;                                  ///< mass inside up to which it says out, 0..0.5
  double settle_m = 2.5;                               ///< walked while the evidence stands, before it is believed; 0..50
  Duration settle_at_rest = std::chrono::seconds(60);  ///< or stood; walking and standing add up
  Duration corrected_within = std::chrono::seconds(60);  ///< a transition this young is taken back if the position jumps
};

/// One phone and one zone: inside or not, by the mass of its positions and omlox's tolerances.
///
/// A boundary is crossed by walking: evidence is believed once the phone has walked `settle_m` under it or stood under it for
/// `settle_at_rest`, without a position in between that says otherwise. So the noise of a phone that stands still crosses
/// nothing, and a wrong start is still mended.
///
/// Tolerances: a phone outside but within `exit_tolerance_m` of the region leaves after `tolerance_timeout`; beyond it leaves at
/// once; both are told `exit_delay` later. Without a position for `timeout` it leaves.
///
/// Thread: confined to its phone.
class ZonePresence {
 public:
  struct Evidence {
    ServerTime at;
    double mass = 0.0;             ///< of the position inside the region
    double mass_tolerated = 0.0;   ///< inside the region grown by `exit_tolerance_m`; at least `mass`
    double walked_m = 0.0;         ///< since the phone's position before
    Place place;
    double radius95_m = 0.0;
  };
  enum class Change {
    kNone,
    kEntered,
    kLeft,
    kEntryWithdrawn,               ///< it never was inside: the position jumped out as nobody walks
    kExitWithdrawn,                ///< it never was outside
  };

  Change take(const Evidence& evidence, const ZoneRecord& zone, const ZoneRules& rules);
  /// Time passes without a position: exits that were delayed, and the timeout.
  Change tick(ServerTime now, const ZoneRecord& zone, const ZoneRules& rules);

  bool inside() const { return inside_; }
  double mass() const { return mass_; }
  /// Nothing to remember: as if it had never been seen.
  bool idle() const { return !inside_ && !changed_at_ && credit_in_ == 0.0; }

 private:
  Change leave(ServerTime now);
  Change exit_if_due(ServerTime now, const ZoneRecord& zone);
  void note_side(bool other_side, const Evidence& evidence);
  bool withdraws(const ZoneRules& rules) const;

  bool inside_ = false;
  double mass_ = 0.0;
  std::optional<ServerTime> seen_at_;
  std::optional<ServerTime> changed_at_;     ///< of the last transition told
  double credit_in_ = 0.0;                   ///< 1 = the evidence is believed
  double credit_out_ = 0.0;                  ///< outside the region
  double credit_beyond_ = 0.0;               ///< outside its tolerance too
  std::optional<ServerTime> out_since_;      ///< believed to be outside the region
  std::optional<ServerTime> beyond_since_;
  // How it came to the side the evidence is on: on foot, or by a jump of the position.
  std::optional<Place> last_on_side_;        ///< newest place on the side that was told
  double radius95_on_side_m_ = 0.0;
  double walked_off_side_m_ = 0.0;
  std::optional<ServerTime> off_side_since_;
  bool jumped_ = false;
};

}  // namespace wayfuse
