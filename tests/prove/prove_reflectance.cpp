// Fits of reflectance.
//   prove-reflectance fits [MODEL...]         the recordings: every candidate with its errors, and which is chosen
//   prove-reflectance coverage REPETITIONS [NAME]   known surfaces, or those whose name begins so: how often intervals
//                                             hold the truth
#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>

#include "base/error.h"
#include "data.h"
#include "goniometry/fit/fit.h"
#include "goniometry/fit/recorded.h"
#include "goniometry/fit/study.h"

namespace gonio {
namespace {

using goniometry::Fit;
using goniometry::FitOptions;
using goniometry::Fits;

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The least error of any candidate, and the chosen one's held-out error over its fitted one.
bool claim(const char* title, const Fits& fits, double required, bool decades) {
  double least = 1e9;
  for (const Fit& f : fits.candidates) least = std::min(least, decades ? f.fitted.decades : f.band_log1p[0]);
  const Fit& chosen = fits.candidates.at(fits.chosen);
  const double ratio = chosen.held_out.scaled / chosen.fitted.scaled;
  std::printf("%s: measured %.4f %s required %.4f; held out over fitted measured %.3f required 1.15\n", title, least,
              decades ? "decades" : "of log(1 + 100 f cos cos) at 550 nm", required, ratio);
  return least <= required && ratio <= 1.15;
}

Fits print(const char* title, const goniometry::Samples& samples, const FitOptions& options) {
  const double begun = seconds();
  const Fits fits = goniometry::fit_surfaces(samples, options);
  std::printf("\n%s: %zu directions, %zu bands, least alpha %.4f, %.1f s\n", title, samples.rows(), samples.bands(),
              fits.least_alpha, seconds() - begun);
  std::printf("  %-52s %8s %8s %8s %8s %8s %7s %9s\n", "model", "fitted", "held out", "log1p", "held out", "decades",
              "energy", "excess");
  for (std::size_t k = 0; k < fits.candidates.size(); ++k) {
    const Fit& f = fits.candidates[k];
    std::printf("%c %-52s %8.4f %8.4f %8.4f %8.4f %8.4f %7.3f %9.2g +- %.1g\n", k == fits.chosen ? '*' : ' ',
                (f.model->info().id + " " + f.variant).c_str(), f.fitted.scaled, f.held_out.scaled, f.fitted.log1p,
                f.held_out.log1p, f.fitted.decades, f.energy, f.held_out_excess, f.held_out_excess_sigma);
    if (k != fits.chosen && k > 2) continue;
    for (const auto& n : f.numbers)
      if (n.band == goniometry::whole_sample || n.band == 0)
        std::printf("      %s %.4g +- %.2g%s\n", n.name.c_str(), n.value, n.sigma,
                    n.at == goniometry::FittedNumber::At::inside ? "" : " (at a bound)");
  }
  for (const auto& r : fits.refusals)
    std::printf("  refused: %s %s: %s\n", r.model.c_str(), r.variant.c_str(), r.reason.c_str());
  std::fflush(stdout);
  return fits;
}

int fits_of_recordings(int argc, char** argv) {
  FitOptions options, decades;
  for (int i = 2; i < argc; ++i) options.models.emplace_back(argv[i]);
  decades = options;
  decades.scale = goniometry::Scale::log10;
  bool met = true;
  const auto paint = [](const char* name) {
    return tests::cornell(tests::data("brdf/cornell") / (std::string(name) + ".brdf"), {550, 450, 650}, pi / 2);
  };
  met = claim("garnet_red", print("garnet_red", paint("garnet_red"), options), 0.0755, false) && met;
  met = claim("krylon_blue", print("krylon_blue", paint("krylon_blue"), options), 0.0745, false) && met;
  print("acryl_blue", paint("acryl_blue"), options);
  const auto chassis = tests::scans(tests::data("brdf/starlink-lab/chassis_brdf.csv"));
  met = claim("starlink chassis", print("starlink chassis", chassis, decades), 0.26, true) && met;
  const auto metal = tests::scans(tests::data("brdf/merl-aluminium-slices/aluminum_brdf.csv"));
  met = claim("merl aluminium", print("merl aluminium", metal, decades), 0.31, true) && met;
  return met ? 0 : 1;
}

const Rgb none{};
Rgb all(double x) {
  return {x, x, x};
}
const tests::Truth truths[] = {
    {"coated-diffuse",
     "",
     {{"albedo", {0.5, 0.3, 0.1}}, {"sigma_rad", none}, {"f0", all(0.045)}, {"alpha", all(0.15)}}},
    {"diffuse", "rough base", {{"albedo", {0.6, 0.4, 0.2}}, {"sigma_rad", all(0.4)}}},
    {"glossy",
     "two lobes",
     {{"albedo", {0.3, 0.2, 0.1}},
      {"sigma_rad", none},
      {"f0", all(0.06)},
      {"alpha", all(0.08)},
      {"second_share", all(0.4)},
      {"second_alpha", all(0.35)}}},
    {"metal", "", {{"f0", {0.9, 0.6, 0.3}}, {"alpha", all(0.25)}}},
    {"metal",
     "anisotropic",
     {{"f0", {0.9, 0.6, 0.3}}, {"alpha", all(0.3)}, {"anisotropy", all(0.5)}, {"azimuth_rad", all(0.6)}}},
    {"glossy",
     "anisotropic",
     {{"albedo", {0.3, 0.2, 0.1}},
      {"f0", all(0.06)},
      {"alpha", all(0.2)},
      {"anisotropy_0", all(0.1)},
      {"anisotropy_45", all(0.05)}}},
    {"interfaced-diffuse", "", {{"albedo", {0.8, 0.5, 0.2}}, {"eta", all(1.5)}, {"alpha", all(0.12)}}},
};

// Every truth at 1 % and 3 % of noise, stated and not: the share of 95 % intervals that hold the truth.
int coverage_of_truths(int repetitions, const std::string& named) {
  bool honest = true;
  std::printf("%-32s %5s %-9s %s\n", "truth", "noise", "scale", "share of intervals that hold the truth");
  for (const tests::Truth& truth : truths) {
    if (!(truth.model + " " + truth.variant).starts_with(named)) continue;
    for (const double noise : {0.01, 0.03})
      for (const auto scale : {goniometry::Scale::noise, goniometry::Scale::log1p}) {
        const bool stated = scale == goniometry::Scale::noise;
        const auto cover = tests::coverage(truth, repetitions, 30, noise, 5e-4, stated, scale, 1);
        std::printf("%-32s %4.0f%% %-9s", (truth.model + " " + truth.variant).c_str(), 100 * noise,
                    stated ? "stated" : "log1p");
        for (const auto& [name, c] : cover) {
          std::printf(" %s %.3f", name.empty() ? "all" : name.c_str(), c.share());
          if (c.lost > 0) std::printf(" (%d at a bound)", c.lost);
          // Of n looks an honest share leaves these bounds by three of its standard deviations once in 700 times.
          const double spread = 3 * std::sqrt(0.95 * 0.05 / std::max(1, c.looks));
          if (c.looks > 0 && (c.share() < 0.90 - spread || c.share() > 0.98 + spread)) honest = false, std::printf("!");
        }
        std::printf("\n");
        std::fflush(stdout);
      }
  }
  return honest ? 0 : 1;
}

}  // namespace
}  // namespace gonio

int main(int argc, char** argv) {
  try {
    if (argc > 1 && std::strcmp(argv[1], "fits") == 0) return gonio::fits_of_recordings(argc, argv);
    if ((argc == 3 || argc == 4) && std::strcmp(argv[1], "coverage") == 0)
      return gonio::coverage_of_truths(std::stoi(argv[2]), argc == 4 ? argv[3] : "");
    std::fprintf(stderr, "usage: prove-reflectance fits [MODEL...] | coverage REPETITIONS [NAME]\n");
    return 64;
  } catch (const gonio::Error& e) {
    std::fprintf(stderr, "prove-reflectance: %s\n", e.what());
    return static_cast<int>(e.code());
  }
}
