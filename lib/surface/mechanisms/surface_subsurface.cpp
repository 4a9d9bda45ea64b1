// surface.subsurface: light leaves a translucent body beside where it entered. Random walks within closed bodies
// (relighting/body_walks.h), the profile of a half space (surface/diffusion_profile.h) beneath open surfaces.
//
// Renderers state other lengths. Cycles' radius is 1.9 times this one for its random walks at an albedo of 0.5, 2.2
// times at 0.75 and 1.65 times at 0.3 (scripts/proofs/cycles-subsurface): it takes the albedo for that of a body of
// index 1.4 in one place and of a body without an interface in the other.
#include <string>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
namespace {

Parameter path_of(const char* name, const char* colour) {
  return {.name = name,
          .unit = "m",
          .neutral = 0,
          .lower = 0,
          .upper = 0.05,
          .start = 0.003,
          .typical = 0.002,
          .meaning = std::string("diffuse mean free path 1 / sqrt(3 sigma_a sigma_t') in ") + colour};
}

}  // namespace

const Mechanism& surface_subsurface() {
  static const Mechanism declaration{
      .id = "surface.subsurface",
      .sentence = "Light enters the body and leaves it some way off: shadow edges are soft and thin parts glow.",
      .typical = "diffuse mean free path of 0.1 to 10 mm",
      .equation =
          "closed bodies: E'(x) = sum over n of alpha^n S_n(x) / A, S_n the mean light where random walks from x leave "
          "after n scatterings, alpha = 1 - exp(-5.09406 A + 2.61188 A^2 - 4.31805 A^3), A the albedo; half spaces: "
          "E'(x) = integral of R(|x - y|) E(y) dA(y) / integral of R, R(r) = s (exp(-s r / l) + exp(-s r / (3 l))) / "
          "(8 pi l r), s = 3.5 + 100 (A - 0.33)^4; l = 1 / sqrt(3 sigma_a sigma_t') the diffuse mean free path",
      .source =
          "Chiang, Kulla & Burley 2016 (walks); Christensen & Burley 2015 (half space, normalised over what "
          "surface there is)",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"images"},
      .parameters = {path_of("mean_free_path_r_m", "red"), path_of("mean_free_path_g_m", "green"),
                     path_of("mean_free_path_b_m", "blue")},
      .conditions = {"light.shadow-edge-distance", "surface.incidence-angle", "light.visibility"},
      .mistaken_for = {{.with = "light.finite-size", .told_apart = "the profile of a point spot on the surface"},
                       {.with = "optics.defocus", .told_apart = "the profile of a point spot on the surface"},
                       {.with = "light.ambient", .told_apart = "switch the lamp off"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
