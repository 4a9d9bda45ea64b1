#include "sealed/image_effects.h"

namespace gonio::sealed {
std::vector<EffectKind> image_effects(const double* white) {
  const std::vector<std::string> edge{"light.shadow-edge-distance", "light.visibility", "image.edge-distance"},
      angles{"surface.half-angle", "surface.exitance-angle", "surface.incidence-angle", "surface.phase-angle"},
      outline{"image.edge-distance", "image.gradient"}, bright{"image.radiance"},
      unlit{"scene.indirect-irradiance", "light.visibility"};
  const std::vector<std::string> optics{"optics"}, sensor{"sensor"}, light{"light"}, surface{"surface"},
      geometry{"geometry", "pose"};
  std::vector<EffectKind> k;
  const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
  add({"lamp with a size", "light.finite-size", light, edge, 0.008, 0.035}).means({"radius_m"});
  add({"ambient light", "light.ambient", light, {"scene.ambient-visibility", "light.visibility"}, 0.004, 0.04})
      .means({"radiance_r", "radiance_g", "radiance_b"}, {1, 1, 1.1});
  add({"lamps elsewhere",
       "light.direction",
       light,
       {"light.identity", "surface.incidence-angle", "light.shadow-edge-distance", "light.visibility"},
       0.02,
       0.12});
  add({"vignetting", "optics.vignetting", optics, {"camera.image-radius"}, 0.05, 0.35}).nearly("falloff");
  add({"clear coat", "surface.interface", surface, {"surface.half-angle", "image.radiance"}, 0.02, 0.06}).nearly("f0");
  add({"rough matte", "surface.diffuse-roughness", surface, angles, 0.2, 0.5}).nearly("sigma_rad");
  add({"veiling glare", "optics.veiling-glare", optics, bright, 0.01, 0.05});
  add({"black offset", "sensor.black-offset", sensor, bright, 0.004, 0.02});
  add({"bent response", "sensor.non-linearity", sensor, bright, 0.02, 0.1});
  add({"saturation", "sensor.saturation", sensor, bright, 0.15, 0.4}).values = [white](const Numbers& s) {
    return std::vector<TrueValue>{{"sensor.saturation", "full_scale", (1 - s[0]) * *white}};
  };
  add({"mains ripple", "sensor.row-pattern", sensor, {"camera.image-y"}, 0.01, 0.1});
  add({"uneven pixels", "sensor.prnu", sensor, {"camera.pixel"}, 0.015, 0.05}).means({"sigma"});
  add({"polarized lamps",
       "light.polarization",
       light,
       {"light.plane-azimuth", "surface.incidence-angle", "light.identity"},
       0.3,
       0.9})
      .only_for("varnished");
  add({"brushed table", "surface.anisotropy", surface, {"surface.azimuth", "surface.half-angle"}, 0.3, 1})
      .only_for("varnished");
  add({"crosstalk", "sensor.crosstalk", sensor, {"image.hue"}, 0.01, 0.05}).means({"share"});
  add({"second lamp",
       "light.second-source",
       light,
       {"light.second-visibility", "light.visibility", "surface.second-incidence-angle"},
       0.01,
       0.1});
  add({"stain", "surface.spatial-variation", surface, {"surface.position", "scene.position"}, 0.1, 0.5});
  add({"wide pupil", "optics.defocus", optics, {"image.edge-distance", "scene.depth"}, 0.004, 0.012});
  add({"moved ball", "geometry.pose", geometry, outline, 0.001, 0.005});
  add({"shrunk ball", "geometry.scale", geometry, outline, 0.01, 0.05});
  add({"light between surfaces", "transport.indirect", {"transport"}, unlit, 1, 1.0001})
      .as_drawn()  // it is there or not
      .only_for("direct light only")
      .values = [](const Numbers&) {
    return std::vector<TrueValue>{{"transport.indirect", "strength", 1}};
  };
  add({"uneven columns", "", sensor, {"camera.image-x"}, 0.02, 0.08});
  add({"wire", "", {"light", "geometry"}, {}, 0.002, 0.006});
  return k;
}

}  // namespace gonio::sealed
