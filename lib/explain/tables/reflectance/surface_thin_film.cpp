// surface.thin-film in tables of reflectance: fringes have many local minima, and a range of thickness holds one.
#include <array>

#include "explain/tables/reflectance_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_thin_film();
}

namespace gonio::explain::tables::reflectance {
namespace {

// A fringe at 550 nm is 0.2 um of a film of index 1.35 and 0.14 um of one of 2.0. Films of lower and of higher index
// than the interface's turn the phase the other way, and between the two nothing is seen.
struct FilmClass {
  double lowest_eta, start_eta, highest_eta, width_m;  // width: of a range of thickness
  std::size_t ranges;
};
constexpr std::array<FilmClass, 2> film_classes = {{{1.15, 1.35, 1.5, 0.12e-6, 5}, {1.5, 2.0, 2.4, 0.08e-6, 8}}};
constexpr double thinnest_film_m = 0.02e-6;
constexpr std::size_t fewest_bands = 5;  // fewer cannot tell fringes from any other colour of the gloss

bool shows_fringes(const ReflectanceRows& rows, const SurfacePlaces& places) {
  return places.film() && rows.band_m.size() >= fewest_bands;
}

std::vector<std::vector<Parameter>> films(const std::vector<Parameter>& declared, bool given) {
  std::vector<std::vector<Parameter>> all;
  for (const FilmClass& c : film_classes)
    for (std::size_t k = 0; k < c.ranges; ++k) {
      Parameter thickness = declared[0], index = declared[1];
      thickness.lower = thinnest_film_m + c.width_m * static_cast<double>(k);
      thickness.upper = thickness.lower + c.width_m;
      thickness.start = 0.5 * (thickness.lower + thickness.upper);
      thickness.size = 1e-8;
      index.lower = c.lowest_eta, index.start = c.start_eta, index.upper = c.highest_eta, index.size = 0.05;
      if (given) {
        thickness.lower = 0, thickness.upper = declared[0].upper;
        index.lower = film_classes[0].lowest_eta, index.upper = film_classes[1].highest_eta;
        return {{thickness, index}};
      }
      all.push_back({thickness, index});
    }
  return all;
}

}  // namespace

const ReflectanceBinding& surface_thin_film() {
  static const ReflectanceBinding binding{.mechanism = mechanism::surface_thin_film,
                                          .order = 80,
                                          .kind = ReflectanceSlot::Kind::film,
                                          .shows = shows_fringes,
                                          .ranges = films};
  return binding;
}

}  // namespace gonio::explain::tables::reflectance
