// A light in the few terms that other renderers share, recognised by the names of its parameters.
#pragma once
#include <string>
#include <vector>

#include "scene/exchange/exchange.h"

namespace gonio::scene {

struct Lamp {
  // ball, disc, rectangle: a uniform radiance of `value`; point, spot: an intensity on the axis; directional: the
  // irradiance of a plane that faces it; uniform, picture: radiance (of a picture's value of one)
  enum class Kind { point, ball, disc, rectangle, spot, directional, uniform, picture };
  Kind kind = Kind::point;
  std::string id;
  Rgb value;
  Vec3 position_m;
  Vec3 axis{0, 0, 1};  // unit: where it shines to; directional: towards the light
  Vec3 x{1, 0, 0};     // rectangle: along its first side
  double radius_m = 0, size_x_m = 0, size_y_m = 0;
  double inner_rad = 0, outer_rad = 0;       // spot: full within, nothing beyond
  double exponent = 0;                       // spot: of the cosine within
  double rotation_rad = 0;                   // picture
  std::shared_ptr<const io::Image> picture;  // linear
  Quaternion turn() const;                   // takes -z to where it shines, and x along its first side
  bool infinite() const { return kind == Kind::uniform || kind == Kind::picture; }
};

Lamp lamp_of(const Light& light, std::vector<Loss>& losses);  // `losses` gains what the lamp lacks
// A loss where the cone of another program falls off by the cosine's power `has`, and the lamp's by another.
void lose_exponent(const Lamp& lamp, double has, std::vector<Loss>& losses);
Lamp ambient_lamp(const light::Emitter& ambient);  // of the mechanism light.ambient

}  // namespace gonio::scene
