// Lights as other renderers see them (scene/exchange/lamp.h). Radiance of a ball or disc of intensity I on its axis:
// I / (pi r^2).
#include "scene/exchange/lamp.h"

#include <algorithm>
#include <cmath>

namespace gonio::scene {
namespace {

class Named {
 public:
  explicit Named(const Light& light)
      : info_(light.model->info()), values_(manifest::values_of(info_, light.parameters, "/lights/" + light.id)) {}
  bool has(std::string_view name) const { return index(name) >= 0; }
  Vec3 vector(std::string_view name, Vec3 otherwise = {}) const {
    const int i = index(name);
    return i >= 0 ? values_[static_cast<std::size_t>(i)] : otherwise;
  }
  double scalar(std::string_view name, double otherwise = 0) const { return vector(name, {otherwise, 0, 0}).x; }

 private:
  int index(std::string_view name) const {
    for (std::size_t i = 0; i < info_.parameters.size(); ++i)
      if (info_.parameters[i].name == name) return static_cast<int>(i);
    return -1;
  }
  const manifest::ModelInfo& info_;
  std::vector<Vec3> values_;
};

void surround(Lamp& lamp, const Named& named, const Light& light) {
  if (light.picture && named.has("rotation_rad")) {
    lamp.kind = Lamp::Kind::picture;
    lamp.value = named.vector("scale", {1, 1, 1});
    lamp.rotation_rad = named.scalar("rotation_rad");
    lamp.picture = light.picture;
  } else {
    lamp.kind = Lamp::Kind::uniform;
    lamp.value = named.vector("radiance");
  }
}

void place(Lamp& lamp, const Named& named) {
  lamp.position_m = named.vector("position_m");
  lamp.value = named.vector("watt_per_sr");
  lamp.radius_m = named.scalar("radius_m");
  lamp.kind = lamp.radius_m > 0 ? Lamp::Kind::ball : Lamp::Kind::point;
  if (lamp.radius_m > 0) lamp.value = lamp.value / (pi * lamp.radius_m * lamp.radius_m);
}

}  // namespace

Lamp ambient_lamp(const light::Emitter& ambient) {
  Lamp lamp;
  lamp.kind = Lamp::Kind::uniform;
  lamp.id = "light.ambient";
  lamp.value = ambient.hit({}, {0, 0, 1}).radiance;
  return lamp;
}

Lamp lamp_of(const Light& light, std::vector<Loss>& losses) {
  const Named named(light);
  Lamp lamp;
  lamp.id = light.id;
  if (light.emitter->infinite()) {
    surround(lamp, named, light);
  } else if (named.has("towards") && named.has("watt_per_m2")) {
    lamp.kind = Lamp::Kind::directional;
    lamp.axis = normalized(named.vector("towards"));
    lamp.value = named.vector("watt_per_m2");
  } else {
    place(lamp, named);
    const std::string& id = light.model->info().id;
    if (id != "point" && id != "sphere")
      losses.push_back({"/lights/" + light.id + "/model", "the light model \"" + id + "\"",
                        "a lamp of the same intensity that shines equally in all directions"});
  }
  return lamp;
}

}  // namespace gonio::scene
