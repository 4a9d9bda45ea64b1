// scripts/proofs/explain-practice: the six practice recordings (Cycles, 512 samples a pixel, camera noise) and what was
// left out of each, named here and nowhere else. Prints one line a claim, the sentence, and where the time went.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "explain/engine.h"
#include "explain/images/images_problem.h"

namespace gonio::prove {
namespace {

using namespace gonio::explain;

struct Claim {
  std::size_t parameter;  // of the first named mechanism
  double value, least, most;
  const char* what;
};
struct Practice {
  const char* name;
  const char* effect;  // nullptr: nothing was left out
  std::vector<Claim> claims;
  double repaired;  // share of the held-out error beyond the noise, at least
};

const std::vector<Practice>& practices() {
  static const std::vector<Practice> all = {
      {"practice-1", nullptr, {}, 0},
      {"practice-2", "surface.interface", {{1, 0.1024, 0.1024 / 1.15, 0.1024 * 1.15, "roughness"}}, 0.7},
      {"practice-3",
       "surface.subsurface",
       {{0, 0.012, 0.012 / 1.5, 0.012 * 1.5, "free path, red"},
        {1, 0.005, 0.005 / 1.5, 0.005 * 1.5, "free path, green"},
        {2, 0.003, 0.003 / 1.5, 0.003 * 1.5, "free path, blue"}},
       0.7},
      {"practice-4",
       "light.ambient",
       {{0, 0.050, 0.050 * 0.85, 0.050 * 1.15, "radiance, red"},
        {2, 0.055, 0.055 * 0.85, 0.055 * 1.15, "radiance, blue"}},
       0.9},
      {"practice-5", "light.finite-size", {{0, 0.035, 0.035 * 0.85, 0.035 * 1.15, "radius"}}, 0.7},
      {"practice-6", "optics.vignetting", {{0, 0.22, 0.22 * 0.85, 0.22 * 1.15, "falloff"}}, 0.9}};
  return all;
}

double floor_of(const Observations& o) {
  double noise = 0, norm = 0;
  for (std::size_t i = 0; i < o.rows(); ++i) noise += o.sigma[i] * o.sigma[i], norm += o.norm[i];
  return std::sqrt(noise / norm);
}

double seconds(const std::chrono::steady_clock::time_point& from) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
}

bool hold(const char* name, const std::string& what, double measured, const std::string& required, bool met) {
  std::printf("%s: %s measured %.4g required %s%s\n", name, what.c_str(), measured, required.c_str(),
              met ? "" : "  MISSED");
  return met;
}

bool judge(const Practice& practice, const images::ImagesProblem& problem, const Explanation& e) {
  const std::string first = e.named.empty() ? "" : problem.candidates()[e.named[0]].id();
  bool good = true;
  if (!practice.effect)
    return hold(practice.name, "effects named", static_cast<double>(e.named.size()), "0", e.named.empty());
  good &= hold(practice.name, std::string(practice.effect) + " named first", first == practice.effect, "1",
               first == practice.effect);
  if (first != practice.effect) return false;
  for (const Claim& c : practice.claims) {
    const double v = e.estimates.at(c.parameter).value;
    char range[64];
    std::snprintf(range, sizeof range, "%.4g to %.4g (truth %.4g)", c.least, c.most, c.value);
    good &= hold(practice.name, c.what, v, range, v >= c.least && v <= c.most);
  }
  const double repaired =
      (e.held_out_before - e.held_out_after) / (e.held_out_before - floor_of(problem.observations()));
  good &= hold(practice.name, "repaired on held-out images", repaired, ">= " + std::to_string(practice.repaired),
               repaired >= practice.repaired);
  return good;
}

}  // namespace
}  // namespace gonio::prove

int main(int count, char** names) {
  using namespace gonio;
  const char* root = std::getenv("GONIO_DATA");
  if (!root) {
    std::fprintf(stderr, "prove-practice: GONIO_DATA: is not set: name the folder of recorded data\n");
    return 66;
  }
  bool good = true;
  for (const auto& practice : prove::practices()) {
    bool wanted = count < 2;
    for (int i = 1; i < count; ++i) wanted = wanted || practice.name == std::string(names[i]);
    if (!wanted) continue;
    const auto start = std::chrono::steady_clock::now();
    const explain::images::ImagesProblem problem(
        manifest::read_document(std::filesystem::path(root) / "recordings" / (std::string(practice.name) + ".json")));
    const double cached_s = prove::seconds(start);
    std::printf("%s: cache and terms %.1f s\n", practice.name, cached_s);
    std::fflush(stdout);
    explain::Options options;
    if (const char* only = std::getenv("GONIO_HYPOTHESES")) {
      std::istringstream words(only);
      for (std::string word; words >> word;) options.hypotheses.push_back(word);
    }
    const explain::Explanation e = explain::explain(problem, options);
    const double done_s = prove::seconds(start);
    good &= prove::judge(practice, problem, e);
    std::printf("%s: %s\n", practice.name, e.sentence.c_str());
    for (const explain::Estimate& x : e.estimates)
      std::printf("  %s = %.5g +- %.2g\n", problem.parameters()[x.parameter].name.c_str(), x.value, x.sigma);
    std::printf("  held out %.4g -> %.4g; %zu candidates; cache and terms %.1f s, engine %.1f s\n", e.held_out_before,
                e.held_out_after, problem.candidates().size(), cached_s, done_s - cached_s);
    if (std::getenv("GONIO_SCOREBOARD"))
      for (const explain::Hypothesis& h : e.scoreboard)
        std::printf("    %-60s held out %.5g gain %.4g +- %.2g effect %.4g %s\n", h.name.c_str(), h.held_out, h.gain,
                    h.gain_sigma, h.effect, h.refused.c_str());
    std::fflush(stdout);
  }
  return good ? 0 : 1;
}
