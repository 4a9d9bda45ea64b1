// Lights as other renderers see them (scene/exchange/lamp.h). Radiance of a ball or disc of intensity I on its axis:
// I / (pi r^2).
#include "scene/exchange/lamp.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "light/aimed.h"
#include "light/mechanisms/light_ambient.h"

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

constexpr double small_m = 1e-3;  // radius of a disc that stands for a point with an aim

// Lamps that shine to one side of a plane across `direction`; radiance I / area.
void aim(Lamp& lamp, const Named& named, std::vector<Loss>& losses) {
  const std::string pointer = "/lights/" + lamp.id;
  const auto lose = [&](const char* what, const char* instead) { losses.push_back({pointer, what, instead}); };
  const Basis frame = light::lamp_frame(named.vector("direction"), named.vector("up"), pointer);
  lamp.axis = frame.n;
  lamp.x = frame.t;
  const double exponent = named.scalar("exponent", 1);
  if (named.has("outer_rad")) {
    lamp.kind = Lamp::Kind::spot;
    lamp.outer_rad = named.scalar("outer_rad");
    lamp.inner_rad = lamp.outer_rad * named.scalar("inner_share");
    if (lamp.radius_m > 0) lose("a spot lamp with an extent", "a point");
    lamp.exponent = named.scalar("exponent");
    return;
  }
  const bool rectangle = named.has("width_m");
  lamp.kind = rectangle ? Lamp::Kind::rectangle : Lamp::Kind::disc;
  lamp.size_x_m = named.scalar("width_m");
  lamp.size_y_m = named.scalar("height_m");
  if (!rectangle && !(lamp.radius_m > 0)) {
    lamp.radius_m = small_m;
    lose("a point that shines to one side", "a disc of 1 mm");
  }
  lamp.value = lamp.value / (rectangle ? lamp.size_x_m * lamp.size_y_m : pi * lamp.radius_m * lamp.radius_m);
  if (exponent != 1) lose("a lobe of the cosine's power", "the same radiance in all directions in front of it");
}

Rgb mean_pixel(const io::Image& picture) {
  Rgb sum;
  const std::size_t channels = picture.channels.size();
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    const float* pixel = picture.data.data() + i * channels;
    sum += channels < 3 ? Rgb{pixel[0], pixel[0], pixel[0]} : Rgb{pixel[0], pixel[1], pixel[2]};
  }
  return sum / static_cast<double>(picture.pixels());
}

// A screen: an even rectangle of its picture's mean.
void shine_evenly(Lamp& lamp, const Named& named, const io::Image& picture, std::vector<Loss>& losses) {
  lamp.position_m = named.vector("position_m");
  lamp.value =
      mean_pixel(picture) * named.vector("scale", {1, 1, 1}) * (named.scalar("width_m") * named.scalar("height_m"));
  aim(lamp, named, losses);
  losses.push_back({"/lights/" + lamp.id, "the picture and polarization of a screen", "an even rectangle of its mean"});
}

void place(Lamp& lamp, const Named& named, const Light& light, std::vector<Loss>& losses) {
  lamp.position_m = named.vector("position_m");
  lamp.value = named.vector("watt_per_sr");
  lamp.radius_m = named.scalar("radius_m");
  const bool file = light.model->info().attachment != manifest::Attachment::none;
  if (named.has("direction") && !file) {
    aim(lamp, named, losses);
    return;
  }
  lamp.kind = lamp.radius_m > 0 ? Lamp::Kind::ball : Lamp::Kind::point;
  if (lamp.radius_m > 0) lamp.value = lamp.value / (pi * lamp.radius_m * lamp.radius_m);
  if (!named.has("watt_per_sr"))
    losses.push_back({"/lights/" + light.id, "the light model \"" + light.model->info().id + "\"", "no light from it"});
  else if (file || named.has("direction"))
    losses.push_back({"/lights/" + light.id, "the light model \"" + light.model->info().id + "\"",
                      "its stated intensity, equally in all directions"});
}

}  // namespace

void lose_exponent(const Lamp& lamp, double has, std::vector<Loss>& losses) {
  if (lamp.kind == Lamp::Kind::spot && lamp.exponent != has)
    losses.push_back({"/lights/" + lamp.id,
                      format("an intensity by the cosine's power %.3g within a cone", lamp.exponent),
                      has == 0 ? "the same intensity within it" : "an intensity by the cosine"});
}

Quaternion Lamp::turn() const {
  const Vec3 z = kind == Kind::directional ? axis : -axis;
  const Vec3 across = kind == Kind::directional ? Basis(z).t : x;
  const Vec3 y = cross(z, across);
  return quaternion_of(Mat3{{across.x, y.x, z.x, across.y, y.y, z.y, across.z, y.z, z.z}});
}

Lamp ambient_lamp(const light::Emitter& ambient) {
  Lamp lamp;
  lamp.kind = Lamp::Kind::uniform;
  lamp.id = mechanism::light_ambient().id;
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
  } else if (light.picture && named.has("width_m")) {
    shine_evenly(lamp, named, *light.picture, losses);
  } else {
    place(lamp, named, light, losses);
  }
  return lamp;
}

}  // namespace gonio::scene
