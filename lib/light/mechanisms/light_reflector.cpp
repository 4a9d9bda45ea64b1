// light.reflector: a card or a wall beside a lamp. Equation: scene/edits/light_reflector.cpp, add_card().
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
namespace {

Parameter offset_of_card(const char* name, const char* meaning) {
  return {.name = name,
          .unit = "m",
          .neutral = 0,
          .lower = -1,
          .upper = 1,
          .start = 0.1,
          .typical = 0.2,
          .meaning = meaning};
}

}  // namespace

const Mechanism& light_reflector() {
  static const Mechanism declaration{
      .id = "light.reflector",
      .sentence =
          "A card or a wall beside the lamp sends some of its light on: a second, fainter lamp that is on when "
          "the lamp is.",
      .typical = "1 to 30 % of the lamp",
      .equation =
          "E += share watt_per_sr V max(0, n.l) max(0, c.(-l)) / r^2, r and l from the point to the card at position_m "
          "+ "
          "(offset_x_m, offset_y_m, offset_z_m), c from there to the lamp",
      .source = "Lambert 1760; a small matt card that faces the lamp has share = albedo area / (pi distance^2)",
      .stage = "light",
      .target = Target::light,
      .domains = {"images"},
      .parameters = {{.name = "share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1,
                      .start = 0.05,
                      .typical = 0.1,
                      .meaning = "intensity of the card along its normal over the lamp's"},
                     offset_of_card("offset_x_m",
                                    "from the lamp to the card, along the world's x; without effect "
                                    "where share is 0"),
                     offset_of_card("offset_y_m", "along the world's y; without effect where share is 0"),
                     offset_of_card("offset_z_m", "along the world's z; without effect where share is 0")},
      .conditions = {"light.identity", "light.visibility", "light.distance"},
      .mistaken_for = {{.with = "light.second-source", .told_apart = "switch the lamp off"},
                       {.with = "light.finite-size", .told_apart = "black cloth over the card"},
                       {.with = "light.position", .told_apart = "black cloth over the card"},
                       {.with = "transport.indirect", .told_apart = "black cloth over the card"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
