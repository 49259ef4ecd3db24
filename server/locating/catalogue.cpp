#include "server/locating/catalogue.hpp"

#include <array>

#include "server/locating/nearest_neighbours.hpp"
#include "server/locating/probabilistic.hpp"
#include "server/locating/propagation.hpp"
#include "server/locating/radio_field.hpp"
#include "server/locating/similarity.hpp"
#include "server/locating/trilateration.hpp"

namespace wayfuse {
namespace {

constexpr NearestNeighboursSettings kNearest;
const SettingDescription kNeighbours{"k", kNearest.k, 1, 64, "neighbours averaged; more are smoother and blur corners", "[P1 eq. 2]", true};
const SettingDescription kExponent{"exponent", kNearest.distance.exponent, 0.5, 8,
                                   "Minkowski's a: 1 Manhattan, 2 Euclidean; larger heeds the worst transmitter", "[P2]"};
const SettingDescription kFloor{"floor_dbm", kNearest.distance.floor_dbm, -120, -60,
                                "level assumed for a transmitter heard on one side only; lower punishes a missing one harder",
                                "[P1 eq. 1]"};

template <bool kWeighted>
std::shared_ptr<const LocatorModel> neighbours(const LocatingSite& site, const PartSettings& s) {
  return std::make_shared<NearestNeighbours>(
      site.map, NearestNeighboursSettings{s.count("k"), kWeighted, {s["exponent"], s["floor_dbm"]}});
}

std::shared_ptr<const LocatorModel> nearest(const LocatingSite& site, const PartSettings& s) {
  return std::make_shared<NearestNeighbours>(site.map, NearestNeighboursSettings{1, false, {s["exponent"], s["floor_dbm"]}});
}

constexpr ProbabilisticSettings kBayes;
const SettingDescription kTemper{"temper", kBayes.temper, 0.01, 1,
                                 "power of the likelihood: readings of a scan are not independent; larger trusts one scan more", "-"};
const SettingDescription kSurprise{"surprise", kBayes.surprise, -30, -2,
                                   "log density of a level the point never heard; nearer 0 forgives new transmitters", "-"};
const SettingDescription kSpread{"sigma_db", kBayes.sigma_db, 1, 20, "spread of a level at a point before it is measured, smoothing after",
                                 "-"};
constexpr TrilaterationSettings kRanges;
constexpr PropagationSettings kModelled;

template <bool kHistogram>
std::shared_ptr<const LocatorModel> probabilistic(const LocatingSite& site, const PartSettings& s) {
  return std::make_shared<Probabilistic>(
      site, ProbabilisticSettings{kHistogram, s["sigma_db"], kBayes.prior_scans, s["surprise"], s["temper"]});
}

std::shared_ptr<const LocatorModel> trilateration(const LocatingSite& site, const PartSettings& s) {
  return std::make_shared<Trilateration>(site.map, TrilaterationSettings{s.count("strongest"), s["threshold"], s.on("online"), s["beyond_m"]});
}

std::shared_ptr<const LocatorModel> propagation(const LocatingSite& site, const PartSettings& s) {
  return std::make_shared<Propagation>(site.map, PropagationSettings{s["cell_m"], s.count("strongest")});
}

constexpr RadioFieldSettings kField;

std::shared_ptr<const LocatorModel> radio_field(const LocatingSite& site, const PartSettings& s) {
  RadioFieldSettings settings;
  settings.strength.power = s["power"];
  settings.neutral = s["neutral"];
  settings.beyond_m = s["beyond_m"];
  settings.floor_gain = s["floor_gain"];
  settings.delay_s = s["delay_s"];
  settings.learn = s.on("learn");
  settings.between = s.on("between");
  return std::make_shared<RadioField>(site.survey, settings);
}

constexpr SimilaritySettings kLike;

std::shared_ptr<const LocatorModel> similarity(const LocatingSite& site, const PartSettings& s) {
  return std::make_shared<Similarity>(site.map, SimilaritySettings{s.count("k"), s["floor_dbm"], s["power"], s["cosine"],
                                                                   s["offset_most_db"], s["sharpness"]});
}

}  // namespace

std::span<const LocatorRow> locator_catalogue() {
  static const std::array rows = {
      LocatorRow{{"locator", "none", "scans say nothing about the place", {}}, nullptr, false},
      LocatorRow{{"locator", "nn", "the nearest fingerprint in signal space (RADAR)", {kExponent, kFloor}}, nearest},
      LocatorRow{{"locator", "knn", "plain mean of the K nearest fingerprints [P2]", {kNeighbours, kExponent, kFloor}},
                 neighbours<false>},
      LocatorRow{{"locator", "wknn", "mean of the K nearest fingerprints weighted by 1 / D [P1 eqs. 1-3]",
                  {kNeighbours, kExponent, kFloor}},
                 neighbours<true>},
      LocatorRow{{"locator", "gaussian", "probabilistic fingerprints, a Gaussian a level (Horus)", {kSpread, kSurprise, kTemper}},
                 probabilistic<false>},
      LocatorRow{{"locator", "histogram", "probabilistic fingerprints, the point's own readings smoothed (Horus)",
                  {kSpread, kSurprise, kTemper}},
                 probabilistic<true>},
      LocatorRow{{"locator", "trilateration", "distances by path loss, linear least squares, exponents learnt online [P3]",
                  {{"strongest", kRanges.strongest, 3, 32, "transmitters used, the strongest first", "[P3 eq. 5]", true},
                   {"threshold", kRanges.threshold, 0, 5, "T: an exponent off by more is replaced; smaller follows noise", "[P3 algorithm 2]"},
                   {"online", kRanges.online, 0, 1, "0: the survey's exponents stay", "[P3 algorithm 2]", true},
                   {"beyond_m", kRanges.beyond_m, 0, 100000,
                    "a solution farther outside the surveyed box is no fix; larger believes wilder ones", "-"}}},
                 trilateration, true, true},
      LocatorRow{{"locator", "propagation", "fingerprints computed from path-loss laws (RADAR's model method)",
                  {{"cell_m", kModelled.cell_m, 0.25, 10, "of the modelled map; smaller is slower", "[P1]"},
                   {"strongest", kModelled.strongest, 1, 64, "transmitters used, the strongest first", "[P1]", true}}},
                 propagation},
      LocatorRow{{"locator", "radio-field", "a field of likelihood over merged radios: Sorensen times cosine, weights learnt from the survey",
                  {{"power", kField.strength.power, 0, 8, "of the level's representation, 0: learnt from the survey; larger listens to near transmitters only", "-"},
                   {"neutral", kField.neutral, 0.001, 10, "kernel mass of unsurveyed ground; larger trusts sparse surveys less", "-"},
                   {"beyond_m", kField.beyond_m, 1, 50, "off the survey, how far what is heard at its edge still speaks; larger holds on to walkers there", "-"},
                   {"floor_gain", kField.floor_gain, 0, 100, "log odds of floors a unit of distance; larger makes errors stick", "-"},
                   {"delay_s", kField.delay_s, -1, 10, "how much later than its stamp a reading belongs; below 0: learnt from the survey's walks", "-"},
                   {"learn", kField.learn, 0, 1, "0: the weights stay as they are written, and walks where they were marked", "-", true},
                   {"between", kField.between, 0, 1, "0: nothing is said of ground between survey walks but by its edges", "-", true}}},
                 radio_field, true, false, true},
      LocatorRow{{"locator", "similarity", "neighbours by what both heard: Sorensen and cosine of powed levels",
                  {{"k", kLike.k, 1, 64, "neighbours averaged; more are smoother and blur corners", "-", true},
                   {"floor_dbm", kLike.floor_dbm, -120, -60, "level that counts as nothing; higher ignores weak transmitters", "-"},
                   {"power", kLike.power, 0.5, 8, "of the level above the floor; larger heeds the strong ones more", "-"},
                   {"cosine", kLike.cosine, 0, 1, "share of the cosine distance; larger forgives a louder or quieter phone", "-"},
                   {"offset_most_db", kLike.offset_most_db, 0, 20,
                    "louder or quieter a phone may hear than the survey's; larger forgives more and tells less", "-"},
                   {"sharpness", kLike.sharpness, 0, 200, "of the weights; larger trusts the nearest more", "-"}}},
                 similarity},
  };
  return rows;
}

}  // namespace wayfuse
