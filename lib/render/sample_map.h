// Where samples go: a pass takes more of them in pixels whose noise counts, and fewer where there is little; and from
// the first surface that they meet two paths go on instead of one where that pays.
//
// The relative mean square error of a picture, mean of v_i / (n_i (y_i^2 + f^2)) over pixels of variance v_i per
// sample, is least for a given amount of work, sum of n_i c_i, where n_i is proportional to
// sqrt(v_i / c_i / (y_i^2 + f^2)) (Neyman 1934). f, a tenth of the picture's mean, keeps black pixels from asking for
// everything. The work c_i of a sample is counted in rays: one, and two for every event of scattering.
//
// A sample is the sum of what it finds up to its first event (near) and beyond (far). With s paths onward from there
// its variance is v_near + (v - v_near) / s, its work c_near + s c_far; the s that makes their product least is chosen
// (Bolin & Meyer 1997; Rath et al. 2022, "EARS"). Splitting only: roulette (s < 1) does not pay, because a pass' order
// takes most of the near part's noise away, and nothing of what roulette adds.
//
// All these are estimated by a pilot: four replicates of half a pass, at most four samples, thrown away afterwards, so
// that the picture's own samples know nothing of their numbers and its means and variances stay without bias (Kirk &
// Arvo 1991). They are averaged over 3 x 3 pixels. A fifth of the picture's mean relative variance is added to that of
// every pixel: where rare bright paths, of which a pilot sees few and in the wrong places, make most of the noise,
// samples become even.
//
// n_i is a power of two times a pass' samples, from a quarter to eight times, so that a pass stays a low-discrepancy
// set in every pixel; all together they are about as much work as a pass' samples in every pixel. Nothing depends on
// the picture's seed or on which passes are rendered: shares of a picture agree.
#pragma once
#include <cstdint>
#include <vector>

#include "geom/vector.h"

namespace gonio::render {

class Integrator;

class SampleMap {
 public:
  // `preset`: samples of a pass, a power of two.
  SampleMap(const Integrator& integrator, int width_px, int height_px, int preset);
  int samples(int x, int y) const { return pixels_[place(x, y)].samples; }
  // Paths onward, at the position `pixel` of the picture.
  double onward(Vec2 pixel) const {
    return pixels_[place(static_cast<int>(pixel.x + 0.5), static_cast<int>(pixel.y + 0.5))].onward;
  }

 private:
  struct Pixel {
    std::uint16_t samples = 1;
    float onward = 1;
  };
  std::size_t place(int x, int y) const {
    const auto within = [](int v, int size) { return static_cast<std::size_t>(v < 0 ? 0 : v < size ? v : size - 1); };
    return within(y, height_px_) * static_cast<std::size_t>(width_px_) + within(x, width_px_);
  }

  int width_px_, height_px_;
  std::vector<Pixel> pixels_;
};

}  // namespace gonio::render
