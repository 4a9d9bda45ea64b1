// The contrast experiment of Luongo et al. 2017, section 4: a camera that tilts over a flat sample, a lamp fixed to it
// at a constant angle, and a micro-structure that is turned about the sample's normal between two photographs.
//
// Sample's frame: z the normal; the camera tilts in the plane of x and z. Light plane `across`: the lamp stands beside
// the camera, towards +y, out of the plane of tilt; `along`: it lies in that plane, ahead of the camera towards +x.
// What decides for `across`: in the plane of tilt the half vector leans by tilt + light / 2, so that the tilts 0 and
// -light are mirror images and, over both pairs 0-90 and 90-180, have one mean; then zero tilt can be no maximum,
// which both their measurements and their predictions have it be. At a rotation of 0 facets that face +y (a model's v
// at azimuth 0) lean towards the lamp where it is across; where it is along, the sample is turned by -90 degrees so
// that they do so there, too.
//
// The signal is the radiance over the lamp's normal irradiance, f cos(theta_i), in 1/sr: the radiant exposure of the
// sensor up to a constant k. Contrast of a pair of rotations, of signals a and b:
//   difference  |a - b|                "evaluated as the difference between the measurements"; per k, in 1/sr
//   michelson   |a - b| / (a + b)
// A checker of two perpendicular orientations, seen at one rotation phi, has the contrast of the pair (phi, phi + 90).
#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "geom/angle.h"
#include "geom/vector.h"

namespace gonio::contrast {

enum class LightPlane { across, along };
enum class Definition { difference, michelson };

struct Experiment {
  double light_rad = 10 * degree;  // from the camera
  LightPlane plane = LightPlane::across;
  std::vector<double> tilts_rad{-20 * degree, -10 * degree, 0, 10 * degree, 20 * degree};
  std::vector<std::pair<double, double>> pairs_rad{{0, pi / 2}, {pi / 2, pi}};
  // Half angles of the discs over which lamp and lens are averaged; 0: points.
  double light_spread_rad = 0, camera_spread_rad = 0;
  // Diffuse reflectance of light that comes from beneath whatever the rotation is; adds veil / pi cos(theta_i).
  double veil = 0;
  Definition definition = Definition::difference;
};

struct View {  // unit vectors in the sample's frame turned back by the rotation: what a model at azimuth 0 sees
  Vec3 wo, wi;
};
View view_of(const Experiment& experiment, double tilt_rad, double rotation_rad);

// The mean of what a reflectance f(wo, wi) in 1/sr sends to the camera, f cos(theta_i) + veil.
using Reflectance = std::function<double(Vec3 wo, Vec3 wi)>;
double signal(const Experiment& experiment, const Reflectance& f, double tilt_rad, double rotation_rad);

double difference_of(double a, double b);
double michelson_of(double a, double b);  // 0 where both are dark
double contrast_of(Definition definition, double a, double b);

// Error(usage) at the option for angles that leave a view below the horizon, empty lists, pairs of one rotation.
void check(const Experiment& experiment);

std::string pair_name(const std::pair<double, double>& pair_rad);  // "0-90"
std::string degrees_text(double rad);                              // "-20"

}  // namespace gonio::contrast
