// light.lobe: lamps that fade to the sides, or that a shade gives a cone.
#include "light/mechanisms/light_lobe.h"

#include "base/error.h"
#include "light/turn.h"
#include "scene/edit.h"
#include "scene/model_choice.h"

namespace gonio::scene::edits {
namespace {

const std::vector<std::string> fading{"exponent"}, shaded{"exponent", "outer_rad", "inner_share"};

bool can_narrow(const Light& light) {
  return find_parameter(light.model->info(), "position_m") && model_with(light, fading);
}

// One that has no axis shone equally all round, and now faces the centre.
void aim(Light& light, double tilt_x_rad, double tilt_y_rad, Vec3 centre_m, const std::string& place) {
  const Vec3 from = light.parameters.at("position_m").vector();
  manifest::Parameter& direction = light.parameters["direction"];
  const Vec3 axis = direction.given() ? direction.vector() : centre_m - from;
  if (!(norm(axis) > 0))
    throw Error(Exit::data, place_of(place, "on"),
                "\"" + light.id + "\" stands in the scene's centre and faces nowhere",
                "give it a model with a direction");
  direction = manifest::Parameter(components(light::turned_with(axis, from, tilt_x_rad, tilt_y_rad, centre_m)));
}

// Adds to the exponent of the lamp. A cone takes the place of the one that it has.
void narrow(Light& light, const Amounts& amounts, Vec3 centre_m, const std::string& place) {
  using namespace mechanism;
  const manifest::ParameterInfo* own = find_parameter(light.model->info(), "exponent");
  const bool has_cone = amounts[lobe_outer] < light_lobe().parameters[lobe_outer].neutral;
  const light::Model* model = model_with(light, has_cone ? shaded : fading);
  if (!model)
    throw Error(Exit::data, place_of(place, "on"), "\"" + light.id + "\" is of a model that no cone can be cut from",
                "leave outer_rad out");
  light.model = model;
  manifest::Parameter& exponent = light.parameters["exponent"];
  exponent = manifest::Parameter((exponent.given() ? exponent.scalar()
                                  : own            ? *own->preset
                                                   : 0) +
                                 amounts[lobe_exponent]);
  if (has_cone) {
    light.parameters["outer_rad"] = manifest::Parameter(amounts[lobe_outer]);
    light.parameters["inner_share"] = manifest::Parameter(amounts[lobe_inner]);
  }
  aim(light, amounts[lobe_tilt_x], amounts[lobe_tilt_y], centre_m, place);
}

}  // namespace

const Edit& light_lobe() {
  static const Edit edit{.mechanism = mechanism::light_lobe, .fits_light = can_narrow, .light = narrow};
  return edit;
}

}  // namespace gonio::scene::edits
