// Paths beneath translucent surfaces: from where the eye's ray met the surface to where light entered the same object.
// World frame, metres.
//
// Entry points are drawn as King, Kulla, Conty & Fascione 2013, "BSSRDF importance sampling": one of three axes (the
// exit's normal with probability 0.7, two tangents with 0.15 each), one of three bands, a distance r on the plane
// across the axis (surface::Subsurface), and one of the points where a line along the axis meets the object within the
// reach, with chances q in proportion to the square root of the density at the straight distance |y - x|: the far side
// of a body is met as often as the near one and sends little, but it may be the lit one. All ways of having found a
// point y are counted (balance heuristic):
//   density per area(y) = sum over axes of  p_axis |n_g(y).axis| mean over bands of density(r_axis(y)),
//   weight = 1 / (q density)
// At the entry the path is at an ordinary vertex with the law f = S_d(y, w12(wi); x) T(wi) weight, whose directions are
// drawn by their cosine: lights, interreflection and everything else go on from there as they would anywhere.
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
