// Surfaces and lights of a scene: parameters to prepared values, textures, vignetting.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "scene/light_covers.h"
#include "scene/mechanisms/optics_vignetting.h"
#include "scene/scene.h"
#include "scene/spectra.h"
#include "scene/variation.h"

namespace gonio::scene {
namespace {

Rgb texel(const io::Image& picture, int x, int y) {
  const int column = ((x % picture.width) + picture.width) % picture.width;
  const int row = ((y % picture.height) + picture.height) % picture.height;
  const float* pixel = picture.data.data() + picture.index(column, row, 0);
  if (picture.channels.size() < 3) return {pixel[0], pixel[0], pixel[0]};
  return {pixel[0], pixel[1], pixel[2]};
}

std::size_t place_of(const manifest::ModelInfo& info, const std::string& name, const std::string& place) {
  for (std::size_t i = 0; i < info.parameters.size(); ++i)
    if (info.parameters[i].name == name) return i;
  throw Error(Exit::data, place + "/" + name, "model \"" + info.id + "\" has no such parameter",
              "let one of its parameters vary");
}

// A parameter that varies needs no value of its own; any legal one stands in.
void stand_in(manifest::Parameter& given, const manifest::ParameterInfo& info) {
  if (!given.given()) given = manifest::Parameter(info.preset.value_or(std::clamp(0.5, info.lower, info.upper)));
}

void check_texels(const manifest::ParameterInfo& info, const io::Image& picture, const std::string& place) {
  for (const float v : picture.data)
    if (!(v >= info.lower && v <= info.upper))
      throw Error(Exit::data, place,
                  "texture value " + std::to_string(v) + " is outside " + std::to_string(info.lower) + " to " +
                      std::to_string(info.upper),
                  info.meaning);
}

}  // namespace

Rgb Texture::at(Vec2 uv) const {
  const double x = uv.x * picture->width - 0.5, y = (1 - uv.y) * picture->height - 0.5;
  const double column = std::floor(x), row = std::floor(y), s = x - column, t = y - row;
  const int i = static_cast<int>(column), j = static_cast<int>(row);
  return (texel(*picture, i, j) * (1 - s) + texel(*picture, i + 1, j) * s) * (1 - t) +
         (texel(*picture, i, j + 1) * (1 - s) + texel(*picture, i + 1, j + 1) * s) * t;
}

surface::Values Surface::values_at(const Place& place) const {
  surface::Values here = values;
  for (const Texture& texture : textures) here.v[texture.parameter] = texture.at(place.uv);
  for (const Varying& it : varying) here.v[it.parameter] = it.rule->at(place);
  return here;
}

void refresh(Surface& surface, const std::string& place) {
  manifest::Parameters given = in_bands(surface.parameters, surface.model->info(), surface.bands);
  for (const auto& [name, value] : surface.spectra) given[name] = manifest::Parameter(value);
  for (Texture& texture : surface.textures) {
    texture.parameter = place_of(surface.model->info(), texture.name, place + "/textures");
    const manifest::ParameterInfo& info = surface.model->info().parameters[texture.parameter];
    check_texels(info, *texture.picture, place + "/textures/" + texture.name);
    stand_in(given[texture.name], info);
  }
  for (Varying& varying : surface.varying) {
    varying.parameter = place_of(surface.model->info(), varying.name, place);
    stand_in(given[varying.name], surface.model->info().parameters[varying.parameter]);
  }
  surface.values = surface::values_of(*surface.model, given, place);
  surface.prepared = surface.model->prepare(surface.values, surface.file, place);
  surface.values.prepared = surface.prepared.get();
}

void refresh(Light& light, const std::string& place) {
  light.emitter =
      covered_as(light.emitter, light.model->prepare(in_bands(light.parameters, light.model->info(), light.bands),
                                                     {light.picture, light.file}, place));
}

double vignetting(double falloff, int width_px, int height_px, Vec2 pixel) {
  const Vec2 centre{0.5 * (width_px - 1), 0.5 * (height_px - 1)}, arm = pixel - centre;
  return equation::optics_vignetting(falloff, dot(arm, arm), 0.25 * width_px * width_px);
}

}  // namespace gonio::scene
