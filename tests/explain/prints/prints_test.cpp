// explain on prints: what the simulation makes of pictures, and what is found in maps of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "explain/prints/map_readings.h"
#include "explain/prints/print_term.h"
#include "explain/prints/sample.h"
#include "explain/prints/sight.h"
#include "inference/explanation.h"
#include "inference/fit.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/print.h"
#include "print/mechanisms/print_bleed.h"
#include "print/mechanisms/print_growth.h"
#include "print/mechanisms/print_layer_shift.h"
#include "print/mechanisms/print_membrane.h"
#include "print/mechanisms/print_overcure.h"
#include "print/mechanisms/print_pixel_tilt.h"
#include "print/mechanisms/print_shrinkage.h"

namespace gonio::explain::tests {
namespace {

using namespace prints;

TEST(PrintGrowth, IsToldByWhiteThresholdAndCurvature) {
  const print::GrowthLaw law{19.5e-6, 11e-6, -0.01};
  const equation::PrintGrowth told = equation::print_growth_of(law);
  const print::GrowthLaw again = equation::print_growth(told);
  EXPECT_NEAR(again.alpha_m, law.alpha_m, 1e-12);
  EXPECT_NEAR(again.beta_m, law.beta_m, 1e-12);
  EXPECT_NEAR(again.gamma, law.gamma, 1e-9);
  const print::GrowthLaw straight = equation::print_growth({20e-6, 0, 0});  // in proportion, to a part in a thousand
  for (const double grey : {0.1, 0.5, 1.0}) EXPECT_NEAR(straight.height_m(grey), grey * 20e-6, 20e-9);
}

TEST(PrintBleed, SpreadsFollowOneAnother) {
  const print::Bleed both = equation::print_bleed({3e-5, 0, 0}, 4e-5, 0.1, 2e-4);
  EXPECT_NEAR(both.sigma_m, 5e-5, 1e-12);
  EXPECT_DOUBLE_EQ(both.tail_share, 0.1);
  EXPECT_DOUBLE_EQ(both.tail_m, 2e-4);
}

TEST(PrintOvercure, FallsToAnEthInItsDepth) {
  EXPECT_NEAR(equation::print_overcure(2e-5, 2e-5), std::exp(-1), 1e-15);
  EXPECT_EQ(equation::print_overcure(2e-5, 0), 0);
}

TEST(PrintPixelTilt, IsSharpAtOneEnd) {
  EXPECT_EQ(equation::print_pixel_tilt({0, 0.5}, {1, 1}, 0.02, 0), 0);
  EXPECT_DOUBLE_EQ(equation::print_pixel_tilt({1, 0.5}, {1, 1}, 0.02, 0), 0.02);
  EXPECT_DOUBLE_EQ(equation::print_pixel_tilt({0.25, 0.5}, {1, 1}, -0.02, 0), 0.015);
}

TEST(Seen, IsExactForEvenCellsBetweenKnots) {
  Field field{.width = 6, .height = 4, .corner_m = {}, .cell_m = {1, 1}, .top_m = {}, .ceiling_m = {}};
  for (int i = 0; i < 24; ++i) field.top_m.push_back(i * i % 7);
  const Seen means(field, {2, 2}, 0);
  const auto cell = [&](int x, int y) { return field.top_m[static_cast<std::size_t>(y * 6 + x)]; };
  EXPECT_NEAR(means.at(2, 2), (cell(1, 1) + cell(2, 1) + cell(1, 2) + cell(2, 2)) / 4, 1e-12);
  // A square from x = 1.3 to 3.3 holds 0.7 of the cells of column 1, all of 2 and 0.3 of 3.
  double sum = 0;
  for (const int y : {1, 2}) sum += 0.7 * cell(1, y) + cell(2, y) + 0.3 * cell(3, y);
  EXPECT_NEAR(means.at(2.3, 2), sum / 4, 1e-12);
  field.top_m.assign(24, 5.0);
  EXPECT_NEAR(Seen(field, {0.7, 0.7}, 1.3).at(3.2, 1.7), 5, 1e-12);
}

// A step under a Gaussian is the normal law.
TEST(Seen, BlursByItsResolution) {
  Field field{.width = 40, .height = 3, .corner_m = {}, .cell_m = {1, 1}, .top_m = {}, .ceiling_m = {}};
  for (int i = 0; i < 120; ++i) field.top_m.push_back(i % 40 < 20 ? 0 : 1);
  const Seen seen(field, {0.01, 0.01}, 2);
  for (const double x : {17.0, 19.5, 20.0, 22.25})
    EXPECT_NEAR(seen.at(x, 1.5), 0.5 * std::erfc((20 - x) / (2 * std::sqrt(2.0))), 2e-3) << x;
}

TEST(PrintedField, IsWhatGrowsOverTheLayersBelow) {
  const Sent sent = sample();
  const Field field = printed_field(sent, stated(sent));
  // The pixel (11, 3) has grey 0.35 in layer 4 over three white ones, of which none is as thick as its layer.
  const std::size_t cell = 2 * 3 * static_cast<std::size_t>(field.width) + 2 * 11;
  EXPECT_NEAR(field.top_m[cell], 60e-6 + sent.printer.growth.height_m(0.35, 20e-6), 1e-10);
  EXPECT_NEAR(field.ceiling_m[cell], 80e-6, 1e-10);
}

TEST(PrintedField, IsDisplacedByWholePixels) {
  const Sent sent = sample();
  Setting setting = stated(sent);
  setting.shifted_from = 3, setting.shift_m = {60e-6, 0};
  Sent moved = sent;
  for (std::size_t k = 2; k < moved.layers.size(); ++k)
    for (int y = 0; y < side_px; ++y)
      for (int x = 0; x < side_px; ++x)
        moved.layers[k][static_cast<std::size_t>(y * side_px + x)] =
            x < 2 ? 0 : sent.layers[k][static_cast<std::size_t>(y * side_px + x - 2)];
  const Field a = printed_field(sent, setting), b = printed_field(moved, stated(moved));
  for (std::size_t i = 0; i < a.top_m.size(); ++i) EXPECT_NEAR(a.top_m[i], b.top_m[i], 1e-10);
}

// Light that moves a wall by little moves its cells' heights by as little: twice the step, twice the change.
TEST(PrintedField, ChangesEvenlyWithTheSpread) {
  const Sent sent = sample();
  const auto field = [&](double sigma_m) {
    Setting setting = stated(sent);
    setting.printer.bleed.sigma_m = sigma_m;
    return printed_field(sent, setting);
  };
  const Field none = field(15e-6), once = field(15.1e-6), twice = field(15.2e-6);
  double squares = 0, apart = 0;
  for (std::size_t i = 0; i < none.top_m.size(); ++i) {
    const double a = once.top_m[i] - none.top_m[i], b = twice.top_m[i] - once.top_m[i];
    squares += a * a, apart += (b - a) * (b - a);
  }
  EXPECT_GT(squares, 1e-16);
  EXPECT_LT(std::sqrt(apart), 0.1 * std::sqrt(squares));
}

// Far from the rims light is shared out anew, none is made: a field in proportion keeps its mean.
TEST(PrintedField, OfATiltedProjectorKeepsTheLight) {
  Sent sent = sample(false);
  for (std::vector<float>& layer : sent.layers) std::fill(layer.begin(), layer.end(), 0.0f);
  sent.layers[0].assign(sent.layers[0].size(), 0.0f);
  sent.layers[0][20 * side_px + 20] = 0.8f;
  Setting setting = stated(sent);
  setting.tilt = {1.5 / side_px, 0};  // 1.5 pixels at the far side
  const Field field = printed_field(sent, setting);
  double sum = 0, x = 0, xx = 0;
  for (int j = 0; j < field.height; ++j)
    for (int i = 0; i < field.width; ++i) {
      const double z = field.top_m[static_cast<std::size_t>(j * field.width + i)];
      sum += z, x += z * i, xx += z * i * i;
    }
  EXPECT_NEAR(sum, 4 * 0.8 * 20e-6, 1e-9);
  const double spread_px = std::sqrt(xx / sum - x * x / (sum * sum) - 0.25 - 1.0 / 12) / cells_per_pixel;
  EXPECT_NEAR(spread_px, 1.5 * 20.5 / 40, 0.05);
}

TEST(Terms, AreAbsentAtNeutralAndSeenWhereTheirSearchBegins) {
  const Sent sent = sample();
  const Field base = printed_field(sent, stated(sent));
  ASSERT_GE(all_terms().size(), 7U);
  for (const Term* term : all_terms()) {
    const mechanism::Mechanism& m = term->mechanism();
    std::vector<Bounds> bounds;
    if (term->bounds != nullptr)
      bounds = term->bounds(sent);
    else
      for (const mechanism::Parameter& p : m.parameters) bounds.push_back({p.neutral, p.lower, p.upper, p.start});
    ASSERT_EQ(bounds.size(), m.parameters.size()) << m.id;
    const std::vector<Form> forms = term->forms != nullptr ? term->forms(sent) : std::vector<Form>{{}};
    ASSERT_FALSE(forms.empty()) << m.id;
    for (const Form& form : forms) {
      std::vector<double> neutral, start;
      for (const Bounds& b : bounds) neutral.push_back(b.neutral), start.push_back(b.start);
      Setting off = stated(sent), on = off;
      term->set(off, sent, form, neutral);
      const Field without = printed_field(sent, off);
      double worst = 0;
      for (std::size_t i = 0; i < base.top_m.size(); ++i)
        worst = std::max(worst, std::abs(without.top_m[i] - base.top_m[i]));
      EXPECT_LT(worst, 1e-9) << m.id;
      if (term->random) continue;
      term->set(on, sent, form, start);
      const Field with = printed_field(sent, on);
      double change = norm(on.shrinkage) * base.top_m[0];
      for (std::size_t i = 0; i < base.top_m.size(); ++i)
        change = std::max(change, std::abs(with.top_m[i] - base.top_m[i]));
      EXPECT_GT(change, 1e-7) << m.id;
    }
  }
}

TEST(Readings, AreMeansOverPixelsWithTheirNoise) {
  const Sent sent = sample();
  const Readings readings = readings_of(measured(sent, stated(sent), 0.4e-6, 3));
  EXPECT_EQ(readings.rows.size(), static_cast<std::size_t>(side_px * side_px));
  EXPECT_NEAR(readings.noise_um, 0.2, 0.05);  // of four points
  for (const Reading& r : readings.rows) EXPECT_LT(r.patch, 16U);
}

TEST(Readings, RefuseAMapThatShowsTooLittle) {
  const Sent sent = sample();
  PrintsInput input = measured(sent, stated(sent), 0.1e-6, 3);
  for (double& z : input.maps[0].map.z_m) z = std::nan("");
  try {
    readings_of(input);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("scene.json#/reliefs/sample: shows 0 pixels of the print"));
  }
}

// Derivatives that fits use, against wider differences of predictions.
TEST(PrintsProblem, DerivativesAreThoseOfPredictions) {
  const Sent sent = sample();
  const auto problem = prints_problem(measured(sent, stated(sent), 0.2e-6, 5));
  std::vector<double> values;
  for (const auto& p : problem->parameters()) values.push_back(p.neutral);
  // Beside knots of weights, where slopes by places are as sure as they are anywhere. Of so little spread that it moves
  // single cells over the threshold no difference is like another: ChangesEvenlyWithTheSpread asks where there is more.
  for (const std::size_t p : problem->base())
    if (problem->parameters()[p].unit == "px") values[p] += 0.013;
  for (const auto& c : problem->candidates())
    if (c.id() == mechanism::print_membrane().id || c.id() == mechanism::print_overcure().id)
      for (const std::size_t p : c.parameters) values[p] = problem->parameters()[p].start;
  std::vector<std::size_t> columns = problem->base();
  std::erase_if(columns, [&](std::size_t p) { return problem->parameters()[p].name == "prints/p/bleed/spread_px"; });
  for (const auto& c : problem->candidates())
    if (c.id() == mechanism::print_overcure().id || c.id() == mechanism::print_shrinkage().id ||
        c.id() == mechanism::print_membrane().id)
      columns.insert(columns.end(), c.parameters.begin(), c.parameters.end());
  const std::size_t rows = problem->observations().first[6] - problem->observations().first[5];
  std::vector<double> slopes(rows * columns.size()), above(rows), below(rows);
  problem->jacobian(values, 5, columns, slopes);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto& p = problem->parameters()[columns[k]];
    std::vector<double> moved = values;
    const double step = 0.05 * p.size;
    moved[columns[k]] = values[columns[k]] + step;
    problem->predict(moved, 5, above);
    moved[columns[k]] = values[columns[k]] - step;
    problem->predict(moved, 5, below);
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < rows; ++i) {
      const double slope = (above[i] - below[i]) / (2 * step);
      difference += std::pow(slope - slopes[k * rows + i], 2), size += slope * slope;
    }
    EXPECT_LT(std::sqrt(difference), 0.05 * std::sqrt(size) + 1e-9) << p.name;
  }
}

