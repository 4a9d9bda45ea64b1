// volume.fog: each pixel's radiance is dimmed over the mean way to what it shows, and from the lamps to there (the mean
// over the lamps by their irradiance), and the air before it glows of every lamp and of the scene's own light. Shadows
// that bodies throw into the air are left out. What shows no surface is as far as the scene is wide.
#include "scene/mechanisms/volume_fog.h"

#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  if (switched_on(s.document, mechanism::volume_fog().id)) return {};
  return {scene_use(mechanism::volume_fog())};
}

struct Sight {
  Vec3 eye_m, along;
  double way_m = 0;
};

// Along the mean direction to what the pixel's facets show.
Sight sight_of(const Frame& frame, const Pixel& pixel) {
  const View& view = frame.model.recordings().views[frame.image.view];
  Sight s{view.world_from_camera.translation_m, {}, 0};
  double all = 0;
  Vec3 mean;
  for (std::size_t f = pixel.first_facet; f < pixel.first_facet + pixel.facets; ++f) {
    const Facet& facet = frame.cache.facets[f];
    mean += frame.cache.patches[facet.first_patch].position_m * facet.weight, all += facet.weight;
  }
  const Vec3 arm = all > 0 ? mean / all - s.eye_m : (frame.model.layout().centre_m - s.eye_m) * 2;
  s.way_m = norm(arm), s.along = arm / s.way_m;
  return s;
}

void add(const Use& use, const Frame& frame, std::span<double> radiance) {
  const std::span<const double> amounts = use.amounts(frame.state);
  const double sigma_t = amounts[0], albedo = amounts[1], lost = equation::volume_fog_lost_per_m(sigma_t, albedo);
  const Rgb around = mean_of(frame.image);
  const SceneLayout& layout = frame.model.layout();
  for (std::size_t i = 0; i < frame.picked.size(); ++i) {
    const Pixel& pixel = frame.cache.pixels[frame.picked[i]];
    const Sight sight = sight_of(frame, pixel);
    const Vec3 end_m = sight.eye_m + sight.along * sight.way_m;
    Rgb glow;
    double light = 0, arrives = 0;
    for (const std::size_t l : frame.image.lights) {
      const Rgb intensity = frame.state.lights[l].intensity;
      const LightSource lamp = moved(layout.lights[l], frame.state.lights[l], layout.centre_m);
      if (lamp.directional) {
        glow += intensity * equation::volume_fog_glow(sigma_t, albedo, sight.way_m);
        light += mean(intensity), arrives += mean(intensity);
        continue;
      }
      glow += intensity *
              equation::volume_fog_glow(sigma_t, albedo, sight.eye_m, sight.along, sight.way_m, lamp.position_m);
      const double r = norm(end_m - lamp.position_m), irradiance = mean(intensity) / std::max(1e-9, r * r);
      light += irradiance, arrives += irradiance * equation::volume_fog_passes(lost, r);
    }
    const double passes = equation::volume_fog_passes(sigma_t, sight.way_m) * (light > 0 ? arrives / light : 1);
    glow *= exposure_of(frame.state, frame.image, frame.number, pixel);
    glow += around * equation::volume_fog_veil(sigma_t, albedo, sight.way_m);
    for (std::size_t c = 0; c < 3; ++c) radiance[3 * i + c] = radiance[3 * i + c] * passes + glow[static_cast<int>(c)];
  }
}

}  // namespace

const Term& volume_fog() {
  static const Term term{
      .mechanism = mechanism::volume_fog,
      .reach = Reach::add,
      .order = 55,  // after all that adds to what surfaces send, which it dims too
      .candidates = candidates,
      .add = add,
      .anew = true,
  };
  return term;
}

}  // namespace gonio::relighting::terms
