// align() on simulated photographs: eight solids of genus 0 to 5, 1 to 4 views, 1 to 4 lamps, masks that err by 0.3 px
// with 2 % of their rims spoiled. How often it converges, from near and from nothing, what its intervals cover, whether
// it says what looks alike, and whether it knows when it is wrong.
//
//   prove-align SCENES SEED near|nothing
//
// A scene has converged where it is within a degree and 3 mm of the truth, or, of solids that look alike from several
// sides, where the rims fit. "Wrong" is beyond three standard deviations in some number and beyond that limit.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "alignment/align_bodies.h"
#include "alignment/alignment_world.h"
#include "base/error.h"
#include "base/parallel.h"

using namespace gonio;
using namespace gonio::alignment;
using gonio::alignment::testing::Miss;
using gonio::alignment::testing::miss_of;
using gonio::alignment::testing::solids;
using gonio::alignment::testing::World;
using gonio::alignment::testing::world_of;
using gonio::alignment::testing::WorldWish;

namespace {

struct Outcome {
  bool symmetric = false, said_alike = false, converged = false, found = false;
  std::vector<double> z;
  std::string line;
};

Outcome outcome_of(const WorldWish& wish) {
  World world = world_of(wish);
  const auto& solid = solids()[wish.solid];
  Outcome o{.symmetric = solid.symmetric};
  AlignWish how;
  how.from = wish.from_nothing ? AlignWish::From::nothing : AlignWish::From::stated;
  Aligned a;
  try {
    a = align_bodies(world.input, how).front();
  } catch (const Error& error) {
    o.line = error.what();
    return o;
  }
  const Miss miss = miss_of(world, a.fitted);
  o.said_alike = !a.symmetries.empty() || !a.open.empty();
  o.found = a.verdict == Verdict::found;
  o.converged = solid.symmetric ? a.fitted.explained > 0.9 : miss.turn_rad < 0.0175 && miss.shift_m < 0.003;
  for (std::size_t i = 0; i < miss.error.size(); ++i) o.z.push_back(miss.error[i] / miss.sigma[i]);
  char text[300];
  std::snprintf(text, sizeof text,
                "%s, %d views, %d lamps: %s, turn %.4f rad, shift %.2f mm, %.1f %% seen, sigma %.2f px; %s",
                solid.name.c_str(), wish.views, wish.lamps, word_of(a.verdict).c_str(), miss.turn_rad,
                1e3 * miss.shift_m, 100 * a.fitted.explained, a.fitted.sigma_px, a.why.c_str());
  o.line = text;
  return o;
}

}  // namespace

int main(int argc, char** argv) {
  const int scenes = argc > 1 ? std::atoi(argv[1]) : 32;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  const bool nothing = argc > 3 && std::string(argv[3]) == "nothing";
  std::vector<Outcome> all(static_cast<std::size_t>(scenes));
  parallel_for(0, all.size(), [&](std::size_t k) {
    all[k] = outcome_of({.solid = k % 8,
                         .views = 1 + static_cast<int>(k / 8 % 4),
                         .lamps = 1 + static_cast<int>(k / 32 % 4),
                         .seed = 1000 * seed + k,
                         .from_nothing = nothing});
  });
  double told = 0, alike = 0, plain = 0, converged = 0, inside = 0, numbers = 0, squares = 0, wrong = 0, known = 0,
         doubted = 0;
  for (const Outcome& o : all) {
    if (o.symmetric) alike += 1, told += o.said_alike;
    if (!o.converged || (!o.symmetric && !o.found)) std::printf("  %s\n", o.line.c_str());
    if (o.symmetric) continue;
    plain += 1, converged += o.converged;
    const bool far = std::any_of(o.z.begin(), o.z.end(), [](double z) { return !(std::abs(z) < 3); });
    if (!o.converged && (far || o.z.empty())) wrong += 1, known += !o.found;
    if (!o.converged) continue;
    doubted += !o.found;
    for (const double z : o.z) inside += std::abs(z) < 1.96, numbers += 1, squares += z * z;
  }
  const auto percent = [](double a, double b) { return b > 0 ? 100 * a / b : 100.0; };
  std::printf("%s, seed %d: measured %.1f %% converged of %.0f (required %d)\n",
              nothing ? "from nothing" : "from 5 degrees and 10 mm", static_cast<int>(seed), percent(converged, plain),
              plain, nothing ? 90 : 95);
  std::printf("95 %% intervals: measured %.1f %% of %.0f numbers inside (required 93 to 97); root mean square z %.2f\n",
              percent(inside, numbers), numbers, std::sqrt(squares / std::max(1.0, numbers)));
  std::printf("looking alike: measured %.1f %% said of %.0f (required 100)\n", percent(told, alike), alike);
  std::printf("wrong: measured %.1f %% known of %.0f (required 95); right ones that were doubted: %.0f\n",
              percent(known, wrong), wrong, doubted);
  return 0;
}
