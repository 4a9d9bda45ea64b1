// Rims of objects and of their shadows against the aligned model, as a problem for the engine.
//
// Observations: points of rims (align(1)), by two numbers. OFFSET: how far a point lies outside of the rim that the
// aligned model has, px, without what masks do to rims (alignment/rim_bias.h). WIDTH: how wide the edge of a shadow is
// in the photograph, px (alignment/edge_spread.h). One group per rim: an object in a view, its shadow under a lamp;
// blocks are stretches of 32 px. Score: the root mean square offset.
//
// Prediction: the mesh point that the model's rim has beside the seen one moves as the physics in question says, is
// seen (or throws its shadow) again, and by how far along the rim's normal it has gone is what the offset should be.
// Along a smooth body's rim the point glides over the surface, which to first order moves no rim. Which mesh point is
// beside which seen one is told where the model is nearest to what was seen: with sizes along all axes free. An edge's
// width is
//   sqrt(blur^2 + |g|^2 r^2 / 4),   (alignment/lamp_size.h)
// and a lamp that is no point moves the rim of a shadow where that is bent: by as much as its simulation says, with
// r^2.
//
// Free in the base model: what align left free, by what it wrote into "alignments": poses, lamps, cameras, scales; and
// the blur of each lens, and what each mask is too large by all around (half a tenth of a pixel). What align was told
// to hold is asked here: geometry.pose, light.position.
//
// Pixels of the straightened picture (alignment/setting.h), world frame, metres, radians.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alignment/alignment_input.h"
#include "explain/domain.h"
#include "explain/engine.h"
#include "manifest/sections/forward.h"

namespace gonio::explain {

struct OutlineRow {
  bool width = false;
  Vec3 mesh_point;      // of the model's rim, frame of the mesh, without scale
  Vec2 pixel, outward;  // of that, in the aligned model; outward: nearest to what was seen
  Vec3 outside;         // unit, world: along the surface's normal there
  double lever = 0;     // of widths: |g|^2, px^2 / m^2
  double penumbra = 0;  // of offsets: px / m^2, times r^2
  double observed = 0, sigma = 0;
  std::uint32_t stretch = 0;
};
struct OutlineView {
  std::string name, image;
  alignment::RimSubject subject;
  std::vector<OutlineRow> rows{};
};
// Of the rims of one lamp's shadows: points that lie deep in the model's shadow where the model has no rim, and such
// points outside of it, which chance makes as often.
struct LitInside {
  std::size_t lamp = 0, points = 0, inside = 0;
  std::size_t stretches_inside = 0, stretches_outside = 0;
};
struct OutlinesInput {
  alignment::AlignmentInput in;    // stated: the aligned model
  std::vector<OutlineView> views;  // group by group
  std::vector<LitInside> lit;
  std::vector<double> radii_m;  // of lamps as the manifest has them; 0: points
  std::vector<double> blur_px;  // of lenses, to begin with
  bool scales_free = false;
};

// Outlines of objects that align found.
bool has_outlines(const manifest::Document& document);
// Error(data) where they are fewer than `fewest_rims`.
void outlines_within_reach(const manifest::Document& document);
// Of rims that were read, beside the model as `in.stated` has it; what is free in the base model is free in its
// question. `radii_m`: of the lamps, 0: points.
OutlinesInput outlines_of(alignment::AlignmentInput in, std::vector<double> radii_m);
OutlinesInput outlines_input(const manifest::Document& document);
// Masks hold to a tenth of a pixel, and what changes rims by less than half of that is as well theirs.
std::optional<Testimony> outlines_objection(const Problem& problem, const Explanation& e, std::size_t candidate);
std::unique_ptr<Problem> outlines_problem(OutlinesInput input);

inline constexpr std::size_t fewest_rims = 4;

}  // namespace gonio::explain
