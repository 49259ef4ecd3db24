#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "admin/plan/features.hpp"
#include "admin/plan/georeference_fit.hpp"
#include "admin/plan/image_header.hpp"
#include "admin/plan/plan.hpp"
#include "admin/plan/planar.hpp"

namespace wayfuse {
namespace {

using nlohmann::json;
using Severity = PlanCheck::Severity;

/// Draws in metres and writes degrees about a place in Zurich.
class Sheet {
 public:
  json at(double x_m, double y_m) const {
    const GeoPoint geo = georeference.to_geo({x_m, y_m});
    return {geo.longitude_deg, geo.latitude_deg};
  }
  json box(double x0, double y0, double x1, double y1) const {
    return {{"type", "Polygon"}, {"coordinates", {{at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1), at(x0, y0)}}}};
  }
  json line(double x0, double y0, double x1, double y1) const {
    return {{"type", "LineString"}, {"coordinates", {at(x0, y0), at(x1, y1)}}};
  }
  static json feature(json properties, json geometry, const std::string& id = "") {
    json made{{"type", "Feature"}, {"properties", std::move(properties)}, {"geometry", std::move(geometry)}};
    if (!id.empty()) made["id"] = id;
    return made;
  }
  static std::string collection(json features) { return json{{"type", "FeatureCollection"}, {"features", std::move(features)}}.dump(); }
  PlanOptions options() const {
    PlanOptions options;
    options.georeference = georeference;
    return options;
  }
  Georeference georeference{{47.3769, 8.5417}, 0.3};
};

bool found(const Plan& plan, Severity severity, const std::string& code) {
  return std::ranges::any_of(plan.checks, [&](const PlanCheck& check) { return check.severity == severity && check.code == code; });
}

std::string words(const Plan& plan) {
  std::string all;
  for (const PlanCheck& check : plan.checks) all += check.code + ' ' + check.feature + ' ' + check.detail + '\n';
  return all;
}

// A floor of 40 x 20 m: a corridor along the middle, two rooms above it, one with a door.
json floor_plan(const Sheet& sheet) {
  return {Sheet::feature({{"kind", "outline"}, {"floor", 1}, {"name", "First"}}, sheet.box(0, 0, 40, 20)),
          Sheet::feature({{"kind", "room"}, {"floor", 1}, {"name", "Lab"}}, sheet.box(0, 12, 20, 20)),
          Sheet::feature({{"kind", "room"}, {"floor", 1}, {"name", "Store"}}, sheet.box(20, 12, 40, 20)),
          Sheet::feature({{"kind", "door"}, {"floor", 1}}, sheet.line(9, 12, 10, 12))};
}

TEST(Plan, ReadsAFloorWithItsRoomsDoorsAndWalls) {
  const Sheet sheet;
  auto plan = read_plan(Sheet::collection(floor_plan(sheet)), sheet.options());
  ASSERT_TRUE(plan) << to_string(plan.fault());
  const auto floors = floors_of(*plan, sheet.options());
  ASSERT_TRUE(plan->sound()) << words(*plan);
  ASSERT_EQ(floors.size(), 1u);
  EXPECT_EQ(floors[0].ordinal.value, 1);
  EXPECT_EQ(floors[0].label, "First");
  EXPECT_NEAR(planar::area_m2(floors[0].outline), 800, 0.1);
  ASSERT_EQ(floors[0].walkable.size(), 1u);
  EXPECT_NEAR(planar::area_m2(floors[0].walkable[0]), 480, 0.1) << "the rooms are closed";
  EXPECT_TRUE(contains(floors[0].walkable[0], {5, 5}));
  EXPECT_FALSE(contains(floors[0].walkable[0], {5, 15}));
  double walls_m = 0;
  for (const Polyline& wall : floors[0].walls) {
    for (std::size_t i = 1; i < wall.size(); ++i) walls_m += distance_m(wall[i - 1], wall[i]);
  }
  // 120 m around, 40 m below the rooms, 8 m between them; the door takes 1 m and 0.4 m on each side.
  EXPECT_NEAR(walls_m, 120 + 40 + 8 - 1.8, 0.1);
  EXPECT_TRUE(found(*plan, Severity::kWarning, "no_door")) << words(*plan);
}

TEST(Plan, OpensTheRoomsWherePhonesAreTrackedIntoThem) {
  const Sheet sheet;
  PlanOptions options = sheet.options();
  options.rooms_walkable = true;
  auto plan = read_plan(Sheet::collection(floor_plan(sheet)), options);
  EXPECT_TRUE(floors_of(*plan, options)[0].walkable.empty()) << "everywhere inside the outline";
}

TEST(Plan, TakesAMallsFileWhoseFirstAreaIsTheFloor) {
  const Sheet sheet;
  const auto file = Sheet::collection({Sheet::feature({{"type", "floor"}, {"category", "floor"}, {"name", "F1"}, {"floor_num", 1}}, sheet.box(0, 0, 60, 30)),
                                       Sheet::feature({{"name", "STARBUCKS"}, {"category", {"5d35", "99ac"}}}, sheet.box(0, 0, 10, 10)),
                                       Sheet::feature({{"name", "fuzhumian"}}, sheet.box(20, 0, 30, 10))});
  PlanOptions options;  // without a georeference one is made
  auto plan = read_plan(file, options);
  ASSERT_TRUE(plan) << to_string(plan.fault());
  const auto floors = floors_of(*plan, options);
  ASSERT_EQ(floors.size(), 1u) << words(*plan);
  EXPECT_EQ(floors[0].ordinal.value, 0) << "lifts of malls count from 1";
  EXPECT_EQ(floors[0].label, "F1");
  EXPECT_EQ(plan->floors[0].rooms.size(), 2u);
  ASSERT_TRUE(plan->georeference);
  EXPECT_NEAR(planar::area_m2(floors[0].outline), 1800, 1);
  options.floor = FloorOrdinal{3};
  EXPECT_EQ(read_plan(file, options)->floors[0].ordinal.value, 3);
}

TEST(Plan, TellsMercatorAndLocalMetresFromDegrees) {
  const json square = {{"type", "Polygon"}, {"coordinates", {{{951000, 6004000}, {951100, 6004000}, {951100, 6004100}, {951000, 6004100}, {951000, 6004000}}}}};
  const std::string file = Sheet::collection({Sheet::feature({{"kind", "outline"}, {"floor", 0}}, square)});
  PlanOptions options;
  auto plan = read_plan(file, options);
  EXPECT_TRUE(found(*plan, Severity::kWarning, "coordinates"));
  // Mercator stretches by 1 / cos(latitude); here at 47.4 degrees.
  EXPECT_NEAR(planar::area_m2(floors_of(*plan, options)[0].outline), 100 * 100 * 0.458, 50);
  options.coordinates = PlanOptions::Coordinates::kLocal;
  EXPECT_TRUE(found(*read_plan(file, options), Severity::kError, "scale")) << "951 km from the origin";
}

TEST(Plan, SaysWhatIsWrongWithItsShapes) {
  const Sheet sheet;
  json open = sheet.box(0, 0, 40, 20);
  open["coordinates"][0].erase(4);  // the last point is 20 m from the first
  auto plan = read_plan(Sheet::collection({Sheet::feature({{"kind", "outline"}, {"floor", 0}}, open)}), sheet.options());
  EXPECT_TRUE(found(*plan, Severity::kError, "open_ring")) << words(*plan);

  json bow = sheet.box(0, 0, 40, 20);
  std::swap(bow["coordinates"][0][2], bow["coordinates"][0][3]);
  plan = read_plan(Sheet::collection({Sheet::feature({{"kind", "outline"}, {"floor", 0}}, bow)}), sheet.options());
  EXPECT_TRUE(found(*plan, Severity::kWarning, "self_intersection")) << words(*plan);
  EXPECT_NE(words(*plan).find("[20.00, 10.00]"), std::string::npos) << words(*plan);

  json features = floor_plan(sheet);
  features.push_back(Sheet::feature({{"kind", "room"}, {"floor", 1}, {"name", "Moon"}}, sheet.box(100, 0, 110, 10)));
  features.push_back(Sheet::feature({{"kind", "room"}, {"floor", 1}, {"name", "Balcony"}}, sheet.box(38, 0, 42, 10)));
  features.push_back(Sheet::feature({{"kind", "room"}, {"floor", 1}, {"name", "Twice"}}, sheet.box(2, 13, 18, 19)));
  plan = read_plan(Sheet::collection(features), sheet.options());
  floors_of(*plan, sheet.options());
  EXPECT_TRUE(found(*plan, Severity::kError, "outside_floor")) << words(*plan);
  EXPECT_TRUE(found(*plan, Severity::kWarning, "outside_floor")) << words(*plan);
  EXPECT_TRUE(found(*plan, Severity::kWarning, "overlap")) << words(*plan);

  plan = read_plan(Sheet::collection({Sheet::feature({{"kind", "outline"}, {"floor", 0}}, sheet.box(0, 0, 4, 2))}), sheet.options());
  floors_of(*plan, sheet.options());
  EXPECT_TRUE(found(*plan, Severity::kError, "scale")) << words(*plan);
}

TEST(Plan, RefusesWhatIsNoPlan) {
  const Sheet sheet;
  const std::pair<std::string, FaultCode> cases[] = {
      {"", FaultCode::kMalformed},
      {"[]", FaultCode::kMalformed},
      {R"({"type":"Feature"})", FaultCode::kMalformed},
      {R"({"type":"FeatureCollection","features":[7]})", FaultCode::kMalformed},
      {R"({"type":"FeatureCollection","features":[]})", FaultCode::kMissingField},
      {R"({"type":"FeatureCollection","features":[{"type":"Feature","geometry":{"type":"Polygon","coordinates":[[["a",0]]]}}]})", FaultCode::kMalformed},
      {Sheet::collection({Sheet::feature({{"kind", "outline"}}, sheet.box(0, 0, 40, 20))}), FaultCode::kMissingField},
      {"PK\x03\x04 no zip", FaultCode::kMalformed},
      {zip({{"manifest.json", "{}"}}), FaultCode::kMissingField},
  };
  for (const auto& [file, code] : cases) {
    const auto plan = read_plan(file, sheet.options());
    ASSERT_FALSE(plan) << file;
    EXPECT_EQ(plan.fault().code, code) << file << to_string(plan.fault());
  }
}

TEST(Plan, ReadsAnImdfArchive) {
  const Sheet sheet;
  const auto of_level = [](const char* level, const char* category) { return json{{"level_id", level}, {"category", category}}; };
  json named = of_level("lvl-0", "office");
  named["name"] = {{"en", "Reception"}};
  const std::map<std::string, std::string> files = {
      {"manifest.json", R"({"version":"1.0.0","created":"2026-11-26T10:00:00Z","language":"en"})"},
      {"level.geojson", Sheet::collection({Sheet::feature({{"ordinal", 0}, {"short_name", {{"en", "G"}}}}, sheet.box(0, 0, 40, 20), "lvl-0"),
                                           Sheet::feature({{"ordinal", -1}, {"short_name", {{"en", "B1"}}}}, sheet.box(0, 0, 40, 20), "lvl-1")})},
      {"unit.geojson", Sheet::collection({Sheet::feature(named, sheet.box(0, 0, 20, 8), "u-1"),
                                          Sheet::feature(of_level("lvl-0", "walkway"), sheet.box(0, 8, 40, 20), "u-2"),
                                          Sheet::feature(of_level("lvl-0", "column"), sheet.box(10, 12, 11, 13), "u-3"),
                                          Sheet::feature(of_level("lvl-9", "office"), sheet.box(0, 0, 5, 5), "u-4")})},
      {"opening.geojson", Sheet::collection({Sheet::feature(of_level("lvl-0", "pedestrian"), sheet.line(5, 8, 6, 8), "o-1")})}};
  auto plan = read_plan(zip(files), sheet.options());
  ASSERT_TRUE(plan) << to_string(plan.fault());
  const auto floors = floors_of(*plan, sheet.options());
  EXPECT_TRUE(plan->sound()) << words(*plan);
  EXPECT_EQ(plan->format, "imdf");
  ASSERT_EQ(floors.size(), 2u);
  EXPECT_EQ(floors[0].label, "B1");
  EXPECT_EQ(floors[1].ordinal.value, 0);
  EXPECT_NEAR(planar::area_m2(floors[1].walkable.at(0)), 40 * 12 - 1, 0.1) << "the walkway without its column";
  EXPECT_EQ(plan->floors[1].rooms.at(0).name, "Reception");
  EXPECT_FALSE(found(*plan, Severity::kWarning, "no_door")) << words(*plan);
  EXPECT_TRUE(found(*plan, Severity::kWarning, "level")) << "a unit of a level that is not there";
}

TEST(Plan, UnpacksNoBombs) {
  EXPECT_EQ(unzip(zip({{"a.geojson", std::string(65u << 20, ' ')}})).fault().code, FaultCode::kTooLarge);
  std::map<std::string, std::string> many;
  for (int i = 0; i < 65; ++i) many["f" + std::to_string(i)] = "x";
  EXPECT_EQ(unzip(zip(many)).fault().code, FaultCode::kTooLarge);
  const std::map<std::string, std::string> files = {{"a", "1"}, {"b", std::string(100'000, 'x')}, {"c", ""}};
  EXPECT_EQ(*unzip(zip(files)), files);
}

// ---------------------------------------------------------------- georeference

std::vector<ControlPoint> points_of(const Georeference& truth, const std::vector<BuildingPoint>& places) {
  std::vector<ControlPoint> points;
  for (const BuildingPoint& place : places) points.push_back({place, truth.to_geo(place)});
  return points;
}

bool says(const GeoreferenceFit& fit, Severity severity, const std::string& code) {
  return std::ranges::any_of(fit.checks, [&](const PlanCheck& check) { return check.severity == severity && check.code == code; });
}

TEST(GeoreferenceFit, FindsTheTruthBehindFourCorners) {
  const Georeference truth{{-33.86, 151.21}, -2.1};
  const auto fit = fit_georeference(points_of(truth, {{10, 5}, {90, 5}, {90, 65}, {10, 65}}));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->georeference.origin.latitude_deg, truth.origin.latitude_deg, 1e-7);
  EXPECT_NEAR(fit->georeference.origin.longitude_deg, truth.origin.longitude_deg, 1e-7);
  // Meridians converge: north at the points' middle, 60 m off, is off by up to 60 tan(33.9 deg) / 6.4e6 = 6e-6.
  EXPECT_NEAR(fit->georeference.y_axis_azimuth_rad, truth.y_axis_azimuth_rad, 1e-5);
  EXPECT_LT(fit->rms_m, 0.001);
  EXPECT_NEAR(fit->scale, 1, 1e-5);
  EXPECT_NEAR(*fit->shear_rad, 0, 1e-5);
  EXPECT_TRUE(fit->checks.empty());
}

TEST(GeoreferenceFit, PointsAtThePointThatIsWrong) {
  auto points = points_of({{47.4, 8.5}, 0.4}, {{0, 0}, {80, 0}, {80, 60}, {0, 60}, {40, 30}});
  points[2].local.x_m += 9;
  const auto fit = fit_georeference(points);
  EXPECT_NEAR(fit->without_it_m[2], 9, 0.5);
  ASSERT_TRUE(says(*fit, Severity::kWarning, "outlier"));
  EXPECT_EQ(std::ranges::find(fit->checks, "outlier", &PlanCheck::code)->feature, "control_points[2]");
}

TEST(GeoreferenceFit, SeesFeetMirrorsAndStretches) {
  const Georeference truth{{47.4, 8.5}, 0.4};
  auto points = points_of(truth, {{0, 0}, {80, 0}, {80, 60}, {0, 60}});
  for (ControlPoint& point : points) point.local = {point.local.x_m / 0.3048, point.local.y_m / 0.3048};
  EXPECT_TRUE(says(*fit_georeference(points), Severity::kError, "scale")) << "feet";
  points = points_of(truth, {{0, 0}, {80, 0}, {80, 60}, {0, 60}});
  for (ControlPoint& point : points) std::swap(point.local.x_m, point.local.y_m);
  EXPECT_TRUE(says(*fit_georeference(points), Severity::kError, "mirrored"));
  points = points_of(truth, {{0, 0}, {80, 0}, {80, 60}, {0, 60}});
  for (ControlPoint& point : points) point.local.y_m *= 1.05;
  const auto stretched = fit_georeference(points);
  EXPECT_NEAR(*stretched->scale_y, 1 / 1.05, 1e-4);
  EXPECT_NEAR(*stretched->scale_x, 1, 1e-4);
  EXPECT_TRUE(says(*stretched, Severity::kWarning, "scale"));
  points = points_of(truth, {{0, 0}, {80, 0}, {80, 60}, {0, 60}});
  for (ControlPoint& point : points) point.local.x_m += 0.1 * point.local.y_m;
  EXPECT_TRUE(says(*fit_georeference(points), Severity::kWarning, "shear"));
}

TEST(GeoreferenceFit, NeedsTwoPointsApart) {
  EXPECT_FALSE(fit_georeference({}));
  EXPECT_FALSE(fit_georeference(points_of({{47, 8}, 0}, {{1, 1}})));
  EXPECT_FALSE(fit_georeference(points_of({{47, 8}, 0}, {{1, 1}, {1.2, 1}})));
  const auto two = fit_georeference(points_of({{47, 8}, 1.0}, {{0, 0}, {50, 10}}));
  ASSERT_TRUE(two);
  EXPECT_NEAR(two->georeference.y_axis_azimuth_rad, 1.0, 1e-5);
  EXPECT_TRUE(says(*two, Severity::kNote, "two_points"));
  EXPECT_FALSE(two->shear_rad);
}

TEST(ImageHeader, ReadsSizesOfPngAndJpegAndRefusesTheRest) {
  const std::string png = std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x01\x40\0\0\0\xf0", 24);
  EXPECT_EQ(image_header(png)->width_px, 320u);
  EXPECT_EQ(image_header(png)->height_px, 240u);
  const std::string jpeg = std::string("\xff\xd8\xff\xe0\0\x04zz\xff\xc0\0\x11\x08\0\xf0\x01\x40\x03", 19) + std::string(16, '\0');
  ASSERT_TRUE(image_header(jpeg));
  EXPECT_EQ(image_header(jpeg)->width_px, 320u);
  EXPECT_EQ(image_header(jpeg)->height_px, 240u);
  EXPECT_FALSE(image_header("<svg/>"));
  EXPECT_FALSE(image_header(std::string("\xff\xd8\xff\xe0", 4)));
  EXPECT_FALSE(image_header(png.substr(0, 20)));
}

}  // namespace
}  // namespace wayfuse
