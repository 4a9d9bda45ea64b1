// align() on simulated photographs: eight solids of genus 0 to 5, 1 to 4 views, 1 to 4 lamps, masks that err by 0.3 px
// with 2 % of their rims spoiled. How often it converges, from near and from nothing, what its intervals cover, whether
// it says what looks alike, and whether it knows when it is wrong.
//
//   prove-align SCENES SEED near|nothing|wrong
//
// `wrong`: so many scenes of each kind of broken assumption (broken_world.h), from near: a table of how often the
// answer is beyond three standard deviations in some number, and how often that was said (any word but `found`).
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
#include "alignment/broken_world.h"
#include "alignment/rim_waves.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"

using namespace gonio;
using namespace gonio::alignment;
using gonio::alignment::testing::Breakage;
using gonio::alignment::testing::breakages;
using gonio::alignment::testing::broken_world;
using gonio::alignment::testing::Miss;
using gonio::alignment::testing::miss_of;
using gonio::alignment::testing::name_of;
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
                "%s, %d views, %d lamps: %s, turn %.4f rad, shift %.2f mm, %.1f %% seen, sigma %.2f px, alike %.0f, "
                "waves %.3f; %s",
                solid.name.c_str(), wish.views, wish.lamps, word_of(a.verdict).c_str(), miss.turn_rad,
                1e3 * miss.shift_m, 100 * a.fitted.explained, a.fitted.sigma_px, a.fitted.correlation_px,
                rim_waves(world.input.question, a.fitted, 0).rms_px, a.why.c_str());
  o.line = text;
  return o;
}

struct Broken {
  bool wrong = false, said = false;
  std::string line;
};

Broken broken_outcome(Breakage breakage, std::size_t number, std::uint64_t seed) {
  World world = broken_world(breakage, number, seed);
  AlignWish how;
  how.from = AlignWish::From::stated;
  if (breakage == Breakage::lamp) how.lamps_known = true;
  Broken o;
  try {
    const Aligned a = align_bodies(world.input, how).front();
    const Miss miss = miss_of(world, a.fitted);
    double worst = 0;
    for (std::size_t i = 0; i < miss.error.size(); ++i) {
      const double z = std::abs(miss.error[i]) / miss.sigma[i];
      worst = z <= worst ? worst : z;
    }
    o.wrong = !(worst < 3), o.said = a.verdict != Verdict::found;
    o.line = format(
        "%zu views, %zu lamps: %s, largest z %.1f, turn %.4f rad, shift %.2f mm, sigma %.2f px, alike over "
        "%.0f px, waves %.3f; %s",
        world.truth.stations.size(), world.truth.lamps_m.size(), word_of(a.verdict).c_str(), worst, miss.turn_rad,
        1e3 * miss.shift_m, a.fitted.sigma_px, a.fitted.correlation_px,
        rim_waves(world.input.question, a.fitted, 0).rms_px, a.why.c_str());
  } catch (const Error& error) {
    o.wrong = o.said = true, o.line = error.what();
  }
  return o;
}

int prove_wrong(std::size_t scenes, std::uint64_t seed) {
  const auto& kinds = breakages();
  std::vector<Broken> all(kinds.size() * scenes);
  parallel_for(0, all.size(),
               [&](std::size_t k) { all[k] = broken_outcome(kinds[k / scenes], k % scenes, 100000 * seed + k); });
  std::size_t wrong_of_all = 0, said_of_all = 0;
  std::string table =
      "| broken | scenes | wrong | of these said | right, but doubted |\n| --- | --- | --- | --- | --- |\n";
  for (std::size_t b = 0; b < kinds.size(); ++b) {
    std::size_t wrong = 0, said = 0, doubted = 0;
    for (std::size_t k = b * scenes; k < (b + 1) * scenes; ++k) {
      const Broken& o = all[k];
      wrong += o.wrong, said += o.wrong && o.said, doubted += !o.wrong && o.said;
      if (o.wrong && !o.said) std::printf("  not said: %s: %s\n", name_of(kinds[b]).c_str(), o.line.c_str());
    }
    wrong_of_all += wrong, said_of_all += said;
    table += format("| %s | %zu | %zu | %zu | %zu |\n", name_of(kinds[b]).c_str(), scenes, wrong, said, doubted);
  }
  std::printf("%s", table.c_str());
  std::printf(
      "broken assumptions, seed %d: measured %.1f %% of %zu wrong answers said (required 95)\n", static_cast<int>(seed),
      100.0 * static_cast<double>(said_of_all) / std::max<double>(1, static_cast<double>(wrong_of_all)), wrong_of_all);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const int scenes = argc > 1 ? std::atoi(argv[1]) : 32;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  const bool nothing = argc > 3 && std::string(argv[3]) == "nothing";
  if (argc > 3 && std::string(argv[3]) == "wrong") return prove_wrong(static_cast<std::size_t>(scenes), seed);
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
