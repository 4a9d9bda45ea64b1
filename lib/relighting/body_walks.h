// Light that wanders within closed bodies before it leaves: random walks of the radiative transfer equation from where
// a facet is seen back to where the light entered. World frame, metres.
//
// Medium: isotropic scattering (similarity), free paths exponential with mean l_s = 1 / sigma_t', single-scattering
// albedo alpha, the same index inside as outside, a surface through which light passes diffusely either way (in the
// limit l_s = 0 the base model's Lambertian surface). A walk starts below the facet with a direction drawn by its
// cosine and ends where it crosses the surface, after n scatterings, at y:
//   E'(x) = sum over n of alpha^n S_n(x) / A,   S_n = mean over walks of E(y) [n scatterings]
// so that one table of S_n serves every albedo. A, the half space's albedo, fixes alpha (Chiang, Kulla & Burley 2016,
// "Practical and controllable subsurface scattering for production path tracing", equation 5):
//   alpha = 1 - exp(-5.09406 A + 2.61188 A^2 - 4.31805 A^3)
// and the diffuse mean free path l of the declaration, 1 / sqrt(3 sigma_a sigma_t'), fixes l_s = l sqrt(3 (1 - alpha)).
// Tables are made when asked for, on a grid of l_s in half octaves with the same random numbers, and interpolated
// smoothly in log l_s. Thin parts glow, ridges are brighter and creases darker: what no profile of a half space holds.
#pragma once
#include <array>
#include <cmath>
#include <memory>

#include "relighting/term.h"

namespace gonio::relighting {

inline double scattering_albedo(double albedo) {
  return 1 - std::exp(-5.09406 * albedo + 2.61188 * albedo * albedo - 4.31805 * albedo * albedo * albedo);
}

// True where every instance that bears the surface is a sphere or a mesh that encloses a volume, but for small holes.
bool are_bodies(const Setting& setting, std::size_t surface);

class BodyWalks {
 public:
  static constexpr std::size_t orders = 18;  // bins of n: 0 to 3 alone, then growing by 1.4
  // For one colour: what S_n is weighted with, and where l_s lies among the tables.
  struct Weights {
    std::array<double, orders> of_order{};  // alpha^n / A
    std::array<std::size_t, 4> tables{};    // around l_s, and their weights: Catmull & Rom 1974, no kinks for a fit
    std::array<double, 4> of_table{};
    double own_share = 0;  // l_s below all tables: of the facet's own light
  };

  // Of the facets that bear `surface`; `walks` of each facet for each table.
  BodyWalks(const Setting& setting, std::size_t surface, std::size_t walks);
  ~BodyWalks();

  // Makes the tables that these numbers ask for.
  Weights weights(double path_m, double albedo) const;
  // Irradiance from a small light of unit intensity after the walks; `own`: before.
  double spread(const Weights& weights, std::size_t view, std::size_t facet, std::size_t light, double own) const;

 private:
  struct Tables;
  std::unique_ptr<Tables> tables_;
};

}  // namespace gonio::relighting
