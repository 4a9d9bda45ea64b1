// Walks the candidates of every model of tables: each condition in which a mechanism says that it is seen is one of the
// problem's, where the table has the data for it. What a table has no data for stands beside it, by name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "base/error.h"
#include "data.h"
#include "explain/tables/quick_table.h"
#include "manifest/sections/table.h"
#include "marker_world.h"
#include "probe_world.h"
#include "robot/kinematics.h"
#include "table_world.h"

namespace gonio::explain::tables::tests {
namespace {

struct Walk {
  const char* model;
  World (*world)();
  std::set<std::string> without;  // conditions of its candidates for which it has no data
};

World rows_of(std::vector<std::pair<std::string, std::string>> columns, std::size_t rows, const std::string& sections,
              const std::string& rest, const std::function<double(const std::string&, double)>& value) {
  World w;
  w.columns = std::move(columns), w.sections = sections, w.rest = rest;
  Random random(1, 7);
  for (std::size_t r = 0; r < rows; ++r) {
    w.rows.emplace_back();
    for (const auto& [name, unit] : w.columns) w.rows.back().push_back(value(name, random.uniform()));
  }
  return w;
}

// Values in their columns' ranges; `other`: of columns that are not named here.
double usual(const std::string& name, double share) {
  if (name == "channel") return std::floor(2.999 * share);
  if (name == "wavelength_m") return 4.2e-7 + 4e-8 * std::floor(6.999 * share);
  if (name == "excitation") return std::floor(1.999 * share);
  if (name == "theta_i") return 0.2 * std::ceil(5.999 * share);
  if (name == "phi_i") return 0.8 * std::floor(3.999 * share);
  if (name == "row") return std::floor(1000 * share);
  if (name == "time_s") return 1000 * share;
  if (name == "temperature_K") return 290 + 10 * share;
  if (name == "exposure_s") return 0.01 + 0.1 * share;
  if (name == "z_m") return 0.1 * share;
  return 0.3 + 0.7 * share;
}

World sensor() {
  return rows_of({{"exposure_s", "s"},
                  {"radiance", "1"},
                  {"time_s", "s"},
                  {"channel", "1"},
                  {"row", "px"},
                  {"image_radius", "1"},
                  {"temperature_K", "K"},
                  {"distance_m", "m"},
                  {"value", "1"}},
                 300, "",
                 R"("model": "sensor", "observed": ["value"], "parameters": {"gain": {"value": 1, "free": true}})",
                 usual);
}
World light() {
  return rows_of({{"x_m", "m"},
                  {"y_m", "m"},
                  {"z_m", "m"},
                  {"time_s", "s"},
                  {"exposure_s", "s"},
                  {"channel", "1"},
                  {"image_radius", "1"},
                  {"row", "px"},
                  {"value", "W/m^2"}},
                 300,
                 R"("lights": {"l": {"model": "point", "position_m": [0.1, 0, 2], "watt_per_sr": {"value": [2, 2, 2],
                    "free": true}}},)",
                 R"("model": "light", "light": "l", "observed": ["value"])", usual);
}
World parallel_light() {
  World w = light();
  w.sections = R"("lights": {"l": {"model": "directional", "towards": [0.1, 0, 1], "watt_per_m2": {"value": [2, 2, 2],
                  "free": true}}},)";
  for (const char* name : {"nx", "ny", "nz"}) w.columns.emplace_back(name, "1");
  Random random(2, 7);
  for (std::vector<double>& row : w.rows) row.insert(row.end(), {0.2 * random.normal(), 0.2 * random.normal(), 1});
  return w;
}
World volume() {
  return rows_of({{"path_m", "m"}, {"theta_i", "rad"}, {"wavelength_m", "m"}, {"time_s", "s"}, {"value", "1"}}, 300, "",
                 R"("model": "volume", "observed": ["value"])", usual);
}
World refraction() {
  return rows_of({{"theta_i", "rad"}, {"wavelength_m", "m"}, {"theta_t", "rad"}}, 300, "",
                 R"("model": "volume", "observed": ["theta_t"], "parameters": {"eta": 1.5})", usual);
}
World ellipsometer() {
  return rows_of({{"theta_i", "rad"}, {"wavelength_m", "m"}, {"substrate_n", "1"}, {"psi", "rad"}, {"delta", "rad"}},
                 300, "", R"("model": "ellipsometer", "observed": ["psi", "delta"])", usual);
}
World polarimeter() {
  return rows_of({{"theta_i", "rad"},
                  {"wavelength_m", "m"},
                  {"polarizer", "rad"},
                  {"retarder", "rad"},
                  {"retardance", "rad"},
                  {"analyser", "rad"},
                  {"mirror_n", "1"},
                  {"value", "1"}},
                 300, "", R"("model": "polarimeter", "observed": ["value"])", usual);
}
World tracker() {
  World w = rows_of({{"nominal_x_m", "m"},
                     {"nominal_y_m", "m"},
                     {"nominal_z_m", "m"},
                     {"height_m", "m"},
                     {"time_s", "s"},
                     {"temperature_K", "K"}},
                    300, "", R"("model": "tracker", "observed": ["x_m", "y_m", "z_m"])", usual);
  for (const char* name : {"x_m", "y_m", "z_m"}) w.columns.emplace_back(name, "m");
  for (std::vector<double>& row : w.rows) row.insert(row.end(), {row[1], -row[0], row[2]});
  return w;
}
World arm() {
  World w;
  w.sections = R"("robots": {"a": {"model": "ur5"}},)";
  w.rest = R"("model": "arm", "observed": ["x_m", "y_m", "z_m"])";
  for (int j = 1; j <= 6; ++j) w.columns.emplace_back(format("joint_%d_rad", j), "rad");
  for (const char* name : {"x_m", "y_m", "z_m"}) w.columns.emplace_back(name, "m");
  Random random(3, 7);
  for (int r = 0; r < 100; ++r) {
    std::vector<double>& row = w.rows.emplace_back();
    for (int j = 0; j < 6; ++j) row.push_back(random.uniform(-2, 2));
    const Vec3 at = robot::flange(robot::known_arm("ur5", "test").links, row) * Vec3{0.1, 0, 0};
    row.insert(row.end(), {at.x, at.y, at.z});
  }
  return w;
}
World surface() {
  return rows_of({{"theta_i", "rad"},
                  {"phi_i", "rad"},
                  {"theta_o", "rad"},
                  {"phi_o", "rad"},
                  {"wavelength_m", "m"},
                  {"excitation", "1"},
                  {"time_s", "s"},
                  {"distance_m", "m"},
                  {"image_radius", "1"},
                  {"row", "px"},
                  {"f", "1/sr"}},
                 300,
                 R"("surfaces": {"s": {"model": "coated-diffuse", "albedo": {"value": 0.3, "free": true}, "f0": 0.04,
                    "alpha": 0.2}},)",
                 R"("model": "surface", "surface": "s", "observed": ["f"])", usual);
}

