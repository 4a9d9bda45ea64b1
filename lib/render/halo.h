// What a picture sends into the halo about a pixel: its convolution with
//   k(r) = (1 + r^2 / R^2)^(-3/2) / (2 pi R^2),   r in pixels,
// Moffat's profile (A&A 3, 1969) with beta = 3/2. Its integral over the plane is one and its Fourier transform is
// exp(-2 pi R |f|), so that the halo of a halo has the radii added: k_R * k_S = k_(R + S). The sum over pixels is that
// integral but for 4 exp(-2 pi R): 0.8 % at a pixel's radius, nothing at two. Outside the picture it is dark.
//
// Summed over squares of 3^n pixels a side, nine by nine of each size about the pixel with the middle nine left to the
// next finer size, each square by its mean from an integral picture, those that a border cuts by their nine parts. A
// square's side is at most two thirds of its distance and the kernel is averaged over it; what is left is the
// unevenness of the picture within far squares, a hundredth of the halo.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "io/image.h"

namespace gonio::render {

class Halo {
 public:
  // Values that are not finite count as dark. Radii >= 1 px.
  Halo(const io::Image& picture, std::span<const double> radii_px);
  // Without the pixel's own part: one value for each radius and channel, channel by channel within a radius.
  std::vector<double> around(int x, int y) const;
  // Weight of the pixel itself.
  static double own_share(double radius_px);

 private:
  double box(int left, int top, int right, int bottom, std::size_t channel) const;  // sum, both ends inside
  int width_, height_;
  std::size_t channels_, radii_;
  int sizes_ = 1;                // of squares
  std::vector<double> sums_;     // integral picture, a row and a column more than the picture
  std::vector<double> weights_;  // [size][row][column of the 9 x 9][radius]: mean of the kernel over the square
  std::vector<double> parts_;    // [size but the first][row][column][radius][part]: over a ninth of it
};

}  // namespace gonio::render
