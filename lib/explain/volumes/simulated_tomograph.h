// A tomograph in small: line integrals of a body in the slices' plane over half a turn, and what filtered
// back-projection makes of any function of them at single places.
//   p(a, u) = integral of the share along the ray at x cos a + y sin a = u
//   f(x, y) = pi / views sum_a sum_m h(u - m) g(p(a, m)),  h(0) = 1 / 4c, h(odd) = -1 / (pi^2 n^2 c)   per cell c
// Kak & Slaney 1988, equations 3.61 and 3.71. With g(p) = p the share comes back.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "explain/volumes/believed_body.h"

namespace gonio::explain::volumes {

class Tomograph {
 public:
  explicit Tomograph(const Body& body, std::size_t views = 120);
  double longest_m() const { return longest_; }  // of all line integrals
  // The reconstruction of g(p), p in metres, at places of the scanner's frame.
  std::vector<double> reconstructed(const std::function<double(double)>& g, std::span<const Vec3> places_m) const;
  // The reconstruction of ln(1 + s exp(p) G * (p exp(-p))) / (s per_m) with p = per_m times the path, for each share s:
  // what single scattering takes from line integrals, over its share. G: a wide Gaussian over columns and slices, an
  // eighth of the grid's width.
  std::vector<std::vector<double>> scattered(double per_m, std::span<const double> shares,
                                             std::span<const Vec3> places_m) const;
  // The mean over the views of the line integrals through each place, metres.
  std::vector<double> mean_path(std::span<const Vec3> places_m) const;

 private:
  std::vector<double> back_projected(const std::vector<float>& lines, std::span<const Vec3> places_m) const;
  std::vector<double> gathered(const std::vector<float>& sinogram, std::span<const Vec3> places_m) const;
  std::size_t bins_, slices_, views_, across_;
  double cell_, first_z_, cell_z_, longest_ = 0;
  std::vector<double> cosine_, sine_;
  std::vector<float> paths_;  // slice, view, bin
};

}  // namespace gonio::explain::volumes