World markers() {
  Pieces pieces;
  pieces.glass = true;
  return marker_world(1, pieces);
}

World probe() {
  Balls balls;
  return probe_world(1, balls);
}
World probe_radiance() {
  return rows_of({{"view", ""}, {"direction", ""}, {"theta_i", "rad"}, {"time_s", "s"}, {"value", "1"}}, 300, "",
                 R"("model": "probe-radiance", "observed": ["value"])", [](const std::string& name, double share) {
                   return name == "view" || name == "direction" ? std::floor(5.999 * share) : usual(name, share);
                 });
}

World chart() {
  return rows_of({{"X", "1"},
                  {"Y", "1"},
                  {"Z", "1"},
                  {"x", "1"},
                  {"y", "1"},
                  {"image_radius", "1"},
                  {"exposure_s", "s"},
                  {"R", "1"},
                  {"G", "1"},
                  {"B", "1"}},
                 60, "", R"("model": "chart", "observed": ["R", "G", "B"])", [](const std::string& name, double share) {
                   return name == "exposure_s" ? (share < 0.5 ? 0.1 : 0.4) : usual(name, share);
                 });
}

class Candidates : public testing::TestWithParam<Walk> {};

TEST_P(Candidates, AreSeenInConditionsThatTheProblemHas) {
  const TablesProblem problem = GetParam().world().problem();
  std::set<std::string> conditions;
  for (const Condition& c : problem.observations().conditions) conditions.insert(c.name);
  ASSERT_FALSE(problem.candidates().empty());
  for (const Candidate& c : problem.candidates())
    for (const std::string& condition : c.mechanism->conditions)
      EXPECT_TRUE(GetParam().without.contains(condition) != conditions.contains(condition))
          << c.id() << " is seen in " << condition << ", which is none of " << testing::PrintToString(conditions);
}
// No table of irradiances has anything in the way of its light, or an eye; no map of heights lies beneath a BRDF.
const std::set<std::string> no_shadows = {"light.visibility", "scene.ambient-visibility", "light.shadow-edge-distance",
                                          "surface.exitance-angle", "light.identity"};
