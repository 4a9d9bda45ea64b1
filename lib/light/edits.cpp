// Mechanisms of lights as edits (light/edits.h).
#include "light/edits.h"

#include "base/error.h"
#include "light/turn.h"

namespace gonio::light {
namespace {

[[noreturn]] void refuse(const manifest::Light& light, const std::string& lacks, const std::string& place) {
  throw Error(Exit::data, place, "light of model \"" + light.model + "\" has no " + lacks,
              "name the lights to change with \"on\"");
}

void set(manifest::Parameter& parameter, Vec3 value) {
  parameter.value = {value.x, value.y, value.z};
}

}  // namespace

bool has_direction(const manifest::Light& light) {
  return light.model == "directional" || can_have_size(light);
}
bool can_have_size(const manifest::Light& light) {
  return light.model == "point" || light.model == "sphere";
}

manifest::Light with_direction(manifest::Light light, double tilt_x_rad, double tilt_y_rad, Vec3 centre_m,
                               const std::string& place) {
  if (!has_direction(light)) refuse(light, "direction", place);
  if (tilt_x_rad == 0 && tilt_y_rad == 0) return light;
  if (light.model == "directional") {
    manifest::Parameter& towards = light.parameters.at("towards");
    set(towards, turned(normalized(towards.vector()), tilt_x_rad, tilt_y_rad));
  } else {
    manifest::Parameter& position = light.parameters.at("position_m");
    set(position, turned_about(position.vector(), tilt_x_rad, tilt_y_rad, centre_m));
  }
  return light;
}

manifest::Light with_radius(manifest::Light light, double radius_m, const std::string& place) {
  if (!can_have_size(light)) refuse(light, "size", place);
  light.parameters["radius_m"] = radius_m;
  return light;
}

manifest::Light ambient(Rgb radiance) {
  manifest::Light light;
  light.model = "uniform";
  light.parameters["radiance"] = std::vector<double>{radiance.x, radiance.y, radiance.z};
  return light;
}

}  // namespace gonio::light
