// Rims against aligned models: predictions against rims that are made anew, and what is named on simulated photographs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "alignment/alignment_document.h"
#include "alignment/alignment_world.h"
#include "data.h"
#include "explain/outlines/believed_rims.h"
#include "explain/outlines/outline_parameters.h"
#include "explain/outlines/outlines_outcome.h"
#include "explain/outlines/outlines_problem.h"
#include "inference/explanation.h"
#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "manifest/sections/object.h"
#include "process.h"

namespace gonio::explain {
namespace {

using alignment::Block;
using alignment::Setting;
using alignment::testing::World;
using alignment::testing::WorldWish;
using tests::believed;

const WorldWish seen{
    .solid = 0, .views = 3, .lamps = 2, .seed = 11, .error_px = 0.1, .outliers = 0.005, .size_px = 360};

std::vector<std::string> named(const Problem& problem, const Explanation& e) {
  std::vector<std::string> ids;
  for (const std::size_t n : e.named) ids.push_back(problem.candidates()[n].id());
  return ids;
}

Explanation explained(const Problem& problem) {
  Options options;
  options.negative_controls = 12;
  return explain(problem, options);
}

double value_of(const Problem& problem, const Explanation& e, const std::string& name) {
  for (std::size_t p = 0; p < problem.parameters().size(); ++p)
    if (problem.parameters()[p].name == name) return e.values[p];
  ADD_FAILURE() << name;
  return 0;
}

// The model's own rim, moved, against what is predicted of its points.
TEST(Outlines, PredictWhereMovedModelsHaveTheirRims) {
  World world = alignment::testing::world_of(seen);
  const OutlinesInput input = believed(world, [](Setting&) {});
  OutlineModel model(input);
  const OutlineParameters declared = outline_parameters(input, model);
  const auto amount = [&](const std::string& name, double value) {
    std::vector<double> values;
    for (const Parameter& p : declared.parameters) values.push_back(p.neutral);
    for (std::size_t k = 0; k < values.size(); ++k)
      if (declared.parameters[k].name == name) values[k] = value;
    return values;
  };
  for (const auto& [name, value] : std::vector<std::pair<std::string, double>>{{"geometry.shrinkage.shrink_x", 0.02},
                                                                               {"geometry.scale.growth", 0.01},
                                                                               {"objects/solid/turn_y_rad", 0.01},
                                                                               {"lights/lamp-0/shift_x_m", 0.005}}) {
    const std::vector<double> values = amount(name, value);
    const Setting moved = model.setting(values);
    double worst = 0, most = 0;
    for (std::size_t g = 0; g < input.views.size(); ++g) {
      const alignment::ModelRim before(input.in.stated, input.views[g].subject), after(moved, input.views[g].subject);
      std::vector<double> predicted(input.views[g].rows.size());
      model.predict(values, g, predicted);
      std::vector<double> off;
      for (std::size_t i = 0; i < predicted.size(); ++i) {
        const OutlineRow& row = input.views[g].rows[i];
        const auto here = before.nearest(row.pixel, row.outward, 1);
        const auto place = after.nearest(row.pixel, row.outward, 8);
        if (!here || !place) continue;
        off.push_back(std::abs(here->distance_px - place->distance_px - predicted[i]));
        most = std::max(most, std::abs(predicted[i]));
      }
      std::sort(off.begin(), off.end());
      worst = std::max(worst, off[off.size() * 9 / 10]);
    }
    EXPECT_GT(most, 0.3) << name;
    EXPECT_LT(worst, 0.03 + 0.05 * most) << name;
  }
}

TEST(Outlines, NothingIsNamedWhereNothingIsWrong) {
  World world = alignment::testing::world_of(seen);
  const auto problem = outlines_problem(believed(world, [](Setting&) {}));
  EXPECT_THAT(named(*problem, explained(*problem)), ::testing::IsEmpty());
}

TEST(Outlines, ShrinkageAlongEachAxisIsNamed) {
  WorldWish wish = seen;
  wish.scale_sigma = 0.03;
  World world = alignment::testing::world_of(wish);
  const Vec3 scale = world.truth.bodies[0].scale;
  const auto problem = outlines_problem(believed(world, [](Setting& s) { s.bodies[0].scale = {1, 1, 1}; }));
  const Explanation e = explained(*problem);
  EXPECT_THAT(named(*problem, e), ::testing::ElementsAre("geometry.shrinkage"));
  EXPECT_NEAR(value_of(*problem, e, "geometry.shrinkage.shrink_x"), 1 - scale.x, 0.004);
  EXPECT_NEAR(value_of(*problem, e, "geometry.shrinkage.shrink_y"), 1 - scale.y, 0.004);
  EXPECT_NEAR(value_of(*problem, e, "geometry.shrinkage.shrink_z"), 1 - scale.z, 0.004);
}

TEST(Outlines, ALampThatStandsElsewhereIsNamed) {
  World world = alignment::testing::world_of(seen);
  const auto problem = outlines_problem(believed(
      world,
      [](Setting& s) {
        s.lamps_m[1] += Vec3{0.012, -0.008, 0.01};
      },
      true));
  const Explanation e = explained(*problem);
  EXPECT_THAT(named(*problem, e), ::testing::ElementsAre("light.position"));
  EXPECT_NEAR(value_of(*problem, e, "lamp-1/shift_x_m"), -0.012, 0.004);
}

// A scene grows about the object's origin, the fit about the middle of its box: what is written is the same body.
TEST(Outlines, AGrowthIsWrittenAsScenesApplyIt) {
  World world = alignment::testing::world_of(seen);
  const OutlinesInput input = believed(world, [](Setting&) {});
  OutlineModel model(input);
  const OutlineParameters declared = outline_parameters(input, model);
  const auto problem = outlines_problem(input);
  Explanation e;
  e.values.assign(declared.parameters.size(), 0.0), e.sigma.assign(e.values.size(), 0.0);
  for (std::size_t n = 0; n < problem->candidates().size(); ++n)
    if (problem->candidates()[n].id() == "geometry.scale") e.named = {n};
  ASSERT_EQ(e.named.size(), 1U);
  const std::size_t growth = problem->candidates()[e.named[0]].parameters[0];
  e.values[growth] = 0.03, e.active = declared.base, e.active.push_back(growth);
  e.covariance.assign(e.active.size() * e.active.size(), 0.0);
  manifest::Document document;
  document.objects.emplace_back().id = "solid";
  for (const std::string& lamp : input.in.lamps) document.lights[lamp];
  upgrade_outlines(*problem, model, input, e, document);
  const alignment::Body fitted = model.setting(e.values).bodies[0];
  for (const Vec3 x : {Vec3{0.01, -0.02, 0.03}, Vec3{-0.04, 0.01, 0}})
    EXPECT_LT(norm(*document.objects[0].world_from_object * (x * 1.03) - fitted.place_m(x)), 1e-12);
}

// Pictures by another renderer, whose lamps were spheres of 35 mm: masks, poses and lamps as align finds them.
TEST(RecordedRims, LampsOf35MillimetresAreNamed) {
  GONIO_NEEDS_DATA("recordings");
  const std::filesystem::path root = tests::data("recordings");
  manifest::Document document = manifest::read_document(root / "practice-5.json", {.allow_outside = true});
  tests::ScratchFolder scratch;
  alignment::AlignmentRequest request;
  request.masks.by = alignment::MaskWish::By::lamps;
  request.output_path = [&](const std::string& name) { return scratch / name; };
  ASSERT_EQ(alignment::align_document(document, request), alignment::Verdict::found);
  const auto problem = outlines_problem(outlines_input(document));
  const Explanation e = explained(*problem);
  EXPECT_THAT(named(*problem, e), ::testing::ElementsAre("light.finite-size"));
  for (const char* lamp : {"light-0", "light-1", "light-2"})
    EXPECT_NEAR(value_of(*problem, e, std::string(lamp) + "/radius_m"), 0.035, 0.004) << lamp;
}

// A patch of light within each shadow, as a body of glass makes it.
TEST(Outlines, LightWithinShadowsIsNamed) {
  World world = alignment::testing::world_of(seen);
  world.input.rims.clear(), world.input.question.sightings.clear();
  std::mt19937_64 random(3);
  for (std::size_t v = 0; v < world.truth.stations.size(); ++v)
    for (std::size_t l = 0; l < world.truth.lamps_m.size(); ++l) {
      alignment::testing::Labels labels = alignment::testing::photographed(world.truth, v, l, seen, random);
      double x = 0, y = 0, n = 0;
      for (std::size_t i = 0; i < labels.of.size(); ++i)
        if (labels.of[i] == alignment::testing::shadow)
          x += static_cast<double>(i % 360), y += static_cast<double>(i / 360), n += 1;
      if (n < 600) continue;
      for (std::size_t i = 0; i < labels.of.size(); ++i)
        if (labels.of[i] == alignment::testing::shadow &&
            std::hypot(static_cast<double>(i % 360) - x / n, static_cast<double>(i / 360) - y / n) < 9)
          labels.of[i] = alignment::testing::ground;
      alignment::testing::add_rims(world, labels, v, l, seen);
    }
  const auto problem = outlines_problem(believed(world, [](Setting&) {}));
  EXPECT_THAT(named(*problem, explained(*problem)), ::testing::ElementsAre("mask.caustic"));
}

}  // namespace
}  // namespace gonio::explain
