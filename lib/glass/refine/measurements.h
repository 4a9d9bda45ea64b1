// What views say about a body, pixel by pixel, and how well a body explains it. Cell coordinates of the body's field.
//
// outline  near the mask's edge: the greatest value of the field along the pixel's ray, over what a pixel is worth
//          there, is the ray's distance from the outline. Farther off only the wrong side counts.
// front, back  a network's normals, of the first surface and where the straight ray leaves last
// light    s0, s1, s2 of a pixel against what it sees through two refractions (two_refractions.h). Pixels whose ray is
//          totally reflected, or meets the body again, count as badly explained and say nothing about how to mend it
//
// floor    points below what it stands on are not inside
//
// Costs are robust: of the normals and outlines pseudo-Huber's, of the light Geman and McClure's, which is bounded.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "glass/refine/march.h"
#include "glass/refine/normal_equations.h"
#include "glass/refine/two_refractions.h"
#include "glass/refine/view.h"

namespace gonio::glass {

enum class Kind { outline, front, back, light, floor };
struct Measurement {
  Kind kind = Kind::outline;
  std::size_t view = 0;
  int x = 0, y = 0;
  Vec3 point_m{};  // floor
};

struct Sigmas {
  double outline_px = 0.35;  // at least; masks that contradict each other have more
  // Of a prediction, as a share of the screen's mean: what two refractions leave out. Neighbours err alike.
  double light_share = 0.15;
  double normals_px = 5;    // a network's errors hang together over so many pixels
  int normals_step = 3;     // pixels between normals that are taken
  int light_most = 700;     // pixels of a view
  double light_margin = 2;  // px from the outline
};

class Measuring {
 public:
  Measuring(std::span<const View> views, const Sigmas& sigmas) : views_(views), sigmas_(sigmas) {}

  std::vector<Measurement> outlines(std::size_t view) const;
  std::vector<Measurement> normals(std::size_t view) const;  // none where no network saw it
  std::vector<Measurement> lights(std::size_t view) const;

  std::vector<Measurement> floor(const SplineField& field, double z_m) const;

  // `variance`: of the screen's picture within the blur, where the ray first found it: a descent has to hold on to it,
  // or costs would not compare. Negative: not known yet, and written.
  struct Asked {
    const SplineField& field;
    Glassy glass;
    double blur_px = 1;
  };
  double cost(const Asked& asked, const Measurement& measurement, double& variance, Rows* rows) const;
  // How far outlines are off, in pixels, as the standard deviation that their median speaks for: what masks that
  // contradict each other leave, whatever the body.
  double outline_misfit_px(const Asked& asked, std::span<const Measurement> measurements) const;
  void set_outline_sigma(double px) { sigmas_.outline_px = px; }
  // Mean over the pixels of a view of the bounded cost of the light, 0 to 1: explained not at all.
  double unexplained(const Asked& asked, std::size_t view) const;

  PixelRay ray(const SplineField& field, std::size_t view, int x, int y) const;
  const View& view(std::size_t number) const { return views_[number]; }

  // The ray's two crossings; false where it has none, or (light) others.
  struct Path {
    SurfacePatch first, second;
    Vec3 beyond{};  // direction of what leaves, refracted
  };
  bool straight(const SplineField& field, const PixelRay& ray, Path& path) const;
  bool refracted(const SplineField& field, const PixelRay& ray, double index, Path& path) const;

 private:
  double outline_cost(const Asked& asked, const Measurement& m, Rows* rows) const;
  double normal_cost(const Asked& asked, const Measurement& m, Rows* rows) const;
  double floor_cost(const Asked& asked, const Measurement& m, Rows* rows) const;
  bool hidden(const SplineField& field, std::size_t view, const Path& path) const;
  double light_cost(const Asked& asked, const Measurement& m, double& variance, Rows* rows) const;

  std::span<const View> views_;
  Sigmas sigmas_;
};

}  // namespace gonio::glass
