// Lights: where radiance comes from. A model is one file in models/. World frame, metres; intensities in
// W/sr (`watt_per_sr`), radiances in W/(m^2 sr), irradiance of a directional light in W/m^2 on a plane facing it.
//
// sample(): the contribution to reflected radiance of an unoccluded light is  f(wo, wi) * cos(theta_i) * weight, where
// weight = L / pdf for lights of finite size and the incident irradiance on a facing plane for delta lights.
#pragma once
#include <array>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "geom/vector.h"
#include "io/image.h"
#include "manifest/model.h"
#include "optics/mueller.h"

namespace gonio::light {

struct Sample {
  Vec3 direction;                                               // unit, from the point to the light
  double distance_m = std::numeric_limits<double>::infinity();  // occluders nearer than this count
  Rgb weight;                                                   // see above
  double pdf = 0;                                               // per steradian; 0 together with delta
  bool delta = false;
  bool valid = false;
};
// A photon that leaves the light; the mean of `flux` over draws is the light's power, W.
struct Emission {
  Vec3 origin_m, direction;  // unit
  Rgb flux;
  bool valid = false;
};
// Polarization of what the light sends out along a direction of travel: Stokes vector over s0 in the frame (x, d x x,
// d).
struct Polarization {
  Vec3 x;  // unit, perpendicular to the direction of travel
  optics::Stokes stokes{{1, 0, 0, 0}};
};
// The file of a model whose info().attachment says that it has one.
struct Attachment {
  std::shared_ptr<const io::Image> picture;  // Attachment::picture: linear
  std::filesystem::path path;
};
struct Hit {  // a ray that meets the light itself
  double distance_m = std::numeric_limits<double>::infinity();
  Rgb radiance;
  double pdf = 0;  // density with which sample() would have drawn this direction
};

// One light of the scene, prepared for sampling (tables built, presets filled in). Immutable; edited copies are cheap.
class Emitter {
 public:
  virtual ~Emitter() = default;
  virtual Sample sample(Vec3 point_m, Vec2 u) const = 0;
  // What a ray from `origin` along the unit `direction` receives from the light itself, nothing occluding;
  // radiance zero for delta lights and misses.
  virtual Hit hit(Vec3 origin_m, Vec3 direction) const = 0;
  virtual bool infinite() const { return false; }  // environment: lights rays that leave the scene
  // For tracing from the light; not valid where the model cannot (infinite ones).
  virtual Emission emit(Vec2 /*u_position*/, Vec2 /*u_direction*/) const { return {}; }
  // Empty for unpolarized light. `travel`: unit, away from the light.
  virtual std::optional<Polarization> polarization(Vec3 /*travel*/) const { return {}; }
};

class Model {
 public:
  virtual ~Model() = default;
  virtual const manifest::ModelInfo& info() const = 0;
  virtual std::unique_ptr<Emitter> prepare(const manifest::Parameters& parameters, const Attachment& file,
                                           const std::string& place) const = 0;
};

std::span<const Model* const> all_models();  // generated
const Model* find(const std::string& id);

}  // namespace gonio::light
