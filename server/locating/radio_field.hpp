#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "server/locating/catalogue.hpp"
#include "server/locating/level_blocks.hpp"
#include "server/locating/survey_fingerprints.hpp"

namespace wayfuse {

/// What the field learns from a building's own survey, walk against the other walks (field_learning.hpp).
struct FieldWeights {
  double sorensen = 22.0;          ///< weight of the Sorensen field in the log-likelihood
  double cosine = 12.0;            ///< of the cosine field: what carries a phone with another gain
  double bandwidth_m = 3.5;        ///< of the kernel that spreads a fingerprint over its surroundings; fixed (server/pipeline, Decisions: 2.8 to 5 m)
  double delay_s = 1.5;            ///< how much later than its stamp a reading belongs
  double usual_distance = 0.35;    ///< mean of a scan's smallest Sorensen distances to another walk's fingerprints, median
  double loudness = 0.0;           ///< RadioField::loudness of the survey's own scans, median
};
constexpr std::size_t kFieldVoters = 8;  ///< fingerprints that say how well a scan fits, the nearest in signal space

struct RadioFieldSettings {
  ReadingStrength strength{.power = 0.0};  ///< power 0: from the survey
  double sorensen_sharpness = 30.0;  ///< larger lets the best fingerprint near a point speak alone
  double cosine_sharpness = 25.0;
  double neutral = 0.2;            ///< kernel mass of unsurveyed ground, which says neither yes nor no
  double beyond_m = 12.0;          ///< off the survey, how far what is heard at its edge still speaks; the bandwidth: not at all
  double floor_gain = 10.0;        ///< log odds of floors a unit of cosine distance; larger makes errors stick
  double delay_s = -1.0;           ///< how much later than its stamp a reading belongs; below 0: from the survey
  bool learn = true;               ///< weights, delay and shifts of walks from the survey; otherwise FieldWeights as they stand
  bool between = true;             ///< fingerprints for ground between survey walks (between_walks.hpp)
  double spacing_s = 2.0;          ///< between fingerprints of a survey walk
};

/// The survey as a field of likelihood: how well a scan fits what is heard about a point.
///
/// Two distances between a scan and every fingerprint, over radios instead of addresses: Sorensen's, and the cosine of the
/// angle, both on the powed representation [Torres-Sospedra et al. 2015]. Each becomes a field by a log mean of
/// exponentials under a Gaussian kernel, `L(x) = 1/b log((sum K e^{-b (d - m)} + n) / (sum K + n))`: the best fingerprints
/// near x count. Off the survey the nearest fingerprints speak on, K = e^{-(r^2 - n^2) / 2 h^2 - n^2 / 2 B^2} at the distance n of
/// the nearest, ever more quietly: a walker who leaves surveyed ground is not torn back onto it. Farther out ground is neutral.
/// Fields are sums over a 2 m lattice, evaluated only where somebody asks.
/// Immutable and thread-safe.
class RadioField final : public LocatorModel, public std::enable_shared_from_this<RadioField> {
 public:
  RadioField(std::span<const ReferencePoint> survey, const RadioFieldSettings& settings);
  std::unique_ptr<Locator> make() const override;

  /// Fingerprints of one floor, and the lattice over them.
  struct Storey {
    FloorOrdinal floor;
    std::uint32_t begin = 0;         ///< its fingerprints are begin .. end - 1
    std::uint32_t surveyed_end = 0;  ///< from here on they are made up from those before (between_walks.hpp)
    std::uint32_t end = 0;
    float x_m = 0.0f;                ///< of node (0, 0)
    float y_m = 0.0f;
    int columns = 0;
    int rows = 0;
    std::uint32_t first_node = 0;    ///< among all storeys' nodes
    float sorensen_middle = 1.0f;    ///< median distance between fingerprints of different walks
    float cosine_middle = 1.0f;
    /// The node nearest to the point; absent off the lattice.
    std::optional<std::uint32_t> node_near(BuildingPoint point) const;
  };
  struct Kernel {
    std::uint32_t fingerprint = 0;
    float mass = 0.0f;
  };
  static constexpr float kLattice_m = 2.0f;

