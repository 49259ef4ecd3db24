#include "server/pipeline/corrector.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "server/pipeline/fusion_tracker.hpp"

namespace wayfuse {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostWalks = 24;   // each is replayed over a map of its own
constexpr std::size_t kLeastWalks = 3;
constexpr std::size_t kLeastSamples = 30;

template <std::size_t kSize>
bool read(const Json& json, const char* name, std::array<double, kSize>& out) {
  const auto found = json.find(name);
  if (found == json.end() || !found->is_array() || found->size() != kSize) return false;
  for (std::size_t i = 0; i < kSize; ++i) {
    if (!(*found)[i].is_number()) return false;
    out[i] = (*found)[i].get<double>();
    if (!std::isfinite(out[i])) return false;
  }
  return true;
}

bool read(const Json& json, const char* name, double& out) {
  std::array<double, 1> value{};
  if (!json.contains(name) || !read(Json{{name, {json[name]}}}, name, value)) return false;
  out = value[0];
  return true;
}

Json write(const BackPropagation& network) {
  return {{"input_mean", network.input_mean}, {"input_scale", network.input_scale}, {"output_mean", network.output_mean},
          {"output_scale", network.output_scale}, {"most", network.most}, {"hidden", network.hidden}, {"output", network.output}};
}

bool read(const Json& json, BackPropagation& network) {
  return json.is_object() && read(json, "input_mean", network.input_mean) && read(json, "input_scale", network.input_scale) &&
         std::ranges::all_of(network.input_scale, [](double scale) { return scale > 0.0; }) &&
         read(json, "output_mean", network.output_mean) && read(json, "output_scale", network.output_scale) &&
         read(json, "most", network.most) && read(json, "hidden", network.hidden) && read(json, "output", network.output);
}

using Walk = std::vector<const ReferencePoint*>;

std::map<std::string, Walk> walks_of(const Site& site) {
  std::map<std::string, Walk> walks;
  for (const ReferencePoint& point : site.survey) {
    if (!point.walk.empty() && !point.scans.empty()) walks[point.walk].push_back(&point);
  }
  for (auto& [_, walk] : walks) {
    std::ranges::stable_sort(walk, {}, [](const ReferencePoint* point) { return point->scans.front().time; });
  }
  return walks;
}

struct Sets {
  std::vector<TrainingSample> x;
  std::vector<TrainingSample> y;
};

// One walk through a pipeline that never saw it.
void replay(const Walk& walk, std::shared_ptr<const PipelineParts> parts, Sets& sets) {
  FusionTracker tracker(std::move(parts), Random(1), {});
  for (const ReferencePoint* point : walk) {
    for (const RssScan& scan : point->scans) {
      tracker.feed(scan);
      const auto inputs = tracker.newest_correction_inputs();
      const auto position = tracker.position(scan.time);
      if (!inputs || !position) continue;
      sets.x.push_back({*inputs, point->place.point.x_m - position->place.point.x_m});
      sets.y.push_back({*inputs, point->place.point.y_m - position->place.point.y_m});
    }
  }
}

}  // namespace

std::string Corrector::to_json() const {
  return Json{{"x", write(x)},
              {"y", write(y)},
              {"from",
               {{"walks", from.walks},
                {"samples", from.samples},
                {"rmse_before_m", from.rmse_before_m},
                {"rmse_after_m", from.rmse_after_m},
                {"radio_map_version", from.radio_map_version}}}}
      .dump();
}

Result<Corrector> Corrector::parse(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  Corrector corrector;
  if (!json.is_object() || !json.contains("x") || !read(json["x"], corrector.x)) {
    return Fault{FaultCode::kMalformed, "corrector.x", "not a network of 6 inputs, 8 hidden neurons and 1 output"};
  }
  if (!json.contains("y") || !read(json["y"], corrector.y)) {
    return Fault{FaultCode::kMalformed, "corrector.y", "not a network of 6 inputs, 8 hidden neurons and 1 output"};
  }
  const auto from = json.find("from");
  if (from == json.end() || !from->is_object()) return Fault{FaultCode::kMissingField, "corrector.from", "a network needs its provenance"};
  double walks = 0, samples = 0, version = 0;
  if (!read(*from, "walks", walks) || !read(*from, "samples", samples) ||
      !read(*from, "rmse_before_m", corrector.from.rmse_before_m) || !read(*from, "rmse_after_m", corrector.from.rmse_after_m) ||
      !read(*from, "radio_map_version", version) || walks < 0 || walks > 1e9 || samples < 0 || samples > 1e9 || version < 0 || version > 1e15) {
    return Fault{FaultCode::kMalformed, "corrector.from", "walks, samples, rmse_before_m, rmse_after_m, radio_map_version are numbers"};
  }
  corrector.from.walks = static_cast<int>(walks);
  corrector.from.samples = static_cast<int>(samples);
  corrector.from.radio_map_version = static_cast<std::uint64_t>(version);
  return corrector;
}

Result<Corrector> train_corrector(const Site& site,
                                  const std::function<std::shared_ptr<const PipelineParts>(std::shared_ptr<const Site>)>& prepare,
                                  const BackPropagationSettings& settings) {
  const auto walks = walks_of(site);
  if (walks.size() < kLeastWalks) {
    return Fault{FaultCode::kNotFound, "corrector", "the survey holds " + std::to_string(walks.size()) + " walks; training needs " +
                                                        std::to_string(kLeastWalks)};
  }
  Sets sets;
  Corrector corrector;
  for (const auto& [name, walk] : walks) {
    if (static_cast<std::size_t>(corrector.from.walks) == kMostWalks) break;
    auto without = std::make_shared<Site>(site);
    std::erase_if(without->survey, [&, &walk_name = name](const ReferencePoint& point) { return point.walk == walk_name; });
    replay(walk, prepare(without), sets);
    ++corrector.from.walks;
  }
  if (sets.x.size() < kLeastSamples) {
    return Fault{FaultCode::kNotFound, "corrector", "the survey's walks gave " + std::to_string(sets.x.size()) +
                                                        " updates; training needs " + std::to_string(kLeastSamples)};
  }
  Random random(1);  // of the first weights: the same survey trains the same network
  corrector.x = train(sets.x, settings, random);
  corrector.y = train(sets.y, settings, random);
  double before_m2 = 0.0, after_m2 = 0.0;
  for (std::size_t i = 0; i < sets.x.size(); ++i) {
    const double dx = sets.x[i].residual, dy = sets.y[i].residual;
    before_m2 += dx * dx + dy * dy;
    const double cx = dx - corrector.x(sets.x[i].inputs), cy = dy - corrector.y(sets.y[i].inputs);
    after_m2 += cx * cx + cy * cy;
  }
  const auto n = static_cast<double>(sets.x.size());
  corrector.from.samples = static_cast<int>(sets.x.size());
  corrector.from.rmse_before_m = std::sqrt(before_m2 / n);
  corrector.from.rmse_after_m = std::sqrt(after_m2 / n);
  corrector.from.radio_map_version = site.radio_map_version;
  return corrector;
}

}  // namespace wayfuse
