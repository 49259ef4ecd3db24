#include <algorithm>
#include <cassert>
#include <cmath>

#include "server/locating/catalogue.hpp"
#include "server/pipeline/field_tracker.hpp"
#include "server/pipeline/fusion_tracker.hpp"
#include "server/pipeline/part_roles.hpp"
#include "server/pipeline/tracker.hpp"
#include "server/tracking/catalogue.hpp"

namespace wayfuse {
namespace {

constexpr double kFloatsAreGoodToM = 4000.0;  // beyond this the pipeline's frame gets an origin of its own

/// A choice with its checked settings, the role's standard part where the spec is silent.
struct Chosen {
  std::string part;
  PartSettings settings;
};

class Assembly {
 public:
  explicit Assembly(const PipelineSpec& spec) : spec_(spec), catalogue_(part_catalogue()) {}

  const PipelineSpec& spec() const { return spec_; }
  static std::string_view standard(std::string_view role) { return std::ranges::find(pipeline_roles(), role, &Role::name)->standard; }
  /// Only after check(): every role and part exists.
  Chosen chosen(std::string_view role) const {
    PartChoice choice;
    const auto named = spec_.parts.find(std::string(role));
    if (named != spec_.parts.end()) {
      choice = named->second;
    } else {
      choice.name = standard(role);
    }
    const auto part = std::ranges::find_if(
        catalogue_, [&](const PartDescription& each) { return each.role == role && each.name == choice.name; });
    return {choice.name, *check_settings(*part, choice, "parts." + std::string(role) + ".settings")};
  }

 private:
  const PipelineSpec& spec_;
  std::vector<PartDescription> catalogue_;
};

template <typename Rows>
const auto& row_of(const Rows& rows, const std::string& name) {
  return *std::ranges::find_if(rows, [&](const auto& row) { return row.description.name == name; });
}

std::shared_ptr<const LocatorModel> prepared(const LocatorRow& row, const LocatingSite& site, const PartSettings& settings) {
  auto model = row.prepare(site, settings);
  assert(model->make()->has_likelihood() == row.gives_likelihood);
  return model;
}

BuildingPoint frame_origin(const Site& site) {
  BuildingPoint sum;
  double count = 0.0;
  for (const ReferencePoint& point : site.survey) {
    if (!std::isfinite(point.place.point.x_m) || !std::isfinite(point.place.point.y_m)) continue;
    sum = {sum.x_m + point.place.point.x_m, sum.y_m + point.place.point.y_m};
    count += 1.0;
  }
  if (count == 0.0) return {};
  const BuildingPoint mean{std::round(sum.x_m / count), std::round(sum.y_m / count)};
  return std::hypot(mean.x_m, mean.y_m) > kFloatsAreGoodToM ? mean : BuildingPoint{};
}

void shift(BuildingPoint& point, BuildingPoint origin) {
  point.x_m -= origin.x_m;
  point.y_m -= origin.y_m;
}

void shift(Polygon& polygon, BuildingPoint origin) {
  for (Ring& ring : polygon.rings) {
    for (BuildingPoint& point : ring) shift(point, origin);
  }
}

/// The site's survey and floors in the pipeline's frame.
struct Framed {
  std::vector<ReferencePoint> survey;
  std::vector<Floor> floors;

