// scripts/proofs/brdf-ridges: goniometer images of plates of actual ridges, path traced from a mesh of prisms and
// recorded with noise, become samples; the analytic model is fitted to them. How far its ridge angle and azimuth are
// from the mesh's, over ridge angles, azimuths, roughnesses and two materials.
//
// All samples are fitted, light by way of walls among them. Intervals are 95 %: how often they cover is printed.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "base/error.h"
#include "goniometry/fit/fit.h"
#include "goniometry/recording/ridge_plate.h"

namespace {

using namespace gonio;
using namespace gonio::tests;

struct Worst {
  double angle_deg = 0, azimuth_deg = 0;
  int covered = 0, intervals = 0, plates = 0, refused = 0;
};

void take(const goniometry::FittedNumber& number, double truth_rad, double& worst_deg, Worst& all) {
  worst_deg = std::max(worst_deg, std::abs(number.value - truth_rad) / degree);
  all.covered += number.low <= truth_rad && truth_rad <= number.high;
  ++all.intervals;
}

void measure(const RidgePlate& plate, const char* material, std::uint64_t seed, const std::filesystem::path& folder,
             Worst& worst) {
  RidgeViews views;
  views.light_thetas_rad = {12 * degree, 32 * degree, 52 * degree};
  views.light_phis_rad = {0, pi / 2, pi};
  views.cameras = 24;
  std::filesystem::create_directories(folder);
  manifest::Document d = ridge_recording(plate, views, folder);
  record(d, render_all(d, 4), folder, seed);
  const goniometry::Reduced reduced = goniometry::reduce(d);
  const goniometry::Fits fits = goniometry::fit_surfaces(
      reduced.samples,
      {.models = {"ridged"}, .lobes = 1, .random_starts = 2, .seed = seed, .folds = 0, .check = false});
  std::filesystem::remove_all(folder);
  if (fits.candidates.empty()) {
    std::printf("  %s: no fit: %s\n", material, fits.refusals.empty() ? "" : fits.refusals.front().reason.c_str());
    ++worst.refused;
    return;
  }
  const goniometry::Fit& fit = fits.candidates.front();
  const auto* angle = fit.number("ridge_rad");
  const auto* azimuth = fit.number("azimuth_rad");
  std::printf(
      "  %-10s ridge %5.1f azimuth %6.1f alpha %.2f: %4zu rows, ridge %7.3f +- %.3f, azimuth %8.3f +- %.3f deg, "
      "alpha %.3f, model error %.3f\n",
      material, plate.ridge_rad / degree, plate.azimuth_rad / degree, plate.alpha, reduced.samples.rows(),
      angle->value / degree, angle->sigma / degree, azimuth->value / degree, azimuth->sigma / degree,
      fit.number("alpha_v") ? fit.number("alpha_v")->value : NAN, fit.model_error);
  std::fflush(stdout);
  take(*angle, plate.ridge_rad, worst.angle_deg, worst);
  take(*azimuth, plate.azimuth_rad, worst.azimuth_deg, worst);
  ++worst.plates;
}

bool claim(const char* what, double measured, double low, double high) {
  const bool met = measured >= low && measured <= high;
  std::printf("brdf-ridges %s: measured %.3g required %.3g to %.3g%s\n", what, measured, low, high,
              met ? "" : "  NOT MET");
  return met;
}

}  // namespace

int main(int argc, char** argv) try {
  const int repeats = argc > 1 ? std::max(1, std::atoi(argv[1])) : 2;
  const auto folder = std::filesystem::temp_directory_path() / ("gonio-ridges-" + std::to_string(::getpid()));
  Worst worst, metals;
  std::uint64_t seed = 0;
  for (const bool metal : {false, true})
    for (int repeat = 0; repeat < repeats; ++repeat)
      for (const double ridge : {5.0, 10.0, 15.0, 20.0})
        for (const double azimuth : {-70.0, 20.0, 37.0}) {
          RidgePlate plate{.ridge_rad = ridge * degree, .azimuth_rad = (azimuth + 11 * repeat) * degree};
          plate.alpha = repeat % 2 == 0 ? 0.2 : 0.15;
          if (metal) plate.eta = {0.6, 1.0, 1.4}, plate.k = {3.4, 2.6, 2.0};
          measure(plate, metal ? "metal" : "dielectric", ++seed, folder, metal ? metals : worst);
        }
  const auto print = [](const char* what, const Worst& w) {
    std::printf(
        "  %s: ridge angle off by up to %.2f, azimuth by up to %.2f degrees, %d of %d intervals cover, "
        "%d plates refused\n",
        what, w.angle_deg, w.azimuth_deg, w.covered, w.intervals, w.refused);
  };
  print("dielectrics", worst);
  print("metals", metals);
  bool met = true;
  for (const auto& [what, w] : {std::pair{"dielectrics", &worst}, std::pair{"metals", &metals}}) {
    const std::string of = std::string(" of ") + what;
    met &= claim(("plates fitted" + of).c_str(), w->plates, 12.0 * repeats, 12.0 * repeats);
    met &= claim(("ridge angle off by at most, degrees," + of).c_str(), w->angle_deg, 0, 0.5);
    met &= claim(("ridge azimuth off by at most, degrees," + of).c_str(), w->azimuth_deg, 0, 1);
  }
  return met ? 0 : 1;
} catch (const gonio::Error& error) {
  std::printf("brdf-ridges: %s\n", error.what());
  return 1;
}
