// Lamps among the surroundings: small bright regions of what balls show, as lights with a place or a direction.
//
// A region is a connected set of pixels above `ratio` times the mean radiance, no larger than `largest_rad`, that
// bring `least_share` of all light or more, with the pixels about them, through which its edge runs. Its middle,
// weighted by radiance and solid angle, is one ray: from a point of the ball into a direction. Its irradiance is the
// sum of radiance above its border's, times solid angle; its half angle that of an even disc of the same second moment.
// Rays of different balls or views that meet in one place are one lamp: direction u and inverse distance q from the
// balls' middle o, by least squares of
//   direction_i - (u - q (p_i - o)) / |u - q (p_i - o)|
// in two tangents each, whitened; q = 0 is infinitely far. A lamp has a place where q exceeds `least_z` of its standard
// deviations, else a direction. Neighbouring rays leave a convex mirror as if they came from f behind it, 1 / f = 1 / s
// + 2 / (R cos i) in the plane of incidence and 1 / s + 2 cos i / R across it, s the eye's distance: what a lamp at the
// distance d sends is its radiance times its solid angle times (d + f)(d + f'). Covariances are those of the balls'
// places (each moved by its standard deviations; all views of a ball share them), of the pixels' noise where it is
// stated, of the middle among its own pixels, and of surroundings that are not even. World frame.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "probe/unwrap.h"

namespace gonio::probe {

struct LightWish {
  double ratio = 10;
  double largest_rad = 20 * pi / 180;  // half angle
  double least_share = 0.01;           // of the irradiance of all directions together, summed without cosines
  double least_z = 5;
};

// What one standard deviation of the ball's place, in one of its independent directions, does to a highlight. All
// highlights on this ball share it.
struct BallShift {
  Vec3 turn{};  // of the direction: tangential
  Rgb more{};   // of the irradiance
};
struct Highlight {  // one region of one view
  std::size_t view = 0, ball = 0;
  std::vector<std::size_t> pixels{};
  Vec3 point_m{}, direction{};  // the ray
  Vec2 focus_m{};               // behind the point, where its neighbours seem to come from: tangential, sagittal
  Mat3 covariance{{}};          // of the direction: tangential
  Mat3 own_covariance{{}};      // of the same, were the ball's place known exactly
  std::vector<BallShift> shifts{};
  Rgb irradiance{}, irradiance_sigma{}, background{};
  Rgb own_irradiance_variance{};  // were the ball's place known exactly
  double half_angle_rad = 0;
  bool clipped = false;
  bool cut = false;  // by the rim or a mask: its middle may be off by its half angle, and its light is a part
};
std::vector<Highlight> highlights(const std::vector<BallView>& views, const std::vector<Facing>& faces,
                                  std::size_t view, const LightWish& wish);

struct FoundLight {
  std::vector<std::size_t> seen{};  // places in the list of highlights
  Vec3 direction{};                 // unit, from the balls' middle
  Mat3 direction_covariance{{}};
  std::optional<Vec3> position_m{};
  Mat3 position_covariance_m2{{}};
  double distance_m = 0;                                // from the balls' middle; infinite without a place
  double nearness_per_m = 0, nearness_sigma_per_m = 0;  // one over the distance as it was fitted, whatever it is worth
  Rgb irradiance{}, irradiance_sigma{};
  double half_angle_rad = 0;
  bool clipped = false;
  double chi_square = 0;
  int degrees = 0;
};
// Highlights that belong together, as lamps, brightest first. `middle_m`: of the balls.
std::vector<FoundLight> lights_of(const std::vector<Highlight>& all, Vec3 middle_m, const LightWish& wish);

// Those that every view which shows their place has among its highlights. Others would leave the picture in some views
// and stay in the rest, and count twice: a window whose bars are seen in one view alone, the reflection of a tripod.
std::vector<FoundLight> agreed(const std::vector<FoundLight>& lights, const std::vector<Highlight>& all,
                               const std::vector<BallView>& views, const std::vector<Facing>& faces);

// The pixels of these lights' highlights take the level of their borders.
void take_out(const std::vector<FoundLight>& lights, const std::vector<Highlight>& all, std::vector<Facing>& faces);

}  // namespace gonio::probe
