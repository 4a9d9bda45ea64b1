// Surfaces: how light that arrives at a point leaves it again. A model is one file in models/.
//
// Directions are unit vectors in the local frame whose +z is the shading normal n, away from the surface: `wo` to the
// eye, `wi` to the light. Models here reflect: below the horizon (z <= 0) all is zero. evaluate() is the BRDF in 1/sr,
// WITHOUT the cosine. sample() draws wi with the density that pdf() states (per steradian).
//
// Conditions that every model meets, and a test checks: reciprocity f(wo, wi) = f(wi, wo); energy: the cosine-weighted
// integral is <= 1 for albedo <= 1; sample and pdf agree (chi-square); albedo() is the integral where it claims so.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "geom/vector.h"
#include "manifest/model.h"

namespace gonio::surface {

// Parameter values at one point, in the order of info().parameters; scalars are spread over all three components.
struct Values {
  std::array<Rgb, 8> v{};
  const Rgb& rgb(std::size_t i) const { return v[i]; }
  double scalar(std::size_t i) const { return v[i].x; }
};

struct Sample {
  Vec3 wi;
  Rgb weight;      // f * cos / pdf; zero where the path ends
  double pdf = 0;  // per steradian; 0 for failure
};

class Model {
 public:
  virtual ~Model() = default;
  virtual const manifest::ModelInfo& info() const = 0;
  virtual Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const = 0;
  virtual Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const = 0;
  virtual double pdf(const Values& values, Vec3 wo, Vec3 wi) const = 0;
  // Directional-hemispherical reflectance towards wo (an approximation where the file says so).
  virtual Rgb albedo(const Values& values, Vec3 wo) const = 0;
};

std::span<const Model* const> all_models();  // generated
const Model* find(const std::string& id);    // null pointer where there is none

// Values of a surface without textures, presets filled in. Error(data) at `place` for bounds and unknown names.
Values values_of(const Model& model, const manifest::Parameters& parameters, const std::string& place);

}  // namespace gonio::surface