INSTANTIATE_TEST_SUITE_P(
    Models, Candidates,
    testing::Values(
        Walk{"sensor", sensor, {"surface.incidence-angle", "scene.ambient-visibility", "light.visibility"}},
        Walk{"light", light, no_shadows}, Walk{"parallel", parallel_light, no_shadows},
        Walk{"volume", volume, {"image.exposure"}}, Walk{"refraction", refraction, {"image.exposure"}},
        Walk{"ellipsometer", ellipsometer, {"surface.wavelength", "surface.difference-angle", "surface.half-angle"}},
        Walk{"polarimeter", polarimeter, {"light.polarized-part", "light.polarized-across"}},
        Walk{"tracker", tracker, {}}, Walk{"arm", arm, {}},
        Walk{"surface", surface, {"surface.spatial-frequency", "surface.lay-azimuth"}},
        // Centres of markers have no edges and throw no shadows; a volume's walls are not there.
        Walk{"markers",
             markers,
             {"image.edge-distance", "camera.edge-shift-x", "camera.edge-shift-y", "camera.edge-shift-radial",
              "light.shadow-edge-distance", "volume.size"}},
        Walk{"probe", probe, {"camera.distance", "camera.edge-shift-radial"}},
        Walk{"chart", chart, {"light.distance", "surface.incidence-angle"}},
        Walk{"probe_radiance", probe_radiance, {"image.exposure", "surface.exitance-angle", "light.identity"}}),
    [](const auto& i) { return std::string(i.param.model); });

// A column that is named after the observed one is its noise: with it the table states it, and it is no condition.
TEST(Columns, NamedAfterTheObservedOneAreItsNoise) {
  World w = sensor_world(3, [](double ideal, double, double) { return ideal; });
  w.rest = R"("model": "sensor", "observed": ["value"])";
  const TablesProblem problem = w.problem();
  EXPECT_EQ(problem.noise(), "as the table states it");
  ASSERT_EQ(problem.table().sigma.size(), 1u);
  EXPECT_EQ(problem.table().columns[problem.table().sigma[0]], "value_sigma");
  for (const Condition& c : problem.observations().conditions) EXPECT_NE(c.name, "value_sigma");
}

TEST(Columns, ThatNeverVaryAreNotWorthAQuestion) {
  World w = sensor_world(3, [](double, double, double) { return 1; });
  for (std::vector<double>& row : w.rows) row[3] = 12.5;
  try {
    w.problem();
    FAIL() << "a constant was accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    EXPECT_THAT(e.what(), testing::HasSubstr("column \"value\" is 12.5 in all 72 rows"));
  }
}

TEST(QuickTables, AModelThatIsMisspeltIsNotTakenForAConstant) {
  const gonio::tests::ScratchFolder folder;
  const std::filesystem::path file = folder / "misspelt.csv";
  std::ofstream(file) << "exposure_s,value\n1,2\n";
  try {
    quick_document({.file = file, .model = "sensr", .observed = {"value"}});
    FAIL() << "was accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::usage);
    EXPECT_STREQ(e.what(), "--model: \"sensr\" is no model, no column and no free parameter; did you mean \"sensor\"?");
  }
  // A free parameter alone is a model: a constant.
  EXPECT_EQ(quick_document({.file = file, .model = "a", .observed = {"value"}, .free = {{"a", 1}}})
                .tables.begin()
                ->second.expression,
            "a");
}

}  // namespace
}  // namespace gonio::explain::tables::tests
