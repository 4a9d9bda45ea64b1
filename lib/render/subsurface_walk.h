// Paths beneath translucent surfaces: from where the eye's ray met the surface to where light entered the same object.
// World frame, metres.
//
// Entry points are drawn after King, Kulla, Conty & Fascione 2013, "BSSRDF importance sampling": by lines that run
// along an axis, one along the exit's normal and 0.6 on average along two tangents, at a distance r on the plane across
// it, drawn for one of three bands (surface::Subsurface). Every place where a line meets the object is found with a
// chance that falls with its height t over the exit's plane, 1 / sqrt(1 + (t / c)^2), c^2 = 2 / (pi density(r)): a line
// is followed no farther than drawn. All ways of finding a point y are counted (balance heuristic):
//   w(y) = 1 / (chance(t) sum over axes of  lines_axis |n_g(y).axis| mean over bands of density(r_axis(y)))
// One of the places is chosen, in proportion to w a, a the density at the straight distance |y - x|, and stands for
// all: weight = sum of w a / a(y) (resampling: Talbot, Cline & Egbert 2005). Weights vary little: on a bunny 0.15 m
// high with sigma_tr = 73, 190 and 371 1/m their mean square is 1.3 to 1.6 times the square of their mean. At the entry
// the path is at an ordinary vertex with the law f = S_d(y, w12(wi); x) T(wi) weight, whose directions are drawn by
// their cosine: lights, interreflection and everything else go on from there as they would anywhere.
#pragma once
#include <optional>

#include "render/ray_caster.h"
#include "render/sampler.h"
#include "render/vertex.h"
#include "surface/subsurface.h"

namespace gonio::render {

struct EntryPoint {
  SurfacePoint point;   // on the same side of the surface as the exit
  double per_area = 0;  // the weight, m^2
};
std::optional<EntryPoint> draw_entry(const RayCaster& caster, const surface::Subsurface& beneath,
                                     const SurfacePoint& exit, Sampler& sampler);

// `point`, seen from the side of the surface that `exit` is on.
SurfacePoint on_side_of(const SurfacePoint& exit, const SurfacePoint& point);

// The law of light that enters at a point and leaves at another.
class EntryModel final : public surface::Model {
 public:
  EntryModel(const surface::Subsurface& beneath, const surface::Model& own, const SurfacePoint& exit,
             const EntryPoint& entry, Vec2 facet)
      : beneath_(beneath), own_(own), exit_(exit), entry_(entry), frame_(shading_frame(entry.point)), facet_(facet) {}
  const manifest::ModelInfo& info() const override { return own_.info(); }
  Rgb evaluate(const surface::Values& values, Vec3 wo, Vec3 wi) const override;
  surface::Sample sample(const surface::Values& values, Vec3 wo, Vec2 u, double u_lobe) const override;
  double pdf(const surface::Values& values, Vec3 wo, Vec3 wi) const override;
  Rgb albedo(const surface::Values& values, Vec3 wo) const override { return own_.albedo(values, wo); }

 private:
  const surface::Subsurface& beneath_;
  const surface::Model& own_;
  const SurfacePoint& exit_;
  EntryPoint entry_;
  Basis frame_;
  Vec2 facet_;
};

}  // namespace gonio::render
