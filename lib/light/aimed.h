// What lamps that face somewhere have in common: the frame of their parameters, the lobe of their emission.
//
// Frame of a lamp: n along `direction` (unit, away from the lamp), y along `up` made perpendicular to it, x = up x n:
// who looks at the lamp from the front sees x to the right and y upwards. `up` zero: +z of the world, or +y for lamps
// that shine along it.
#pragma once
#include <memory>
#include <string>

#include "light/light.h"

namespace gonio::light {

// Basis with t = x, b = y, n. Error(data) at `place` for directions without length and an `up` along `direction`.
Basis lamp_frame(Vec3 direction, Vec3 up, const std::string& place);

// Relative intensity over the directions of a lamp's frame, at most some moderate number; z is the axis.
class Lobe {
 public:
  struct Draw {
    Vec3 local;  // unit
    double pdf = 0;
  };
  virtual ~Lobe() = default;
  virtual double relative(Vec3 local) const = 0;
  virtual Draw draw(Vec2 u) const = 0;  // for emission; pdf > 0 wherever relative() is
};

// cos(theta)^exponent, nothing behind.
std::unique_ptr<const Lobe> cosine_lobe(double exponent);

// A lamp of `watt_per_sr` times the lobe. Radius 0: a point, which acts as a delta light. Else a disc across the axis,
// whose radiance along a direction at the angle theta from the axis is
//   L = watt_per_sr relative / (pi R^2 cos(theta)),
// so that far away it acts as the point does. sample() draws the disc's area uniformly (concentric map),
//   pdf = d^2 / (pi R^2 cos(theta)),    weight = L / pdf = watt_per_sr relative / d^2.
// emit(): flux = watt_per_sr relative / pdf of the lobe. Behind the disc there is nothing.
std::unique_ptr<Emitter> aimed_lamp(Vec3 position_m, const Basis& frame, Rgb watt_per_sr, double radius_m,
                                    std::shared_ptr<const Lobe> lobe);

// Entries of the tables of parameters.
manifest::ParameterInfo position_info(const char* meaning);
manifest::ParameterInfo direction_info();
manifest::ParameterInfo up_info();
manifest::ParameterInfo intensity_info(const char* meaning);
manifest::ParameterInfo exponent_info(double preset);

}  // namespace gonio::light
