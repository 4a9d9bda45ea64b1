// Views in which things are seen elsewhere: lenses, focal lengths, cameras that were nudged, rows read one after the
// other. A pixel at p shows what the believed view shows at p + d; where rays of the two start at different places, d
// depends on the depth. Everything that moves pixels shares one set of cells of half a pixel (relighting/fine_views.h):
//   P'(p) = P(p) + S(p + d) - S(p),   S(q) the sum of the cells that the pixel's square about q covers.
// Exact for any d but for the cells' own size. Where near and far things lie within two pixels of p, each goes its own
// way: the near ones cover what lies behind them by the share of the square that they fill, and what they uncover is
// like the far things beside it.
//
// d comes from the view that the mechanism makes of the believed one (scene/mechanisms.h), by a ray through p and the
// place of its point in the believed view; no equation of a lens stands here.
#pragma once
#include "relighting/fine_views.h"
#include "relighting/image_model.h"
#include "relighting/uses.h"

namespace gonio::relighting {

// Of the sampled pixels of a model.
struct Places {
  struct Depths {  // of what lies about a pixel, along the camera's axis
    float near_m = 0, far_m = 0;
    float split_m = 0;  // between the two; 0: one thing
  };
  std::vector<std::vector<Depths>> depths;          // [view][pixel]
  std::vector<std::vector<std::uint32_t>> nearest;  // [view][block][surface]: facet that shows it nearest by
};

// By how much a picked pixel's value changes for a look one pixel further to the right, and further down: six numbers
// for each, channel by channel within each of the two. While a use's amounts are no further from neutral than its
// search begins, its slopes are read from them: what moves near things moves their edges.
struct EdgeSlopes {
  std::vector<std::vector<double>> of_image;  // empty: not known
};

// One use for all cameras that state the same numbers, with one set of amounts: perspective cameras that have not the
// mechanism switched on. Bounds are those of displacements by `most_px`, and the search begins at half a pixel.
std::vector<Use> shifted_uses(const Setting& setting, const mechanism::Mechanism& mechanism);
// One use for each view, named by its pictures, and one for the views of a camera together where it has several.
std::vector<Use> shifted_views(const Setting& setting, const mechanism::Mechanism& mechanism);

// Amounts of the use for the frame's picture: by the picture's own name or its camera's; empty: none.
std::span<const double> amounts_for(const Use& use, const Frame& frame);

// Where a channel's pixel shows what the believed camera shows. Null: rays say it, for all channels.
using Recolour = Vec2 (*)(const camera::CameraModel& camera, std::span<const double> amounts, Vec2 pixel,
                          std::size_t channel);

// A term that moves pixels.
Term shifted_term(const mechanism::Mechanism& (*mechanism)(), std::vector<Use> (*candidates)(const Setting&));
// The same where colours part: `add` and `slopes` of a file that has a Recolour.
void add_shifted(const Use& use, const Frame& frame, std::span<double> radiance, Recolour recolour);
void shifted_slopes(const Use& use, const Frame& frame, std::span<const std::size_t> numbers, std::span<double> columns,
                    Recolour recolour);
std::shared_ptr<const Prepared> prepare_shifted(const Setting& setting, const Use& use);

// EdgeSlopes of the frame's pixels, of their radiance under the base model; `shared` filled.
std::vector<double> slopes_across(const Shared& shared, const Frame& frame);

}  // namespace gonio::relighting
