// The scene as numbers: every parameter that an image depends on besides geometry, at one place of the search.
// Mechanisms are edits of it; at their neutral values they leave it, and the prediction, as it is.
#pragma once
#include <string>
#include <vector>

#include "geom/vector.h"
#include "manifest/sections/forward.h"
#include "relighting/light_cache.h"
#include "surface/surface.h"

namespace gonio::relighting {

// A surface. `diffuse` is carried as `coated-diffuse`, whose roughness and interface are absent at sigma_rad = f0 = 0,
// so that the mechanisms find their parameters.
struct SurfaceState {
  const surface::Model* model = nullptr;
  surface::Values values;
  bool lambertian() const;  // neither rough nor coated: one number, albedo / pi, says it all
};
struct LightState {
  Rgb intensity;  // W/sr, or W/m^2 on a facing plane for a directional light
  double radius_m = 0;
  double tilt_x_rad = 0, tilt_y_rad = 0;
  Vec3 shift_m;               // of a lamp at a finite distance
  double nearness_per_m = 0;  // directional lights: one over the distance from the scene's centre
  std::vector<double> lobe;   // amounts of light.lobe; empty: it shines all round
};
// `given` where `state` has it: turned about the scene's centre, shifted, near after all.
LightSource moved(const LightSource& given, const LightState& state, Vec3 centre_m);

struct SceneState {
  std::vector<SurfaceState> surfaces;
  std::vector<LightState> lights;  // in the order of Recordings::lights
  Rgb ambient;                     // radiance from all directions, W/(m^2 sr)
  double falloff = 0;     // vignetting: 1 - falloff r^2, r = distance from the image's centre over half its width
  double indirect = 1;    // share of light between surfaces that is simulated
  std::vector<Rgb> gain;  // one per image
  std::vector<std::vector<double>> amounts;  // of the terms' uses (relighting/term.h)
};

// The parts of a scene that images need, in a fixed order.
struct SceneLayout {
  std::vector<std::string> surfaces;  // keys in the manifest, in the order of their numbers in the cache
  std::vector<LightSource> lights;    // in the order of Recordings::lights
  Vec3 centre_m;                      // about which light.direction turns lamps
  SceneState start;                   // as the manifest has it, its mechanisms included
};

// Has every light that was on in a recording a model that is simulated here? Error(data) where one has not.
bool knows_lights(const manifest::Document& document);
void check_lights(const manifest::Document& document);

SceneLayout read_scene(const manifest::Document& document, const Recordings& recordings,
                       const std::vector<std::string>& surfaces, Vec3 centre_m);

// Place of a parameter in its model's list; Error(internal) where there is none.
std::size_t parameter_index(const surface::Model& model, const std::string& name);
bool has_parameter(const surface::Model& model, const std::string& name);

}  // namespace gonio::relighting