  Framed(const Site& site, BuildingPoint origin) : survey(site.survey), floors(site.floors) {
    for (ReferencePoint& point : survey) shift(point.place.point, origin);
    for (Floor& floor : floors) {
      shift(floor.outline, origin);
      for (Polygon& polygon : floor.walkable) shift(polygon, origin);
    }
  }
};

Fault clash(std::string field, std::string cause) { return {FaultCode::kConflict, std::move(field), std::move(cause)}; }

/// Measurements of a spec that its filter does not understand, and a resampler that nobody asks.
Result<void> filter_understands(const Assembly& spec) {
  const FilterRow& filter = row_of(filter_catalogue(), spec.chosen("filter").part);
  const auto takes = [&](std::string_view role, std::string_view part, Takes needed) -> Result<void> {
    if (spec.chosen(role).part != part || filter.takes >= needed) return {};
    std::string others;
    for (const FilterRow& row : filter_catalogue()) {
      if (row.takes >= needed) others += (others.empty() ? "`" : ", `") + row.description.name + "`";
    }
    return clash("parts.filter", "`" + filter.description.name + "` takes " + std::string(words_of(filter.takes)) + " only, and `" +
                                     std::string(part) + "` is none: " + others);
  };
  if (auto field = takes("measurement", "field", Takes::kAny); !field) return field;
  if (auto ranges = takes("measurement", "ranges", Takes::kGaussian); !ranges) return ranges;
  if (auto speed = takes("speed", "speed", Takes::kGaussian); !speed) return speed;
  if (auto direction = takes("azimuth", "direction", Takes::kGaussian); !direction) return direction;
  if (auto resolved = takes("azimuth", "resolved", Takes::kLinear); !resolved) return resolved;
  if (filter.takes != Takes::kAny && spec.chosen("resampler").part != spec.standard("resampler")) {  // naming the standard asks for nothing
    return clash("parts.resampler", "`" + filter.description.name + "` has no particles to resample");
  }
  return {};
}

/// Parts that do not go together, and information that would count twice.
Result<void> fits(const Assembly& spec) {
  const Chosen locator = spec.chosen("locator");
  const Chosen measurement = spec.chosen("measurement");
  const Chosen motion = spec.chosen("motion");
  if (locator.part == "none" && measurement.part != "none") {
    return clash("parts.measurement", "`" + measurement.part + "` needs a locator, and there is none");
  }
  if (locator.part != "none") {
    const LocatorRow& row = row_of(locator_catalogue(), locator.part);
    const bool gives = measurement.part == "none" || (measurement.part == "fix" && row.gives_fix) ||
                       (measurement.part == "ranges" && row.gives_ranges) || (measurement.part == "field" && row.gives_likelihood);
    if (!gives) return clash("parts.measurement", "the locator `" + locator.part + "` gives no " + measurement.part);
  }
  if (auto understood = filter_understands(spec); !understood) return understood;
  const auto model = row_of(motion_model_catalogue(), motion.part).make(motion.settings);
  if (model->uses_heading() && spec.chosen("azimuth").part != "none") {
    return clash("parts.azimuth", "the motion `" + motion.part + "` is already moved by the phone's heading: it would count twice");
  }
  if (spec.chosen("heading").part == "track-kalman" && spec.chosen("azimuth").part != "none") {
    return clash("parts.azimuth", "the heading `track-kalman` is read off the filter's own track: measured by it again, it would count twice");
  }
  if (model->columns() == 0 && (spec.chosen("speed").part != "none" || spec.chosen("azimuth").part != "none") &&
      !model->uses_heading() && !model->uses_distance()) {
    return clash("parts.motion", "`" + motion.part + "` has no velocity that speed or azimuth could measure");
  }
  if (spec.chosen("azimuth").part == "resolved" && spec.chosen("speed").part != "none") {
    return clash("parts.speed", "the azimuth `resolved` already measures the phone's speed: it would count twice");
  }
  if (spec.chosen("azimuth").part == "resolved" && model->uses_distance()) {
    return clash("parts.azimuth", "the motion `" + motion.part + "` is already moved by the phone's speed: it would count twice");
  }
  if (model->uses_distance() && spec.chosen("speed").part != "none") {
    return clash("parts.speed", "the motion `" + motion.part + "` is already moved by the phone's speed: it would count twice");
  }
  return {};
}

std::function<std::unique_ptr<Filter>()> filter_maker(const Assembly& spec, std::shared_ptr<const MotionModel> motion) {
  const Chosen filter = spec.chosen("filter");
  const Chosen resampler = spec.chosen("resampler");
  return [make = row_of(filter_catalogue(), filter.part).make, settings = filter.settings, motion = std::move(motion),
          resampler = row_of(resampler_catalogue(), resampler.part).make(resampler.settings)] {
    return make(settings, motion, resampler);
  };
}

ReadingGateSettings readings_of(const Assembly& spec) {
  const auto [part, settings] = spec.chosen("readings");
  if (part == "all") return {.all = true};
  return {false, settings["max_age_s"], settings["delay_s"], settings.on("drop_repeats")};
}

void choose_measurements(const Assembly& spec, PipelineParts& parts) {
  const auto [part, settings] = spec.chosen("measurement");
  if (part == "fix") {
    parts.measurement = MeasurementKind::kFix;
    parts.fix = {settings["sigma_m"], settings["sigma_scale"], settings["gate_sigmas"]};
  } else if (part == "ranges") {
    parts.measurement = MeasurementKind::kRanges;
    parts.range_sigma_scale = settings["sigma_scale"];
  } else if (part == "field") {
    parts.measurement = MeasurementKind::kField;
    parts.field = {settings["weight"], settings["outlier"]};
  } else {
    parts.measurement = MeasurementKind::kNone;
  }
  if (const Chosen gnss = spec.chosen("gnss"); gnss.part == "start") {
    parts.gnss = GnssUse::kStart;
    parts.gnss_start_s = gnss.settings["start_s"];
  } else {
    parts.gnss = gnss.part == "fix" ? GnssUse::kFix : GnssUse::kNone;
  }
  if (const Chosen speed = spec.chosen("speed"); speed.part == "speed") parts.speed = {true, speed.settings["sigma_mps"]};
  if (const Chosen azimuth = spec.chosen("azimuth"); azimuth.part == "direction") {
    parts.azimuth = {true, azimuth.settings["sigma_rad"]};
  } else if (azimuth.part == "resolved") {
    parts.azimuth = {true, azimuth.settings["sigma_rad"]};
    parts.speed = {true, azimuth.settings["sigma_mps"]};
    parts.resolved = true;
  }
}

void choose_rules(const Assembly& spec, PipelineParts& parts) {
  parts.readings = readings_of(spec);
  const Chosen floor = spec.chosen("floor");
  parts.floor = {floor.settings["memory"], floor.settings["margin"]};
  if (const Chosen heading = spec.chosen("heading"); heading.part == "track-kalman") {
    parts.track_heading = true;
    parts.heading = {heading.settings["turn_sigma_rad_rts"], heading.settings["track_sigma_m"], heading.settings["piece_m"]};
  }
  const Chosen recovery = spec.chosen("recovery");
  parts.recovery.restart = recovery.part == "restart";
  if (parts.recovery.restart) {
    parts.recovery.gate_sigmas = recovery.settings["gate_sigmas"];
    parts.recovery.misses = recovery.settings.count("misses");
  }
}

std::shared_ptr<PipelineParts> prepare(const Assembly& spec, std::shared_ptr<const Site> site) {
  auto parts = std::make_shared<PipelineParts>();
  parts->spec = spec.spec();
  parts->origin = frame_origin(*site);
  const Framed framed(*site, parts->origin);
  parts->map = RadioMap::build(framed.survey);
  if (const Chosen locator = spec.chosen("locator"); locator.part != "none") {
    parts->locator = prepared(row_of(locator_catalogue(), locator.part), {parts->map, framed.survey, framed.floors}, locator.settings);
  }
  const Chosen motion = spec.chosen("motion");
  parts->motion = row_of(motion_model_catalogue(), motion.part).make(motion.settings);
  parts->make_filter = filter_maker(spec, parts->motion);
  parts->site = std::move(site);
  choose_measurements(spec, *parts);
  choose_rules(spec, *parts);
  return parts;
}

class Pipeline final : public TrackerFactory {
 public:
  Pipeline(std::shared_ptr<const PipelineParts> parts, std::vector<std::string> remarks, std::string learnt)
      : parts_(std::move(parts)), remarks_(std::move(remarks)), learnt_(std::move(learnt)) {}
  std::unique_ptr<Tracker> make_tracker(Random random, const std::optional<KnownStart>& start) const override {
    return std::make_unique<FusionTracker>(parts_, random, start);
  }
  std::unique_ptr<Tracker> take_over(const Tracker& older) const override {
    const auto* tracker = dynamic_cast<const FusionTracker*>(&older.core());
    if (!tracker || tracker->parts().spec != parts_->spec || !same_axes(*tracker->parts().site, *parts_->site)) return nullptr;
    return std::make_unique<FusionTracker>(parts_, *tracker);
  }
  const PipelineSpec& spec() const override { return parts_->spec; }
  std::vector<std::string> remarks() const override { return remarks_; }
  std::string learnt() const override { return learnt_; }

