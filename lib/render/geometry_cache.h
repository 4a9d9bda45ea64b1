// What explain keeps of a view so that a prediction costs no ray: where the pixels' rays meet surfaces, whether points
// see lights, and how much light comes by way of other surfaces, as a polynomial in their albedos.
//
// Interreflection between Lambertian surfaces: the irradiance at x is a sum over paths x, y1, y2, ..., yk, light:
//   E(x) = sum over paths of  albedo(y1) albedo(y2) ... albedo(yk)  G(path)
// (Goral et al. 1984; Kajiya 1986, equation 1 with constant BRDFs). G depends on geometry and lights alone. Collected
// by how often each surface was visited, it is a polynomial in the surfaces' albedos with known coefficients, one set
// per light. With an albedo per colour, evaluate once per colour. Surfaces that are not Lambertian enter with their
// albedo only.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "light/light.h"
#include "render/ray_caster.h"
#include "scene/scene.h"

namespace gonio::render {

struct ViewPoint {     // one sub-sample of one pixel
  bool found = false;  // false: the ray leaves the scene
  SurfacePoint point;
  Vec3 to_eye;  // unit
};

// side * side sub-samples per pixel at the centres of equal squares, rows first: sample (i, j) of pixel (x, y) is at
//   ((y * width + x) * side + j) * side + i,   position (x - 0.5 + (i + 0.5) / side, y - 0.5 + (j + 0.5) / side)
std::vector<ViewPoint> view_points(const RayCaster& caster, const scene::View& view, int side);

// Mean over `samples` stratified directions to the light (one for delta lights) of visibility: 0 hidden, 1 seen, and of
// visibility * cosine * weight: the irradiance, per light sample.
struct Received {
  double visibility = 0;  // share of the samples that reach the light
  Rgb irradiance;         // W/m^2 about the shading normal
};
Received received(const RayCaster& caster, const SurfacePoint& point, const light::Emitter& emitter, int samples,
                  std::uint64_t seed);

// Monomials of albedos a_0 .. a_(surfaces-1) up to a total degree, ordered by degree; number 0 is the constant 1.
class Monomials {
 public:
  Monomials(std::size_t surfaces, int degree);
  std::size_t size() const { return exponents_.size() / surfaces_; }
  std::size_t surfaces() const { return surfaces_; }
  std::span<const std::uint8_t> exponents(std::size_t monomial) const {
    return {exponents_.data() + monomial * surfaces_, surfaces_};
  }
  // Monomial reached by one more visit to `surface`; size() beyond the highest degree.
  std::size_t times(std::size_t monomial, std::size_t surface) const { return next_[monomial * surfaces_ + surface]; }
  std::vector<double> evaluate(std::span<const double> albedos) const;  // one value per monomial

 private:
  std::size_t surfaces_;
  std::vector<std::uint8_t> exponents_;
  std::vector<std::size_t> next_;
};

struct IndirectOptions {
  int bounces = 6;  // visits to other surfaces, at most
  int paths = 64;   // per point, stratified in the first direction
  std::uint64_t seed = 1;
};
// coefficients[(point * sources + source) * monomials.size() + monomial]: irradiance in W/m^2 from `source`, mean of
// the three colours of its emission. Monomial 0 (no surface visited) is zero for emitters that are not infinite: direct
// light from lamps is not part of this; for infinite emitters (environments) it is what comes straight from the
// unoccluded part of the environment.
struct IndirectIrradiance {
  Monomials monomials;
  std::size_t sources = 0;
  std::vector<float> coefficients;
  std::span<const float> at(std::size_t point, std::size_t source) const {
    return {coefficients.data() + (point * sources + source) * monomials.size(), monomials.size()};
  }
};
// One path tree per point serves all emitters. Points: any selection of view points (say, one per pixel, or every
// fourth). Ambient of unit radiance: pass a uniform environment among the emitters.
IndirectIrradiance indirect_irradiance(const RayCaster& caster, std::size_t surfaces,
                                       std::span<const SurfacePoint> points,
                                       std::span<const light::Emitter* const> emitters,
                                       const IndirectOptions& options = {});

}  // namespace gonio::render
