#include "server/locating/between_walks.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace wayfuse {
namespace {

constexpr int kEvery = 2;                // nodes of the lattice, in both directions
constexpr double kLeastGap_m = 5.0;      // nearer to a surveyed fingerprint its kernel speaks
constexpr double kMostGap_m = 10.0;
constexpr double kWidth = 0.7;           // of the kernel, of the gap, beside a metre
constexpr double kLeast_m = 1.0;
constexpr double kReach = 3.0;           // kernel widths beyond the nearest
constexpr double kOneSided = 0.6;        // of the gap: with the centre of what is heard so far off, there is one side only
constexpr double kLeastLevel = 0.05;     // of the strongest there is: fainter is not heard
constexpr std::size_t kFewestRadios = 3;

class Between {
 public:
  explicit Between(const RadioField& field) : field_(field), level_(field.radios().size()) {}

  std::vector<SurveyFingerprint> make() {
    for (const RadioField::Storey& storey : field_.storeys()) {
      for (int row = 0; row < storey.rows; row += kEvery) {
        for (int column = 0; column < storey.columns; column += kEvery) {
          at(storey, {static_cast<double>(storey.x_m + RadioField::kLattice_m * static_cast<float>(column)),
                      static_cast<double>(storey.y_m + RadioField::kLattice_m * static_cast<float>(row))});
        }
      }
    }
    return std::move(made_);
  }

 private:
  void at(const RadioField::Storey& storey, BuildingPoint point) {
    const auto surveyed = field_.fingerprints().subspan(storey.begin, storey.surveyed_end - storey.begin);
    double gap_m = INFINITY;
    for (const SurveyFingerprint& each : surveyed) gap_m = std::min(gap_m, distance_m(each.place.point, point));
    if (gap_m < kLeastGap_m || gap_m > kMostGap_m || !average(storey, surveyed, point, gap_m)) return;
    SurveyFingerprint fingerprint{{point, storey.floor}, -1, {}};
    for (std::uint32_t radio = 0; radio < level_.size(); ++radio) {
      if (level_[radio] > kLeastLevel) fingerprint.heard.push_back({radio, static_cast<float>(std::pow(level_[radio], power()))});
    }
    if (fingerprint.heard.size() >= kFewestRadios) made_.push_back(std::move(fingerprint));
  }

  // False where all that is heard lies on one side.
  bool average(const RadioField::Storey& storey, std::span<const SurveyFingerprint> surveyed, BuildingPoint point, double gap_m) {
    const double width_m = kWidth * gap_m + kLeast_m;
    std::ranges::fill(level_, 0.0);
    double total = 0.0;
    BuildingPoint centre;
    for (std::uint32_t i = 0; i < surveyed.size(); ++i) {
      const BuildingPoint there = surveyed[i].place.point;
      const double off_m = distance_m(there, point);
      if (off_m > gap_m + kReach * width_m) continue;
      const double weight = std::exp(-(off_m * off_m - gap_m * gap_m) / (2.0 * width_m * width_m)) / static_cast<double>(field_.crowd(storey.begin + i));
      total += weight;
      centre = {centre.x_m + weight * there.x_m, centre.y_m + weight * there.y_m};
      for (const RadioStrength& heard : surveyed[i].heard) level_[heard.radio] += weight * std::pow(static_cast<double>(heard.strength), 1.0 / power());
    }
    for (double& level : level_) level /= total;
    return distance_m({centre.x_m / total, centre.y_m / total}, point) <= kOneSided * gap_m;
  }

  double power() const { return field_.settings().strength.power; }

  const RadioField& field_;
  std::vector<double> level_;            // a radio, of the strongest there is
  std::vector<SurveyFingerprint> made_;
};

}  // namespace

std::vector<SurveyFingerprint> fingerprints_between(const RadioField& field) { return Between(field).make(); }

}  // namespace wayfuse
