#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "wayfuse/proto/fingerprint.hpp"

namespace wayfuse {

/// How strongly a reading speaks: powed representation of the level (Torres-Sospedra et al. 2015), fading with age.
///
/// Phones hand out caches. A reading up to `fresh_s` old counts in full and then fades; older than `most_age_s` it is gone.
struct ReadingStrength {
  double power = 2.72;             ///< larger listens to near transmitters only
  double fresh_s = 2.0;
  double fade_s = 4.0;
  double most_age_s = 8.0;
  float of(double rss_dbm, double age_s) const;
};

/// Radios instead of addresses: the virtual access points of one radio share the last five octets and the channel. Merging
/// them keeps one radio from voting ten times.
///
/// An address that is locally administered may be a passing phone's hot spot or a radio's virtual access point: it is kept
/// only if it was heard on `kWalksToTrust` survey walks or standing points, which no passer-by is.
class RadioNames {
 public:
  static constexpr int kWalksToTrust = 3;
  static std::uint64_t key(const ScanReading& reading);

  std::optional<std::uint32_t> find(std::uint64_t key) const;
  std::uint32_t size() const { return static_cast<std::uint32_t>(keys_.size()); }

 private:
  friend class FingerprintMaker;
  std::vector<std::uint64_t> keys_;  // ascending; a radio's number is its place
};

struct RadioStrength {
  std::uint32_t radio = 0;
  float strength = 0.0f;
};

/// One place of the survey with what is heard there, strengths ascending by radio.
struct SurveyFingerprint {
  Place place;
  int walk = 0;                    ///< equal numbers: the same survey walk; standing points have one each; -1: nobody heard it, it is made up
  std::vector<RadioStrength> heard;
};

/// What a phone on a survey walk would have handed over at one moment, with the place where that is to be matched.
struct SurveyQuery {
  Place place;
  int walk = 0;
  std::vector<RadioStrength> heard;
};

/// The survey made ready for matching.
///
/// A survey walk is put together again from its fragments: every reading stands at its own time, and a fingerprint is made
/// every `spacing_s` from the readings nearest in time on *both* sides, which an online scan cannot see. `delay_s` is how
/// much later than its stamp a reading belongs (clock offset, smoothing inside the phone, body shadow).
struct SurveyReading {
  RadioNames radios;
  std::vector<SurveyFingerprint> fingerprints;
  std::vector<SurveyQuery> queries;
};
struct SurveyReadingSettings {
  ReadingStrength strength;
  double delay_s = 2.0;
  double spacing_s = 2.0;
  double reach_s = 5.0;            ///< readings farther in time from a fingerprint are not its own
  double query_every_s = 4.0;
};
SurveyReading read_survey(std::span<const ReferencePoint> survey, const SurveyReadingSettings& settings);

}  // namespace wayfuse
