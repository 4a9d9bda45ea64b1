// The BRDF of a relief, by tracing paths over a periodic patch of it (Westin, Arvo & Torrance 1992, "Predicting
// reflectance functions from complex surfaces"). Frame: relief.h. `wo` to the eye, `wi` to the light, unit, z > 0.
//
// A path enters along -wo at a uniform place of the plane, that is, with the density that the area has as wo sees it,
// meets facets (relief.h), leaves each as the material says (surface/surface.h, in the facet's own frame with the
// tangent along the relief's x), and escapes upwards with the throughput T. Light that a facet lets through is lost.
// Then, for a domain O of directions of the projected solid angle |O| = integral of cos dw,
//   mean of f over O = E[T 1(escapes into O)] / |O|.
// Where a facet's reflection is no delta the next-event estimate is used instead: with w drawn uniformly from the cone
// O of the solid angle W, at every facet met,
//   E[ T f_facet(w_here, w) (n.w) visible(w) W ] / |O|,
// and escapes into O count only after a delta. A cone of half angle 0 is the direction itself: then W / |O| = 1 / wi.z,
// and deltas, which never meet it, are refused. A cone about wo is the eye's aperture, drawn with the density cos:
//   f = integral f cos dwi cos dwo / (|Oi| |Oo|),
// symmetric in both, so that lobe(wo, wi) = lobe(wi, wo) within errors.
//
// Sigmas come from 64 batches of paths with random numbers of their own; where these agree, as in cells of a table that
// no path reached, it is that of one path which carries what paths carry on average. They do not contain what another
// patch of the same surface would give.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "manifest/parameter.h"
#include "relief/relief.h"
#include "surface/surface.h"

namespace gonio::relief {

struct Material {
  const surface::Model* model = nullptr;
  surface::Values values;
};
Material mirror();                                       // reflects all light, smooth
Material white();                                        // Lambert's, albedo 1
Material conductor(Rgb eta, Rgb k, double alpha = 0);    // GGX facets below the relief's resolution; 0: smooth
Material facets_of_index(double eta, double alpha = 0);  // Fresnel's reflection alone; what enters is lost
// Any registered surface that needs no file and lets light leave where it entered. Error(data) at `place`.
Material material_of(const std::string& model, const manifest::Parameters& parameters, const std::string& place);

struct Aperture {  // half angles of the cones about both directions, rad
  double about_wi_rad = 0, about_wo_rad = 0;
};
struct Effort {
  std::int64_t paths = 1 << 16;
  std::uint64_t seed = 0;
  int most_facets = 100;  // that one path meets; what is left of it then is counted as cut
};
struct Estimate {
  Rgb value, sigma;
};

// f, 1/sr. Error(data) for directions below the horizon, an open relief, and for smooth facets seen through no cone.
Estimate lobe(const Relief& relief, const Material& material, Vec3 wo, Vec3 wi, const Aperture& aperture,
              const Effort& effort = {});

// Shares of the light that comes along wo, or, by reciprocity, the radiance towards wo under a white sky.
struct Energy {
  Estimate reflected, lost, cut;      // they add up to 1
  std::array<double, 4> by_facets{};  // share of `reflected` that met 1, 2, 3 and more facets
};

// Cells of the hemisphere. The table: theta x phi, of equal angles. The picture: the unit disc seen from above, side x
// side squares in (wi.x, wi.y), each of the projected solid angle (2 / side)^2.
struct LobeTable {
  int theta_cells = 0, phi_cells = 0, side = 0;
  std::vector<Estimate> table;    // theta-major; theta from the normal, phi from +x
  std::vector<Estimate> picture;  // rows from the top, +y up
  Energy energy;
  Estimate peak;  // of the table
  double peak_theta_rad = 0, peak_phi_rad = 0;
  double theta_rad(int cell) const { return (cell + 0.5) * pi / 2 / theta_cells; }
  double phi_rad(int cell) const { return (cell + 0.5) * 2 * pi / phi_cells; }
};
struct LobeCells {
  int theta = 45, phi = 72, side = 128;
};
LobeTable lobe_table(const Relief& relief, const Material& material, Vec3 wo, const LobeCells& cells,
                     const Effort& effort = {});

Vec3 direction_of(double theta_rad, double phi_rad);

}  // namespace gonio::relief
