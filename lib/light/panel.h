// A rectangle that shines to one side: where it is, how it is met, and how it is seen from a point.
//
// Frame as in light/aimed.h: n away from the panel, x to the right and y up for who looks at it. Solid angle and
// uniform sampling of the directions in which a point sees it: Urena, Fajardo & King 2013, "An area-preserving
// parametrization for spherical rectangles", equations 1-9. Where the solid angle is below `small_sr`, the formula's
// differences of angles lose digits, and the area is drawn uniformly instead.
#pragma once
#include <optional>

#include "geom/vector.h"

namespace gonio::light {

struct Panel {
  Vec3 centre_m;
  Basis frame;
  double width_m, height_m;  // along x, y

  double area_m2() const { return width_m * height_m; }
  Vec3 at(double x, double y) const { return centre_m + frame.t * x + frame.b * y; }  // metres from the centre
  struct Meeting {
    double distance_m, cosine;  // of the emission angle
    double x, y;                // metres from the centre
  };
  // A ray that comes from the shining side.
  std::optional<Meeting> meet(Vec3 origin_m, Vec3 direction) const;
};

// A panel as a point in front of it sees it.
class PanelView {
 public:
  static constexpr double small_sr = 1e-3;
  PanelView(const Panel& panel, Vec3 point_m);
  bool seen() const { return height_m_ > 0; }
  double solid_angle() const { return solid_angle_; }
  bool by_area() const { return solid_angle_ < small_sr; }
  // Density per steradian of draw() in a direction in which the panel is met.
  double pdf(double distance_m, double cosine) const {
    return by_area() ? distance_m * distance_m / (panel_.area_m2() * cosine) : 1 / solid_angle_;
  }
  Vec2 draw(Vec2 u) const;  // x, y on the panel

 private:
  const Panel& panel_;
  double height_m_;           // of the point above the panel's plane
  double x0_, x1_, y0_, y1_;  // the panel's edges, from the foot of the point
  double b0_ = 0, b1_ = 0, k_ = 0, solid_angle_ = 0;
};

}  // namespace gonio::light
