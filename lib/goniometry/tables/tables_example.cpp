// A table to try the program on: a coated paint as a goniometer would measure it.
#include <cmath>

#include "base/random.h"
#include "base/text.h"
#include "goniometry/tables/tables.h"
#include "surface/surface.h"

namespace gonio::goniometry {
namespace {

constexpr double relative_noise = 0.02, floor_noise = 2e-4;

Vec3 direction(double theta, double phi) {
  const double t = theta * pi / 180, p = phi * pi / 180;
  return {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
}

}  // namespace

std::string example_table(std::uint64_t seed) {
  const surface::Model& model = *surface::find("coated-diffuse");
  const surface::Values values = surface::values_of(
      model, {{"albedo", std::vector<double>{0.42, 0.08, 0.06}}, {"f0", 0.05}, {"alpha", 0.18}}, "example");
  Random random(seed);
  std::string out = "theta_i [deg],phi_i [deg],theta_o [deg],phi_o [deg],r,g,b,sigma_r,sigma_g,sigma_b\n";
  for (const double theta_i : {10.0, 30.0, 50.0, 65.0})
    for (const double phi_o : {0.0, 90.0, 150.0, 165.0, 180.0})
      for (double theta_o = 5; theta_o <= 80; theta_o += 5) {
        const Rgb f = model.evaluate(values, direction(theta_o, phi_o), direction(theta_i, 0));
        out += format("%g,0,%g,%g", theta_i, theta_o, phi_o);
        std::string sigmas;
        for (int c = 0; c < 3; ++c) {
          const double sigma = std::hypot(relative_noise * f[c], floor_noise);
          out += format(",%.6g", f[c] + sigma * random.normal());
          sigmas += format(",%.3g", sigma);
        }
        out += sigmas + "\n";
      }
  return out;
}

}  // namespace gonio::goniometry
