// The equations of the registry: identity at neutral, factors that never turn light negative. And that whoever binds to
// a mechanism says the same number as its equation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/random.h"
#include "explain/stacks/exposure_binding.h"
#include "explain/stacks/light_binding.h"
#include "explain/tables/table_model.h"
#include "mechanism/mechanism.h"
#include "render/link.h"
#include "scene/edit.h"

namespace gonio::mechanism {
namespace {

using Numbers = std::vector<double>;

double between(double lower, double upper, Random& random) {
  if (lower > 0 && upper / lower > 1e3) return lower * std::pow(upper / lower, random.uniform());
  return random.uniform(lower, upper);
}

Numbers inputs_of(const Mechanism& m, Random& random) {
  Numbers at;
  for (const Input& input : m.inputs) {
    const double v = between(input.lower, input.upper, random);
    at.push_back(input.name == "channel" ? std::floor(v * 1.499) : v);  // 0, 1 or 2
  }
  return at;
}

Numbers amounts_of(const Mechanism& m, Random& random) {
  Numbers p;
  for (const Parameter& parameter : m.parameters) {
    const bool bend = parameter.name.starts_with("bend_");  // ten of the largest in a row leave no number
    p.push_back(bend ? random.uniform(-0.7, 0.7) : between(parameter.lower, parameter.upper, random));
  }
  return p;
}

Numbers neutral_of(const Mechanism& m) {
  Numbers p;
  for (const Parameter& parameter : m.parameters) p.push_back(parameter.neutral);
  return p;
}

double input(const Mechanism& m, const Numbers& at, const std::string& name) {
  const auto found = std::ranges::find(m.inputs, name, &Input::name);
  EXPECT_NE(found, m.inputs.end()) << m.id << " has no input " << name;
  return at[static_cast<std::size_t>(found - m.inputs.begin())];
}

std::vector<const Mechanism*> with_equation() {
  std::vector<const Mechanism*> all;
  for (const Mechanism* m : all_mechanisms())
    if (m->act != nullptr) all.push_back(m);
  return all;
}

const Mechanism& of(const std::string& id) {
  return *find_mechanism(id);
}

void expect_same(double value, double equation, const std::string& what) {
  EXPECT_NEAR(value, equation, 1e-12 * std::max(1.0, std::abs(equation))) << what;
}

constexpr int draws = 300;

TEST(Equations, OfWhateverActsOnSingleValuesAreDeclared) {
  std::set<std::string> ids;
  for (const Mechanism* m : with_equation()) ids.insert(m->id);
  for (const char* id :
       {"light.ambient", "light.drift", "light.inverse-square", "light.spectrum", "optics.bloom", "optics.ghost",
        "optics.veiling-glare", "optics.vignetting", "reference.tile", "sensor.black-offset", "sensor.crosstalk",
        "sensor.non-linearity", "sensor.prnu", "sensor.row-pattern", "sensor.saturation", "sensor.shutter",
        "surface.fluorescence", "volume.absorption"})
    EXPECT_TRUE(ids.contains(id)) << id;
}

TEST(Equations, GiveTheValueBackToTheLastBitAtNeutral) {
  Random random(1, 1);
  for (const Mechanism* m : with_equation())
    for (int i = 0; i < draws; ++i) {
      const double v = random.uniform(-2, 20);
      EXPECT_EQ(m->act(v, inputs_of(*m, random), neutral_of(*m)), v) << m->id;
    }
}

// What takes nothing to nothing is a factor on light, or on what a pixel makes of it. Within what is declared as
// plausible it never turns light into its negative: a lens that loses 60 % half a width from the centre would at the
// corners of a picture, a fast shutter at the shortest exposures.
TEST(Equations, NeverTurnLightNegativeWithinTheDeclaredBounds) {
  Random random(2, 1);
  int factors = 0;
  for (const Mechanism* m : with_equation()) {
    bool is_factor = true;
    for (int i = 0; i < draws && is_factor; ++i)
      is_factor = m->act(0, inputs_of(*m, random), amounts_of(*m, random)) == 0;
    factors += is_factor;
    for (int i = 0; is_factor && i < 20 * draws; ++i) {
      const Numbers at = inputs_of(*m, random), p = amounts_of(*m, random);
      const double v = between(1e-3, 1e3, random);
      ASSERT_GE(m->act(v, at, p), 0) << m->id << " on " << v;
    }
  }
  EXPECT_GE(factors, 10);
}

// Which of the parameters `act` looks at. A form of a mechanism that has several leaves the others alone.
std::vector<bool> seen_by(double (*act)(double, std::span<const double>, std::span<const double>), const Mechanism& m,
                          Random& random) {
  std::vector<bool> seen(m.parameters.size(), false);
  for (int i = 0; i < 20; ++i) {
    const Numbers at = inputs_of(m, random), p = amounts_of(m, random);
    const double v = random.uniform(0.1, 5);
    for (std::size_t k = 0; k < p.size(); ++k) {
      Numbers other = p;
      other[k] = between(m.parameters[k].lower, m.parameters[k].upper, random);
      if (act(v, at, other) != act(v, at, p)) seen[k] = true;
    }
  }
  return seen;
}

TEST(Bindings, TermsOfTablesSayWhatTheEquationSays) {
  Random random(3, 1);
  int forms = 0;
  for (const explain::tables::Term* term : explain::tables::all_forms()) {
    const Mechanism& m = term->mechanism();
    ASSERT_NE(m.act, nullptr) << m.id;
    if (!term->columns.empty() || !m.inputs.empty()) {  // the columns are the inputs, in their order
      ASSERT_EQ(term->columns.size(), m.inputs.size()) << m.id;
      for (std::size_t k = 0; k < m.inputs.size(); ++k) EXPECT_EQ(term->columns[k].name, m.inputs[k].name) << m.id;
    }
    ++forms;
    if (term->act == nullptr) continue;  // it is the equation itself
    const std::vector<bool> seen = seen_by(term->act, m, random);
    for (int i = 0; i < draws; ++i) {
      const Numbers at = inputs_of(m, random);
      Numbers p = amounts_of(m, random);
      for (std::size_t k = 0; k < p.size(); ++k)
        if (!seen[k]) p[k] = m.parameters[k].neutral;
      const double v = random.uniform(0, 5);
      expect_same(term->act(v, at, p), m.act(v, at, p), m.id);
    }
  }
  EXPECT_GE(forms, 15);
}

TEST(Bindings, LinksOfTheSensorChainSayWhatTheEquationSays) {
  Random random(4, 1);
  int values = 0;
  for (const render::Link* link : render::all_links()) {
    if (link->value == nullptr) continue;
    const Mechanism& m = link->mechanism();
    ++values;
    for (int i = 0; i < draws; ++i) {
      Numbers at = inputs_of(m, random);
      const Numbers p = amounts_of(m, random);
      const auto pixel = static_cast<std::uint64_t>(i);
      Random fixed(7, pixel), again(7, pixel);
      int row = 0;
      if (m.id == "sensor.row-pattern") at[0] = row = static_cast<int>(at[0]);
      if (m.id == "sensor.prnu") at[0] = again.normal();
      const double v = random.uniform(-0.1, 5);
      expect_same(link->value(p)(v, {row, fixed}), m.act(v, at, p), m.id);
    }
  }
  EXPECT_GE(values, 5);
}

// Pictures hold floats.
void expect_same_picture(const render::Link& link, const io::Image& before, double exposure_s, const Numbers& p,
                         const std::function<Numbers(std::size_t i)>& at) {
  io::Image after = before;
  link.picture(p, exposure_s)(after);
  const Mechanism& m = link.mechanism();
  for (std::size_t i = 0; i < before.data.size(); ++i) {
    const double equation = m.act(before.data[i], at(i), p);
    EXPECT_NEAR(after.data[i], equation, 1e-6 * std::max(1.0, std::abs(equation))) << m.id;
  }
}

TEST(Bindings, LinksOnWholePicturesSayWhatTheEquationSays) {
  Random random(5, 1);
  int pictures = 0;
  for (const render::Link* link : render::all_links()) {
    const Mechanism& m = link->mechanism();
    if (link->picture == nullptr || m.act == nullptr) continue;
    ++pictures;
    for (int i = 0; i < draws; ++i) {
      io::Image picture(2, 1, {"R", "G", "B"});
      for (float& v : picture.data) v = static_cast<float>(random.uniform(0, 5));
      const auto& d = picture.data;
      const double exposure_s = between(1e-4, 10, random);
      const Numbers p = amounts_of(m, random);
      const auto at = [&](std::size_t k) -> Numbers {
        if (m.id == "sensor.shutter") return {exposure_s};
        if (m.id == "optics.ghost") return {d[(k + 3) % 6]};
        if (m.id == "optics.bloom") {  // of the two pixels; k(r) of its declaration
          const double square = p[1] * p[1], beside = std::pow(1 + 1 / square, -1.5);
          return {(d[k] + beside * d[(k + 3) % 6]) / (2 * pi * square)};
        }
        if (m.id == "optics.veiling-glare") return {0.5 * (double{d[k % 3]} + d[k % 3 + 3])};
        return {double{d[k - k % 3]} + d[k - k % 3 + 1] + d[k - k % 3 + 2]};  // crosstalk
      };
      expect_same_picture(*link, picture, exposure_s, p, at);
    }
  }
  EXPECT_EQ(pictures, 5);
}

TEST(Bindings, ScenesSayOfTimeWhatTheEquationSays) {
  Random random(6, 1);
  int count = 0;
  for (const scene::Edit* edit : scene::all_edits()) {
    if (edit->lamps == nullptr) continue;
    ++count;
    const Mechanism& m = edit->mechanism();
    for (int i = 0; i < draws; ++i) {
      Numbers at = inputs_of(m, random);
      const Numbers p = amounts_of(m, random);
      const Rgb factor = edit->lamps(p, {.since_s = at[0], .along = at[0]});
      for (int c = 0; c < 3; ++c) {
        if (at.size() > 1) at[1] = c;
        expect_same(factor[c], m.act(1, at, p), m.id);
      }
    }
  }
  EXPECT_EQ(count, 2);
}

TEST(Bindings, TheSceneSaysOfVignettingWhatTheEquationSays) {
  Random random(7, 1);
  const Mechanism& m = of("optics.vignetting");
  for (int i = 0; i < draws; ++i) {
    const int width = 640, height = static_cast<int>(random.uniform(100, 1400));
    const Vec2 pixel{random.uniform(0, width - 1), random.uniform(0, height - 1)};
    const double x = pixel.x - 0.5 * (width - 1), y = pixel.y - 0.5 * (height - 1);
    const Numbers p = amounts_of(m, random), at{std::hypot(x, y) / (0.5 * width)};
    expect_same(scene::vignetting(p[0], width, height, pixel), m.act(1, at, p), m.id);
  }
}

using explain::stacks::PatchLight;
using explain::stacks::PatchModel;
using explain::stacks::ReadingChain;
using explain::stacks::Stack;

// One number or two, as the mechanism declares them.
TEST(Bindings, StacksOfExposuresSayWhatTheEquationSays) {
  Random random(8, 1);
  int count = 0;
  Stack stack;
  stack.channels = {"Y"};
  stack.full_scale = 1.7;
  for (const explain::stacks::ExposureBinding* binding : explain::stacks::all_exposure_bindings()) {
    const Mechanism& m = binding->mechanism();
    if (m.act == nullptr) continue;  // what moved is left out
    ++count;
    for (int i = 0; i < draws; ++i) {
      const Numbers at = inputs_of(m, random);
      Numbers p = amounts_of(m, random), numbers = p;
      if (m.id == "sensor.non-linearity") {  // its numbers: the curve's, then those of the closed forms
        p[1] = stack.full_scale;
        numbers.assign(p.begin() + 5, p.end());
        numbers.insert(numbers.end(), {p[2], p[0], p[3], p[4]});
      }
      explain::stacks::Taken taken{.exposure_s = random.uniform(0.01, 1), .gain = 1.3};
      ReadingChain chain;
      chain.stack = &stack;
      binding->set(numbers, stack, chain);
      if (m.id == "sensor.shutter") taken.exposure_s = at[0];
      if (m.id == "light.drift") taken.since_s = at[0];
      if (m.id == "sensor.exposure") taken.image = 0;
      if (m.id == "optics.lens-shading")
        taken.radius = input(m, at, "image_radius"), taken.f_number = input(m, at, "f_number");
      const double v = random.uniform(0, 5), exposure = taken.exposure_s * taken.gain;
      if (m.id == "optics.veiling-glare") chain.mean_radiance[0] = input(m, at, "mean_of_picture") / exposure;
      expect_same(chain(v / exposure, 0, taken), m.act(v, at, p), m.id);
    }
  }
  EXPECT_GE(count, 6);
}

// A white plate that faces lamp and eye reads what the lamp is worth.
double plate(const PatchModel& model, double reads, double radius) {
  return model({0, 0, 1}, 1, {{0, 0, 1}, reads}, radius);
}

TEST(Bindings, StacksOfLightsSayWhatTheEquationSays) {
  Random random(9, 1);
  int count = 0;
  Stack stack;
  stack.channels = {"Y"};
  stack.full_scale = 1.7;
  for (const explain::stacks::LightBinding* binding : explain::stacks::all_light_bindings()) {
    const Mechanism& m = binding->mechanism();
    if (m.act == nullptr) continue;  // surfaces, directions
    ++count;
    for (int i = 0; i < draws; ++i) {
      Numbers at = inputs_of(m, random), p = amounts_of(m, random), numbers = p;
      PatchModel model{.eye = {0, 0, 1}};
      PatchLight light{{0, 0, 1}, 1};
      const double v = random.uniform(0.1, 5);
      if (m.id == "sensor.non-linearity") {
        for (std::size_t k = 5; k < p.size(); ++k) p[k] = m.parameters[k].neutral;
        p[1] = stack.full_scale;
        numbers = {p[2], p[0], p[3], p[4]};
      }
      if (m.id == "light.ambient") at = {v, 0}, numbers = {p[0]};  // over what the lamp gives a facing plate
      if (binding->set != nullptr) binding->set(numbers, stack, model);
      if (binding->aim != nullptr) {
        binding->aim(numbers, 0, {0, 0, -at[0]}, light);
        expect_same(v * light.white, m.act(v, at, p), m.id);
      } else {
        expect_same(plate(model, v, m.id == "optics.vignetting" ? at[0] : 0), m.act(v, at, p), m.id);
      }
    }
  }
  EXPECT_GE(count, 5);
}

}  // namespace
}  // namespace gonio::mechanism