  const RadioFieldSettings& settings() const { return settings_; }
  const FieldWeights& weights() const { return weights_; }
  const RadioNames& radios() const { return radios_; }
  std::span<const Storey> storeys() const { return storeys_; }
  std::span<const SurveyFingerprint> fingerprints() const { return fingerprints_; }
  /// How many fingerprints stand where this one does, by the kernel: at least 1, itself.
  float crowd(std::uint32_t fingerprint) const { return crowd_[fingerprint]; }
  std::span<const SurveyQuery> queries() const { return queries_; }
  std::uint32_t nodes() const { return static_cast<std::uint32_t>(first_kernel_.size()) - 1; }
  std::span<const Kernel> kernels(std::uint32_t node) const {
    return {kernels_.data() + first_kernel_[node], first_kernel_[node + 1] - first_kernel_[node]};
  }

  /// Whether a surveyed fingerprint within `around_m` of the point hears the radio with at least this strength.
  bool heard_near(std::uint32_t radio, const Storey& storey, BuildingPoint point, double around_m, float least_strength) const;

  /// Where the survey heard a radio loudest: it stands near there if that was loud.
  struct Home {
    Place place;
    float strength = 0.0f;
  };
  const Home& home(std::uint32_t radio) const { return homes_[radio]; }

  /// How much stronger `heard` is than the surveyed fingerprints around the point, over the radios both hear: mean of the logarithms of
  /// the sums' ratios; absent where fewer than three fingerprints share three radios. Those of `without_walk` are left out.
  std::optional<double> loudness(std::span<const RadioStrength> heard, const Storey& storey, BuildingPoint point, int without_walk = -1) const;

  /// Memory one scan's matching needs, and what was heard in it; borrowed for the time it takes.
  struct Scratch {
    struct Row {
      std::uint64_t key;
      float age_s;
      float rss_dbm;
    };
    std::vector<Row> rows;           ///< readings by radio
    std::vector<RadioStrength> heard;  ///< known radios
    std::vector<std::optional<std::uint32_t>> strong;  ///< radios heard from close by; absent: not on the map
    std::vector<RadioStrength> set_aside;  ///< strong ones, while the rest of the scan is asked about them
    std::vector<float> common;       ///< a fingerprint: sum of the smaller strengths; then e^{-b (d - m)}
    std::vector<float> product;      ///< a fingerprint: scalar product; then the same of the cosine
    std::vector<float> sorensen;     ///< a fingerprint: distances
    std::vector<float> cosine;
    std::vector<float> level;        ///< a node: log-likelihood, where `known` says so
    std::vector<std::uint32_t> known;  ///< a node: number of the scan it was evaluated for
    std::uint32_t scan = 0;
    std::vector<float> cumulated;    ///< a storey's resemblances summed up, to draw from
  };
  std::unique_ptr<Scratch> borrow() const;
  void give_back(std::unique_ptr<Scratch> scratch) const;

  /// Both distances from `heard` to every fingerprint. `sum` and `norm` are over everything heard, unknown radios too.
  void match(std::span<const RadioStrength> heard, float sum, float norm, Scratch& scratch) const;
  /// e^{-b (d - m)} of a storey's fingerprints, ready for node().
  void expose(const Storey& storey, Scratch& scratch) const;
  /// Log-likelihood at a node, with fingerprints of `without_walk` left out (-1: none). After expose().
  struct Pair {
    float sorensen;
    float cosine;
  };
  Pair node(std::uint32_t number, const Scratch& scratch, int without_walk = -1) const;

 private:
  void index_fingerprints();
  void find_homes();
  void bring_walks_together();
  void fill_between();
  void near_nodes(float reach_m, const auto& each) const;
  std::uint32_t measure_storeys(float edge_m);
  void lay_lattice();
  void count_crowds();
  void find_middles();
  void take(SurveyReading reading);
  double learn_power(const std::function<void()>& read);
  double learn_delay_s(const std::function<void()>& read);

  RadioFieldSettings settings_;
  FieldWeights weights_;
  RadioNames radios_;
  std::vector<SurveyFingerprint> fingerprints_;  // floor by floor along a space-filling curve
  std::vector<SurveyQuery> queries_;
  std::vector<Storey> storeys_;
  std::vector<float> sum_;                       // a fingerprint; then up to a whole block
  std::vector<float> norm_;
  std::vector<int> walk_;                        // a fingerprint
  std::vector<float> crowd_;                     // a fingerprint
  std::vector<Home> homes_;                      // a radio
  LevelBlocks blocks_;                           // strengths, fingerprints x radios
  std::vector<std::uint32_t> first_kernel_;      // a node, and one past the end
  std::vector<Kernel> kernels_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Scratch>> spare_;
};

}  // namespace wayfuse
