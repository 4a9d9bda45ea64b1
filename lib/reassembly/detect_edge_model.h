// What a sharp outline looks like after blur, as functions of the distance t from it (pixels, inwards positive).
//
// The grey value outside is a plane; inside another plane is added, and the limb term: a sphere's normal leans towards
// the viewer by sqrt(1 - (1 - t/r)^2), t from the limb, so that the shading of a matt sphere begins with a vertical
// tangent there. Without that term a lamp beside the camera pulls every edge inwards. Blur is Gaussian; a curved edge
// of radius R keeps to first order the profile of a straight one, moved inwards by s^2 / (2R) (the Laplacian's 1/R d/dt
// integrated over s^2 / 2).
#pragma once
#include <vector>

namespace gonio::reassembly {

struct Blurred {
  double value = 0, slope = 0, bend = 0;  // slope and bend: first and second derivative in t
};
Blurred blurred_step(double t, double blur);  // 1 inside, 0 outside
Blurred blurred_ramp(double t, double blur);  // t inside, 0 outside

// The limb term of a sphere whose outline has `radius` pixels, tabled between two distances.
class BlurredLimb {
 public:
  BlurredLimb(double radius, double blur, double from, double to);
  Blurred at(double t) const;

 private:
  double from_, step_;
  std::vector<Blurred> table_;
};

}  // namespace gonio::reassembly