// The fit with one candidate in play, from where its search begins.
struct Fitted {
  std::unique_ptr<Problem> problem;
  std::vector<double> values;
  std::vector<std::size_t> own;  // the candidate's parameters
};
Fitted fitted(const Setting& made, const std::string& id, const std::string& on, std::uint64_t seed) {
  Fitted f;
  f.problem = prints_problem(measured(sample(), made, 0.3e-6, seed));
  std::vector<double> start;
  for (const auto& p : f.problem->parameters()) start.push_back(p.neutral);
  std::vector<std::size_t> active = f.problem->base();
  for (const auto& c : f.problem->candidates()) {
    if (c.id() != id || (!on.empty() && c.on != std::vector<std::string>{on})) continue;
    f.own = c.parameters;
    break;
  }
  for (const std::size_t p : f.own) start[p] = f.problem->parameters()[p].start;
  active.insert(active.end(), f.own.begin(), f.own.end());
  const inference::System system(*f.problem, 1);
  f.values = inference::fit(system, start, active).values;
  return f;
}

// Fits of noisy maps come back to what made them.
TEST(Fits, FindTheGrowthThatMadeThem) {
  Setting made = stated(sample());
  equation::PrintGrowth told = equation::print_growth_of(*made.printer.growth.law());
  told.white_m *= 0.95, told.threshold += 0.02, told.curvature *= 0.6;
  made.printer.growth = print::Growth(equation::print_growth(told));
  const Fitted f = fitted(made, mechanism::print_growth().id, "", 21);
  ASSERT_EQ(f.own.size(), 3U);
  // The height over the plane is told by the few greys that cease to cure, the law's shape by all of them.
  EXPECT_NEAR(f.values[f.own[1]], 0.02, 0.03);
  EXPECT_NEAR(f.values[f.own[2]] / (-0.4 * told.curvature / 0.6), 1, 0.3);
}
TEST(Fits, FindTheBleedThatMadeThem) {
  Setting made = stated(sample());
  made.printer.bleed = {18e-6, 0, 0};
  const Fitted f = fitted(made, mechanism::print_bleed().id, "", 22);
  EXPECT_NEAR(f.values[f.own.at(0)], 18e-6, 0.7e-6);
}
TEST(Fits, FindTheDepthOfPenetrationThatMadeThem) {
  Setting made = stated(sample());
  made.printer.overcure_m = 14e-6;
  const Fitted f = fitted(made, mechanism::print_overcure().id, "", 23);
  EXPECT_NEAR(f.values[f.own.at(0)], 14e-6, 1e-6);
}
TEST(Fits, FindTheSlipThatMadeThem) {
  Setting made = stated(sample());
  made.shifted_from = 4, made.shift_m = {20e-6, -12e-6};
  const Fitted f = fitted(made, mechanism::print_layer_shift().id, "layer 4", 24);
  EXPECT_NEAR(f.values[f.own.at(0)], 20e-6, 1e-6);
  EXPECT_NEAR(f.values[f.own.at(1)], -12e-6, 1e-6);
}
TEST(Fits, FindTheMembraneThatMadeThem) {
  Setting made = stated(sample());
  made.cut_m = 3e-6;
  const Fitted f = fitted(made, mechanism::print_membrane().id, "", 25);
  EXPECT_NEAR(f.values[f.own.at(0)], 3e-6, 0.2e-6);
}

