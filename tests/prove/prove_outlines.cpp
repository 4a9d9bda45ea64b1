// explain on the rims of simulated photographs: what was left out of the aligned model is named, with its size, and
// where nothing was left out nothing is.
//
//   prove-outlines SEEDS FIRST
//
// Eight solids, 2 or 3 views, 1 or 2 lamps, masks with errors of 0.15 px and 1 % outliers. The world's masks are filled
// by a raster of its own, which shares projections alone with the library.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>

#include "explain/outlines/believed_rims.h"
#include "inference/explanation.h"
#include "scene/mechanisms/bend.h"

using namespace gonio;
using namespace gonio::explain;
using alignment::Setting;
using alignment::testing::World;
using alignment::testing::WorldWish;

namespace {

struct Tally {
  int asked = 0, first = 0, listed = 0, alone_and_wrong = 0, numbers = 0, covered = 0;
};

struct Case {
  std::string effect;                   // id; empty: nothing was left out
  std::map<std::string, double> truth;  // values by parameter name
};

Explanation explained(const Problem& problem) {
  Options options;
  options.negative_controls = 12;
  return explain::explain(problem, options);
}

void judge(const Case& c, const Problem& problem, const Explanation& e, Tally& tally) {
  ++tally.asked;
  const auto id = [&](std::size_t n) { return problem.candidates()[n].id(); };
  const bool first = c.effect.empty() ? e.named.empty() : !e.named.empty() && id(e.named[0]) == c.effect;
  bool listed = first;
  for (const auto& set : {e.not_told_apart, e.instead})
    for (const auto& group : set)
      for (const std::size_t n : group) listed |= id(n) == c.effect;
  tally.first += first, tally.listed += listed;
  tally.alone_and_wrong += e.verdict == inference::Verdict::named && !first;
  if (!first) {
    std::printf("    %s: %s\n", c.effect.empty() ? "nothing" : c.effect.c_str(), e.sentence.c_str());
    return;
  }
  for (const Estimate& x : e.estimates) {
    const auto truth = c.truth.find(problem.parameters()[x.parameter].name);
    if (truth == c.truth.end()) continue;
    ++tally.numbers, tally.covered += truth->second >= x.lower_95 && truth->second <= x.upper_95;
  }
}

// Effects of usual size, drawn.
void ask(std::size_t effect, const WorldWish& base, std::mt19937_64& random, Tally& tally) {
  std::normal_distribution<double> normal;
  WorldWish wish = base;
  if (effect == 1) wish.scale_sigma = 0.03;
  World world = alignment::testing::world_of(wish);
  Case c;
  std::function<void(Setting&)> wrong = [](Setting&) {};
  if (effect == 1) {
    const Vec3 s = world.truth.bodies[0].scale;
    c = {"geometry.shrinkage",
         {{"geometry.shrinkage.shrink_x", 1 - s.x},
          {"geometry.shrinkage.shrink_y", 1 - s.y},
          {"geometry.shrinkage.shrink_z", 1 - s.z}}};
    wrong = [](Setting& setting) { setting.bodies[0].scale = {1, 1, 1}; };
  } else if (effect == 2) {
    const std::array<double, 3> curl{(normal(random) > 0 ? 1 : -1) * (0.8 + 0.3 * std::abs(normal(random))),
                                     0.6 * normal(random), 0.4 * normal(random)};
    c = {"geometry.bend",
         {{"geometry.bend.curl_x_per_m", curl[0]},
          {"geometry.bend.curl_y_per_m", curl[1]},
          {"geometry.bend.twist_per_m", curl[2]}}};
    const alignment::testing::Solid& solid = alignment::testing::solids()[wish.solid];
    alignment::Shape& shape = world.input.shapes[0];
    const Vec3 middle = shape.centre_m();
    std::vector<Vec3> straight = solid.positions_m;
    for (Vec3& p : straight) p.z -= equation::bend_height_m(p.x - middle.x, p.y - middle.y, curl);
    shape = alignment::Shape(std::move(straight), solid.triangles);
  } else if (effect == 3) {
    const Vec3 shift{0.01 * normal(random), 0.01 * normal(random), 0.01 * normal(random)};
    c.effect = "light.position";
    c.truth = {{"lamp-0/shift_x_m", -shift.x}, {"lamp-0/shift_y_m", -shift.y}, {"lamp-0/shift_z_m", -shift.z}};
    wrong = [=](Setting& setting) { setting.lamps_m[0] += shift; };
  }
  const auto problem = outlines_problem(tests::believed(world, wrong, effect == 3));
  judge(c, *problem, explained(*problem), tally);
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 1, from = argc > 2 ? std::atoi(argv[2]) : 1;
  const char* names[] = {"nothing left out", "geometry.shrinkage", "geometry.bend", "light.position"};
  std::array<Tally, 4> tallies;
  for (int seed = from; seed < from + seeds; ++seed)
    for (std::size_t solid = 0; solid < 8; ++solid)
      for (std::size_t effect = 0; effect < 4; ++effect) {
        std::mt19937_64 random(static_cast<std::uint64_t>(1000 * seed) + 10 * solid + effect);
        const WorldWish wish{.solid = solid,
                             .views = 2 + static_cast<int>((solid + effect) % 2),
                             .lamps = 1 + static_cast<int>(solid % 2),
                             .seed = static_cast<std::uint64_t>(7000 * seed) + 10 * solid + effect,
                             .error_px = 0.15,
                             .outliers = 0.01};
        ask(effect, wish, random, tallies[effect]);
      }
  std::printf("%-20s %6s %12s %8s %16s %s\n", "left out", "worlds", "named first", "listed", "alone and wrong",
              "intervals of 95 %");
  for (std::size_t k = 0; k < tallies.size(); ++k) {
    const Tally& t = tallies[k];
    std::printf("%-20s %6d %12d %8d %16d %d of %d\n", names[k], t.asked, t.first, t.listed, t.alone_and_wrong,
                t.covered, t.numbers);
  }
}
