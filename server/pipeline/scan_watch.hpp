#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "wayfuse/proto/place.hpp"
#include "wayfuse/proto/scan.hpp"

namespace wayfuse {

struct ScanWatchSettings {
  int strong = 3;                  ///< strong radios out of place in one scan: no accident; more forgives more
  int strong_twice = 2;            ///< so many in two scans in a row are none either
  int same_levels = 8;             ///< radios heard again to the decibel, though anew, before a scan counts as a copy
  double same_share = 0.9;         ///< of the radios both scans heard
  int copies = 2;                  ///< copies in a row, walked between: somebody plays a recording
  double walked_m = 1.0;           ///< between copies; at rest levels may stay
  int agreed = 2;                  ///< scans that fitted the track before one can be out of line
  double misfit = 0.12;            ///< of a distance in signal space: a scan that fits elsewhere by so much better is out of line
  int jumps = 2;                   ///< scans in a row out of line, and in line with each other
  double together_m = 20.0;        ///< apart they may lie
  double hold_s = 5.0;             ///< a suspicion stays so long after its newest reason
};

/// What makes a scan dishonest.
enum class Trick : std::uint8_t { kCopied, kElsewhere, kOutOfPlace };

/// Tells scans that cannot be honest: radios out of place, a recording played again, a place nobody could have walked to
/// [SAFETY C26]. It says so and moves nothing.
///
/// Thread: confined to one session. A copy goes on alike.
class ScanWatch {
 public:
  explicit ScanWatch(const ScanWatchSettings& settings = {}) : settings_(settings) {}

  /// Every scan as it arrives; `odometry` = where dead reckoning is by then.
  void hear(const RssScan& scan, BuildingPoint odometry);
  /// Of the same scan: strong radios that do not belong to the place.
  void count_strong(int out_of_place, PhoneTime at);
  /// Of the same scan: how much worse it fits where the track was than elsewhere (Locator::misfit), and where that is by now.
  /// Scans that point here and there are bad scans; those that agree with each other tell of a place.
  void compare(double misfit, Place elsewhere, PhoneTime at);

  /// Of the same scan: it alone made the track be given up. Suspect where others had agreed with that track.
  void left_at_once(PhoneTime at) {
    if (agreed_ >= settings_.agreed) suspect_from(at, Trick::kElsewhere);
  }

  /// The survey is another one: what agreed with the older says nothing of what may contradict this one.
  void begin_anew_with_the_survey() { agreed_ = jumps_ = 0; }

  bool suspect(PhoneTime at) const { return since_s(at) <= settings_.hold_s; }
  /// The newest reason, where suspect().
  Trick trick() const { return trick_; }
  /// The newest scan repeats an older one as if heard anew.
  bool copied() const { return copies_ > 0; }
  /// Several scans in a row, none of them a copy, contradict a track that others agreed with: the phone was carried off, or somebody
  /// relays another place.
  bool elsewhere() const { return jumps_ >= settings_.jumps && copies_ == 0; }

 private:
  double since_s(PhoneTime at) const;
  void suspect_from(PhoneTime at, Trick trick) { newest_reason_ = at, trick_ = trick; }

  struct Heard {                   // small, as every copy of a session holds hundreds
    std::uint32_t name;            // of the address, 32 bits of it all
    std::int16_t level;            // hundredths of a decibel
    std::uint16_t age;             // hundredths of a second
  };
  static Heard brief(const ScanReading& reading);
  ScanWatchSettings settings_;
  std::vector<Heard> last_;        ///< ascending by name: every radio's newest reading of the scan before
  PhoneTime last_at_;
  std::vector<Heard> now_;         ///< scratch, empty between scans
  BuildingPoint last_odometry_;
  std::optional<PhoneTime> newest_reason_;
  Trick trick_ = Trick::kCopied;
  int copies_ = 0;
  int strong_before_ = 0;
  int agreed_ = 0;
  int jumps_ = 0;
  Place jumped_to_;
};

}  // namespace wayfuse
