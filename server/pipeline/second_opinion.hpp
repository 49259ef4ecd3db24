#pragma once

#include <memory>

#include "server/pipeline/walker_cloud.hpp"

namespace wayfuse {

/// A rival to a track that a scan contradicts: a cloud begun from that scan, walking and hearing beside the first.
///
/// Which of the two foretells the following scans better takes the track: a Bayes factor, each scan counted for what it does not
/// repeat of the last. A lost track is left in one piece, its place found from several scans together: nobody stays behind to pull
/// the position between two places. Who loses is heard on for a while, and takes a hasty verdict back. There is none, and it costs
/// nothing, while scans agree with the track. Thread: confined to one session.
class SecondOpinion {
 public:
  SecondOpinion() = default;
  SecondOpinion(const SecondOpinion& other) : rival_(other.rival_ ? std::make_unique<Rival>(*other.rival_) : nullptr) {}

  static constexpr double kSurveyed = 1.8;     ///< mismatch of a scan beyond which nobody surveyed where it was heard
  static constexpr double kFitsNothing = 2.5;  ///< beyond which it fits nothing at all

  /// How much worse than elsewhere a scan must fit around a track to contradict it (Locator::misfit), by how well it fits at all.
  static bool contradicts(double misfit, double mismatch);

  bool begun() const { return rival_ != nullptr; }
  /// It came up against the track, and is not who was the track before.
  bool challenges() const { return rival_ && !rival_->unseated; }
  /// The rival is about there.
  bool speaks_for(Place place) const;
  /// From the locator's newest scan; stays unbegun when it cannot say. `lead` of what it takes to win that scan has won it already.
  void begin(const WalkerSettings& settings, Locator& locator, FloorOrdinal floor, const WalkableArea::Plan* plan, BuildingPoint carried,
             const CompassPrior& compass, Random& random, double lead = 0.0);
  /// As WalkerCloud::walk.
  void walk(double dx_m, double dy_m, double sigma_m, double on_foot_s, Random& random);
  struct First {
    double log_evidence = 0.0;     ///< of the newest scan (WalkerCloud::Hearing)
    bool contradicted = false;     ///< by it
    BuildingPoint mean;
    FloorOrdinal floor;
  };
  /// The newest scan, heard by both. True: change_places() is due.
  bool hear(Locator& locator, const First& first, BuildingPoint carried, double echo, const CompassPrior& compass, Random& random);
  void drop() { rival_.reset(); }
  /// Where begun(). The second becomes the track, and the track, with the floor it is on, the second.
  void change_places(WalkerCloud& track, FloorOrdinal& floor);

 private:
  struct Rival {
    WalkerCloud cloud;
    FloorOrdinal floor;
    double lead = 0.0;             ///< log Bayes factor, above 0: the second foretells better
    int heard = 0;
    bool unseated = false;         ///< it was the track before
  };
  std::unique_ptr<Rival> rival_;   // a session that needs none pays a pointer
};

}  // namespace wayfuse
