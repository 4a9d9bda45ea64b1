// scripts/proofs/explain-practice: the six practice recordings (Cycles, 512 samples a pixel, camera noise) and what was
// left out of each, named here and nowhere else. Prints a table: id | parameter | recorder's value | ours | ratio |
// located | held out before and after, then the sentences, every claim and where the time went.
//
// The recorder's units. Its radius r of random walks is a diffuse mean free path only for its own inversion of the
// albedo (Cycles 3.4, kernel/closure/bssrdf.h): walks have the mean free path r sqrt(3 (1 - a')), a' the dipole's for a
// body of index 1.4 (Jensen et al. 2001, equation 15 for the albedo, 4/3 A from Fdr), but the scattering albedo of a
// body without an interface. scripts/proofs/cycles-subsurface renders shadow edges and holds the walks of that free
// path against them. Here our diffuse mean free path goes the same way back, at the albedo that was fitted with it.
// Ambient light is stated over the lamps' intensity, as the scale of these images is arbitrary; a lamp of P watts has P
// / (4 pi) W/sr, and with 3 W, the only round power that fits, the recorder's radiances come out.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "explain/engine.h"
#include "explain/images/images_problem.h"
#include "manifest/document.h"
#include "relighting/body_walks.h"

namespace gonio::prove {
namespace {

using namespace gonio::explain;
using images::ImagesProblem;

struct Result {
  const ImagesProblem& problem;
  const Explanation& e;
  double value(const std::string& parameter) const {
    for (std::size_t i = 0; i < problem.parameters().size(); ++i)
      if (problem.parameters()[i].name == parameter) return e.values[i];
    return std::nan("");
  }
};

// Diffuse reflectance of a half space of index 1.4 by the dipole.
double dipole_albedo(double alpha) {
  const double inverse = 1 / 1.4, fdr = inverse * (-1.44 * inverse + 0.71) + 0.668 + 0.0636 * 1.4;
  const double root = std::sqrt(3 * (1 - alpha)), a = 4.0 / 3 * (1 + fdr) / (1 - fdr);
  return alpha / 2 * (1 + std::exp(-a * root)) * std::exp(-root);
}
double recorder_radius(double path_m, double albedo) {
  double lower = 0, upper = 1;
  for (int k = 0; k < 60; ++k) (dipole_albedo((lower + upper) / 2) < albedo ? lower : upper) = (lower + upper) / 2;
  return path_m * std::sqrt((1 - images::scattering_albedo(albedo)) / (1 - lower));
}

struct Claim {
  const char* what;
  double truth, factor;  // the ratio must lie within this factor of one
  std::function<double(const Result&)> ours;
};
struct Practice {
  const char* name;
  const char* effect;  // nullptr: nothing was left out
  std::vector<Claim> claims;
  double repaired;  // share of the held-out error beyond the noise, at least
};

Claim path(const char* what, double truth, const std::string& colour) {
  const auto ours = [colour](const Result& r) {
    return recorder_radius(r.value("surface.subsurface@bunny.mean_free_path_" + colour + "_m"),
                           r.value("surfaces/bunny/albedo/" + colour));
  };
  return {what, truth, 1.5, ours};
}
Claim ambient(const char* what, double truth, const std::string& colour) {
  const auto ours = [colour](const Result& r) {
    return r.value("light.ambient.radiance_" + colour) / r.value("intensity/" + colour) * 3 / (4 * pi);
  };
  return {what, truth, 1.15, ours};
}
Claim plain(const char* what, double truth, const std::string& parameter) {
  const auto ours = [parameter](const Result& r) { return r.value(parameter); };
  return {what, truth, 1.15, ours};
}

const std::vector<Practice> practices{
    {"practice-1", nullptr, {}, 0},
    {"practice-2",
     "surface.interface",
     {plain("roughness alpha", 0.1024, "surface.interface@bunny.alpha"),
      plain("F0 of index 1.5", 0.04, "surface.interface@bunny.f0")},
     0.7},
    {"practice-3",
     "surface.subsurface",
     {path("radius, red, m", 0.012, "r"), path("radius, green, m", 0.005, "g"), path("radius, blue, m", 0.003, "b")},
     0.7},
    {"practice-4",
     "light.ambient",
     {ambient("radiance at 3 W, red", 0.050, "r"), ambient("radiance at 3 W, green", 0.050, "g"),
      ambient("radiance at 3 W, blue", 0.055, "b")},
     0.9},
    {"practice-5", "light.finite-size", {plain("radius, m", 0.035, "light.finite-size.radius_m")}, 0.7},
    {"practice-6", "optics.vignetting", {plain("falloff", 0.22, "optics.vignetting.falloff")}, 0.9}};

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

std::string located(const Explanation& e) {
  if (e.conditions.empty()) return "nowhere";
  char range[64];
  std::snprintf(range, sizeof range, " %.3g to %.3g", e.conditions[0].lower, e.conditions[0].upper);
  return e.conditions[0].name + range + " " + e.conditions[0].unit;
}

void print_rows(const Practice& practice, const Result& result, const std::string& first) {
  const Explanation& e = result.e;
  std::printf("| id | parameter | recorder | ours | ratio | located | held out before | after |\n");
  if (practice.claims.empty() || first != practice.effect)
    std::printf("| %s | - | - | - | - | %s | %.4f | %.4f |\n", first.empty() ? "nothing" : first.c_str(),
                e.named.empty() ? "nowhere" : located(e).c_str(), e.held_out_before, e.held_out_after);
  else
    for (const Claim& c : practice.claims) {
      const double ours = c.ours(result);
      std::printf("| %s | %s | %.4g | %.4g | %.2f | %s | %.4f | %.4f |\n", first.c_str(), c.what, c.truth, ours,
                  ours / c.truth, located(e).c_str(), e.held_out_before, e.held_out_after);
    }
}

bool judge(const Practice& practice, const ImagesProblem& problem, const Explanation& e) {
  const std::string first = e.named.empty() ? "" : problem.candidates()[e.named[0]].id();
  const Result result{problem, e};
  print_rows(practice, result, first);
  bool good = true;
  if (!practice.effect)
    return hold(practice.name, "effects named", static_cast<double>(e.named.size()), "0", e.named.empty());
  good &= hold(practice.name, std::string(practice.effect) + " named first", first == practice.effect, "1",
               first == practice.effect);
  if (first != practice.effect) return false;
  for (const Claim& c : practice.claims) {
    const double ratio = c.ours(result) / c.truth;
    char range[64];
    std::snprintf(range, sizeof range, "%.3g to %.3g", 1 / c.factor, c.factor);
    good &=
        hold(practice.name, std::string(c.what) + ", ratio", ratio, range, ratio >= 1 / c.factor && ratio <= c.factor);
  }
  const double repaired =
      (e.held_out_before - e.held_out_after) / (e.held_out_before - floor_of(problem.observations()));
  char least[16];
  std::snprintf(least, sizeof least, ">= %.2g", practice.repaired);
  good &= hold(practice.name, "repaired on held-out images", repaired, least, repaired >= practice.repaired);
  return good;
}

bool run(const Practice& practice, const std::string& root) {
  const auto start = std::chrono::steady_clock::now();
  const ImagesProblem problem(
      manifest::read_document(std::filesystem::path(root) / "recordings" / (std::string(practice.name) + ".json")));
  const double cached_s = seconds(start);
  explain::Options options;
  if (const char* only = std::getenv("GONIO_HYPOTHESES")) {
    std::istringstream words(only);
    for (std::string word; words >> word;) options.hypotheses.push_back(word);
  }
  const Explanation e = explain::explain(problem, options);
  const double done_s = seconds(start);
  const bool good = judge(practice, problem, e);
  std::printf("%s: %s\n", practice.name, e.sentence.c_str());
  for (const Estimate& x : e.estimates)
    std::printf("  %s = %.5g +- %.2g\n", problem.parameters()[x.parameter].name.c_str(), x.value, x.sigma);
  std::printf("  %zu candidates; cache and terms %.1f s, engine %.1f s\n\n", problem.candidates().size(), cached_s,
              done_s - cached_s);
  if (std::getenv("GONIO_SCOREBOARD"))
    for (const explain::Hypothesis& h : e.scoreboard)
      std::printf("    %-60s held out %.5g gain %.4g +- %.2g effect %.4g %s\n", h.name.c_str(), h.held_out, h.gain,
                  h.gain_sigma, h.effect, h.refused.c_str());
  std::fflush(stdout);
  return good;
}

}  // namespace
}  // namespace gonio::prove

int main(int count, char** names) {
  const char* root = std::getenv("GONIO_DATA");
  if (!root) {
    std::fprintf(stderr, "prove-practice: GONIO_DATA: is not set: name the folder of recorded data\n");
    return 66;
  }
  bool good = true;
  for (const auto& practice : gonio::prove::practices) {
    bool wanted = count < 2;
    for (int i = 1; i < count; ++i) wanted = wanted || practice.name == std::string(names[i]);
    if (wanted) good &= gonio::prove::run(practice, root);
  }
  return good ? 0 : 1;
}
