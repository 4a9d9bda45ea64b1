// Fits of the recorded reflectances: prove-reflectance fits. Prints every candidate of every recording with its errors,
// and which is chosen.
#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>

#include "base/error.h"
#include "data.h"
#include "fit/recorded.h"
#include "goniometry/fit.h"

namespace gonio {
namespace {

using goniometry::Fit;
using goniometry::FitOptions;
using goniometry::Fits;

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void print(const char* title, const goniometry::Samples& samples, const FitOptions& options) {
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
}

int fits_of_recordings(int argc, char** argv) {
  FitOptions options, decades;
  for (int i = 2; i < argc; ++i) options.models.emplace_back(argv[i]);
  decades = options;
  decades.scale = goniometry::Scale::log10;
  for (const char* name : {"garnet_red", "krylon_blue", "acryl_blue"})
    print(name, tests::cornell(tests::data("brdf/cornell") / (std::string(name) + ".brdf"), {550, 450, 650}), options);
  print("starlink chassis", tests::scans(tests::data("brdf/starlink-lab/chassis_brdf.csv")), decades);
  print("merl aluminium", tests::scans(tests::data("brdf/merl-aluminium-slices/aluminum_brdf.csv")), decades);
  return 0;
}

}  // namespace
}  // namespace gonio

int main(int argc, char** argv) {
  try {
    if (argc > 1 && std::strcmp(argv[1], "fits") == 0) return gonio::fits_of_recordings(argc, argv);
    std::fprintf(stderr, "usage: prove-reflectance fits [MODEL...]\n");
    return 64;
  } catch (const gonio::Error& e) {
    std::fprintf(stderr, "prove-reflectance: %s\n", e.what());
    return static_cast<int>(e.code());
  }
}
