// What lies around the sampled pixels of a picture: for terms whose value of a pixel depends on its neighbours, of
// which the cache holds none. Every pixel is cast anew for rings of distance about it; what a ring shows is split by
// surface, each part with its depth, so that a kernel may weigh near and far things differently.
//
// A ring of inner and outer radius a, b holds the mean over the pixel's square moved by every (dx, dy) with
// a^2 <= dx^2 + dy^2 < b^2. Small lights only; light by way of other surfaces is the pixel's own (lend_indirect()).
#pragma once
#include <array>
#include <vector>

#include "relighting/image_model.h"

namespace gonio::relighting {

inline constexpr std::array<double, 5> ring_edges_px{0, 0.8, 1.6, 2.8, 4.6};
inline constexpr std::size_t ring_count = ring_edges_px.size() - 1;

struct Ring {
  ViewCache parts;  // its pixels are facets one by one: each the share of the ring that shows one surface
  std::vector<float> sums;
  std::vector<std::uint32_t> first;  // pixel p of the view owns the parts first[p] .. first[p + 1] - 1
  std::vector<float> depth_m;        // of each part, along the camera's axis
  std::vector<float> sky;            // share of each pixel's ring that shows no surface
};
struct Rings {  // of one view
  Ring own;     // the pixels themselves, from the model's own cache
  std::array<Ring, ring_count> about;
};

std::vector<Rings> cast_rings(const Setting& setting);  // [view]

// Radiance of what a ring shows, weighted by its share of the ring, three values for each part of the frame's pixels in
// order. Of the base model: terms that shade or add are left out.
std::vector<double> radiance_of(const Ring& ring, const Frame& frame);

// What the ring number k, and the pixel itself, weigh in the mean over a disc of radius r. Exact where r is an edge of
// the rings, and linear in r^2 between: exact for pictures that are quadratic in the place.
double ring_weight(std::size_t k, double r);
double own_share(double r);

}  // namespace gonio::relighting
