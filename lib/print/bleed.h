// Light that a projector's pixels send to their neighbours: through the lens, and scattered by resin and membrane.
//
// About a point of light, over the platform,
//   K(r) = (1 - share) exp(-r^2 / (2 sigma^2)) / (2 pi sigma^2) + share (1 + r^2 / w^2)^(-3/2) / (2 pi w^2),
// a Gaussian core and Moffat's profile with beta = 3/2 (A&A 3, 1969), whose light beyond r falls with 1 / r only: tails
// of real projectors are nearer to Lorentzian than to Gaussian. A pixel is a square of even light; what it sends to a
// point is K's integral over the square, in closed form: error functions, and for the tail the solid angle of a
// rectangle,
//   integral of w / (2 pi (w^2 + x^2 + y^2)^(3/2)) over [0, x] x [0, y] = atan(x y / (w sqrt(w^2 + x^2 + y^2))) / 2 pi.
// The sums over all pixels are 1. Beyond the picture it is dark.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "geom/vector.h"

namespace gonio::print {

struct Bleed {
  double sigma_m = 0, tail_share = 0, tail_m = 0;
  bool none() const { return !(sigma_m > 0) && !(tail_share > 0 && tail_m > 0); }
  // Light at `offset_m` from the centre of a pixel that alone is lit, by 1.
  double at(Vec2 offset_m, Vec2 pixel_m) const;
};

// The light of whole pictures of one size, spread: a narrow core by sums along rows and columns, all else by Fourier
// transforms, whatever the width of the tails.
class Spread {
 public:
  // Light is asked for at `offset_px` from every pixel's centre.
  Spread(const Bleed& bleed, Vec2 pixel_m, int width_px, int height_px, Vec2 offset_px = {0, 0});
  ~Spread();
  Spread(Spread&&) noexcept;
  // Row by row, width x height; `light` and `spread` may be the same.
  void operator()(std::span<const float> light, std::span<float> spread) const;
  // Its transpose: what a change of every pixel's light changes at the points, weighed by `at`, as slopes by the
  // pixels.
  void backwards(std::span<const float> at, std::span<float> slopes) const;

 private:
  struct Kernel;
  void filtered(std::span<const float> from, std::span<float> to, bool backwards) const;
  int width_, height_;
  std::unique_ptr<Kernel> kernel_;  // null: nothing spreads
};

}  // namespace gonio::print
