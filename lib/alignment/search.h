// From nothing to a start for fit_rims(): where a body is, by the shape of its rim, and where lamps are, by its
// shadows.
//
// A body's attitude has two directions that its rim's shape depends on (from where it is seen) and three numbers that
// move and turn the rim in the picture, plus one that makes it larger. The directions are sampled evenly over the
// sphere; for each the rim's area, middle and principal axis, which follow from its moments (rim.h), give the rest in
// closed form. What remains is compared: first by Hu's seven invariants (Hu 1962), then by the rims themselves, in all
// views.
#pragma once
#include <cstdint>
#include <vector>

#include "alignment/fit.h"

namespace gonio::alignment {

struct SearchWish {
  int directions = 400;  // from where the body may be seen
  int compared = 100;    // of these, by Hu's invariants, whose rims are compared
  int refined = 10;      // whose rims are fitted roughly
  double reach_px = 40;  // of the comparison
  // The camera moves instead of the body, which stands as it is stated: one station, whose pose is not known.
  bool move_station = false;
  bool record = false;  // fill Start::paths
};

struct Start {
  Setting setting;
  double cost = 0;  // of its rims, both ways; smaller is better
  // How far rims were off on the way there (FitPath): its own way first, then those of starts that led to the same end.
  std::vector<std::vector<double>> paths{};
};

// Starts for body `body`, best first, no two alike; from the sightings of its own rim (not of shadows) in `question`.
// Error(data) where these have no rim that closes.
std::vector<Start> search_body(const Setting& stated, const Question& question, std::size_t body,
                               const SearchWish& wish);

// Places for the lamp that throws the shadows of `lamp`, best first.
std::vector<Start> search_lamp(const Setting& setting, const Question& question, std::size_t lamp,
                               const SearchWish& wish);

// Hu's invariants of a region, as logarithms with sign, of which the last changes sign in a mirror.
std::array<double, 7> hu_invariants(const Moments& about_middle);
Moments about_middle(const Moments& m);
Moments moments_of_points(const std::vector<RimPoint>& points, Vec2 origin);

}  // namespace gonio::alignment