TEST(Answers, NothingWhereNothingIsLeftOut) {
  const auto problem = prints_problem(measured(sample(), stated(sample()), 0.5e-6, 11));
  const Explanation e = explain(*problem, {.negative_controls = 4});
  EXPECT_TRUE(e.named.empty()) << e.sentence;
  manifest::Document document;
  document.prints["p"].layer_m = 20e-6;
  problem->apply(e, document);
  EXPECT_FALSE(document.prints.at("p").growth.has_value());
}

// Written where the printer's section has a place for it, or else as a mechanism in use, with its layer.
TEST(Answers, AreWrittenIntoTheManifest) {
  const auto problem = prints_problem(measured(sample(), stated(sample()), 0.5e-6, 11));
  Explanation e;
  for (const auto& p : problem->parameters()) e.values.push_back(p.neutral);
  e.sigma.assign(e.values.size(), 0.0);
  const auto put = [&](const std::string& id, const std::string& on, double value) {
    for (const auto& c : problem->candidates())
      if (c.id() == id && (on.empty() || c.on == std::vector<std::string>{on})) {
        for (const std::size_t p : c.parameters) e.values[p] = value, e.sigma[p] = 0.1 * value, e.active.push_back(p);
        return;
      }
  };
  put(mechanism::print_bleed().id, "", 2e-5);
  put(mechanism::print_overcure().id, "", 3e-5);
  put(mechanism::print_layer_shift().id, "layer 5", 1e-5);
  e.covariance.assign(e.active.size() * e.active.size(), 0.0);
  manifest::Document document;
  document.prints["p"].layer_m = 20e-6;
  problem->apply(e, document);
  const manifest::Print& print = document.prints.at("p");
  ASSERT_TRUE(print.bleed.has_value());
  EXPECT_DOUBLE_EQ(print.bleed->sigma_m, 2e-5);
  EXPECT_DOUBLE_EQ(*print.overcure_m, 3e-5);
  EXPECT_FALSE(print.growth.has_value());
  const manifest::MechanismUse& use = document.mechanisms.at(mechanism::print_layer_shift().id);
  EXPECT_EQ(use.parameters.at("layer").value.at(0), 5);
  EXPECT_EQ(use.parameters.at("x_m").value.at(0), 1e-5);
  EXPECT_EQ(use.on, std::vector<std::string>{"p"});
}

}  // namespace
}  // namespace gonio::explain::tests