 private:
  std::shared_ptr<const PipelineParts> parts_;
  std::vector<std::string> remarks_;
  std::string learnt_;
};

/// The pipeline's stored corrector, else one trained on its survey, else a remark that says why there is none.
Result<std::string> add_corrector(const Assembly& spec, PipelineParts& parts, std::vector<std::string>& remarks) {
  const auto [part, settings] = spec.chosen("corrector");
  if (part == "none") return std::string{};
  if (const auto found = parts.site->correctors.find(spec.spec().name); found != parts.site->correctors.end()) {
    auto stored = Corrector::parse(found->second);
    if (!stored) return stored.fault();
    parts.corrector = std::make_shared<Corrector>(*std::move(stored));
    return found->second;
  }
  auto trained = train_corrector(*parts.site, [&](std::shared_ptr<const Site> site) { return prepare(spec, std::move(site)); },
                                 {.iterations = settings.count("iterations")});
  if (!trained) {
    remarks.push_back("no corrector: " + trained.fault().cause);
    return std::string{};
  }
  parts.corrector = std::make_shared<Corrector>(*std::move(trained));
  return parts.corrector->to_json();
}

/// The filter `walkers` is a whole tracker: it takes a locator with a likelihood and brings everything else.
Result<std::shared_ptr<const TrackerFactory>> assemble_walkers(const PipelineSpec& spec, const Assembly& assembly,
                                                               std::shared_ptr<const Site> site) {
  for (const auto& [role, choice] : spec.parts) {
    if (role != "locator" && role != "filter") return clash("parts." + role, "the filter `walkers` brings its own " + role);
  }
  const Chosen locator = assembly.chosen("locator");
  const LocatorRow& row = row_of(locator_catalogue(), locator.part);
  if (!row.gives_likelihood) return clash("parts.locator", "the filter `walkers` needs a likelihood; `" + locator.part + "` gives none");
  auto parts = std::make_shared<FieldTrackerParts>();
  parts->origin = frame_origin(*site);
  const Framed framed(*site, parts->origin);
  const auto map = RadioMap::build(framed.survey);
  parts->empty_map = map->empty();
  parts->locator = prepared(row, {map, framed.survey, framed.floors}, locator.settings);
  std::vector<Place> trodden;
  for (const ReferencePoint& point : framed.survey) {
    if (std::isfinite(point.place.point.x_m) && std::isfinite(point.place.point.y_m)) trodden.push_back(point.place);
  }
  parts->settings = walker_settings(assembly.chosen("filter").settings);
  if (parts->settings.walkable) parts->walkable = WalkableArea(framed.floors, trodden);
  parts->site = std::move(site);
  return make_field_pipeline(spec, std::move(parts));
}

}  // namespace

Result<std::shared_ptr<const TrackerFactory>> assemble(const PipelineSpec& spec, std::shared_ptr<const Site> site) {
  if (auto checked = check(spec); !checked) return checked.fault();
  const Assembly assembly(spec);
  if (assembly.chosen("filter").part == "walkers") return assemble_walkers(spec, assembly, std::move(site));
  if (auto fitting = fits(assembly); !fitting) return fitting.fault();
  auto parts = prepare(assembly, std::move(site));
  std::vector<std::string> remarks;
  auto learnt = add_corrector(assembly, *parts, remarks);
  if (!learnt) return learnt.fault();
  return std::shared_ptr<const TrackerFactory>(std::make_shared<Pipeline>(std::move(parts), std::move(remarks), *std::move(learnt)));
}

}  // namespace wayfuse
