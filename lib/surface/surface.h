// Surfaces: how light that arrives at a point leaves it again. A model is one file in models/.
//
// Directions are unit vectors in the local frame whose +z is the shading normal on the eye's side: `wo` to the eye
// (z > 0), `wi` to where the light comes from. +x is the surface's tangent, turned by the parameter azimuth_rad where a
// model has one. wi.z > 0: reflection; wi.z < 0: light from beyond the interface, which only models that transmit() let
// through. evaluate() is the BRDF or BTDF in 1/sr for radiance, WITHOUT the cosine |wi.z|; a BTDF contains the factor
// (index on wo's side / index beyond)^2 by which radiance changes (Walter et al. 2007, equation 21). sample() draws wi
// with the density that pdf() states (per steradian).
//
// Perfectly smooth lobes are deltas: evaluate() and pdf() leave them out; sample() returns them with `delta` set, their
// weight divided by the probability of having chosen them.
//
// Where eta differs between bands (dispersion), pdf() and the directions of sample() are those of the band `hero`, and
// evaluate() is right for every band; a refracted delta carries only bands whose eta is the hero's. A path tracer keeps
// the hero alone (times three once, chosen uniformly) from the first such refraction, or weighs pdf() of each hero.
//
// Conditions that every model meets, and a test checks: reciprocity f(wo, wi) / eta_o^2 = f(wi, wo) / eta_i^2; energy:
// what is reflected and transmitted is <= 1 (radiance over eta^2) for albedo <= 1, up to what a model's file says of
// its tables; sample and pdf agree (chi-square); albedo() is the reflectance where it claims so.
#pragma once
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geom/vector.h"
#include "manifest/model.h"
#include "optics/mueller.h"
#include "surface/medium.h"

namespace gonio::surface {

class Model;
class Subsurface;
struct Layer;

// What a model reads or builds once per surface (tables, sampling distributions); see Model::prepare().
struct Prepared {
  virtual ~Prepared() = default;
};

inline constexpr std::size_t most_parameters = 18;  // of a model

// Parameter values at one point, in the order of info().parameters; scalars are spread over all three components.
struct Values {
  std::array<Rgb, most_parameters> v{};
  // Index beyond the interface over the index on wo's side, per band. The path tracer sets it at every vertex from the
  // media that meet there; only models that transmit() read it.
  Rgb eta{1, 1, 1};
  int hero = 0;                        // the band by which directions of refraction are drawn, where they differ
  bool inside = false;                 // the eye is on the inner side, where azimuths turn the other way
  const Prepared* prepared = nullptr;  // from prepare(); the scene owns it
  const Layer* base = nullptr;         // the surface beneath, for models that take one (`base` in the manifest)
  const Rgb& rgb(std::size_t i) const { return v[i]; }
  double scalar(std::size_t i) const { return v[i].x; }
};
struct Layer {
  const Model* model = nullptr;
  Values values;
};

struct Sample {
  Vec3 wi;
  Rgb weight;      // f * |cos| / pdf; zero where the path ends
  double pdf = 0;  // per steradian; for a delta the probability of the lobe; 0 for failure
  bool delta = false;
  bool below = false;  // the light comes by way of subsurface(): wi is only the direction of a refracted ray inwards
};

class Model {
 public:
  virtual ~Model() = default;
  virtual const manifest::ModelInfo& info() const = 0;
  virtual Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const = 0;
  // evaluate(), and its derivative by every parameter, in the order of info().parameters: of a colour, band c's value
  // by band c's number; of a scalar, all bands' values. Central differences within the bounds where a model does not
  // say better; a test holds the two against each other.
  virtual Rgb evaluate_with_slopes(const Values& values, Vec3 wo, Vec3 wi, std::span<Rgb> slopes) const;
  virtual Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const = 0;
  virtual double pdf(const Values& values, Vec3 wo, Vec3 wi) const = 0;
  // Directional-hemispherical reflectance towards wo (an approximation where the file says so); of models that
  // transmit() with the transmittance (radiance over eta^2).
  virtual Rgb albedo(const Values& values, Vec3 wo) const = 0;

  // Is what the albedo adds in proportion to it? Where not, light that facets have sent on to each other counts.
  virtual bool proportional_to_albedo(const Values&) const { return true; }

  // Light also passes to the other side: an interface to the medium that interior() states.
  virtual bool transmits() const { return false; }
  virtual std::optional<Medium> interior(const Values&) const { return {}; }  // of models that transmit
  // A sheet without thickness that light comes through: no interface, and no medium beyond.
  virtual bool thin() const { return false; }
  // Null where light leaves where it entered.
  virtual const Subsurface* subsurface(const Values&) const { return nullptr; }
  // Mueller matrices per band of scattering from wi to wo, divided by their (0, 0) element: evaluate(), or the weight
  // of a delta sample, times this is the polarized law. Frames: optics/mueller.h.
  virtual optics::MuellerRgb mueller(const Values&, Vec3 /*wo*/, Vec3 /*wi*/) const {
    return {optics::Mueller::depolarizer(), optics::Mueller::depolarizer(), optics::Mueller::depolarizer()};
  }
  // Called once per surface with its uniform values; `file` is the surface's file where info().attachment says that it
  // has one, else empty. Error(data) at `place` or at the file.
  virtual std::shared_ptr<const Prepared> prepare(const Values&, const std::filesystem::path& /*file*/,
                                                  const std::string& /*place*/) const {
    return nullptr;
  }
};

std::span<const Model* const> all_models();  // generated
const Model* find(const std::string& id);    // null pointer where there is none

// Values of a surface without textures, presets filled in. Error(data) at `place` for bounds and unknown names.
Values values_of(const Model& model, const manifest::Parameters& parameters, const std::string& place);

}  // namespace gonio::surface
