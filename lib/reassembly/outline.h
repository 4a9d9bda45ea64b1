// How one marker, a sphere, is seen in one photograph. Camera frame.
//
// A camera sees a sphere of radius r at distance d under the circular cone of half angle asin(r / d) about the ray to
// its centre. The cone cuts the picture in an ellipse (or, through a distorting lens, in something else), and the
// centre of that curve is not where the sphere's centre lies. Therefore the cone is what is fitted, to edge points that
// were turned into rays by the calibrated camera; a pixel is only where its axis meets the picture.
#pragma once
#include <string>

#include "geom/vector.h"

namespace gonio::reassembly {

struct Outline {
  Vec3 axis;  // unit: from the camera to the sphere's centre
  double half_angle_rad = 0;
  // Of (axis along `across`, axis along `down`, half angle), rad^2; across = normalized(cross({0, 1, 0}, axis)), down =
  // cross(axis, across): right-handed with the axis.
  Mat3 covariance_rad2;
  Vec2 centre_px;        // where the axis meets the picture
  double radius_px = 0;  // of the outline, mean
  double cover = 0;      // share of the outline that shows an edge: 1 where nothing hides it
  double rms_px = 0;     // of the edge points about the fitted curve
  double contrast = 0;   // step across the outline over the picture's noise
};

Vec3 across_of(Vec3 axis);  // the first tangent of covariance_rad2

// Distance of the centre from the camera where the radius is known: r / sin(half angle).
double distance_m(const Outline& outline, double radius_m);

}  // namespace gonio::reassembly
