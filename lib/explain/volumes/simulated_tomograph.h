// A tomograph in small: what a detector reads of the believed shape over half a turn, what mechanisms make of that, and
// what filtered back-projection makes of any readings at single places.
//   f(x, y) = pi / views sum_a sum_m h(u - m) r(a, m),  h(0) = 1 / 4c, h(odd) = -1 / (pi^2 n^2 c)   per bin c
// Kak & Slaney 1988, equations 3.61 and 3.71. Readings are metres of the shape; with the tomograph's own the share of
// the shape comes back, as a tomograph sees it.
#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "explain/volumes/line_integrals.h"

namespace gonio::explain::volumes {

using Readings = std::vector<float>;  // Detector::line(slice, view) + bin

class Tomograph {
 public:
  static constexpr std::size_t most_cells = 192;
  static bool is_fine_for(std::array<std::size_t, 3> size) {
    return *std::max_element(size.begin(), size.end()) <= most_cells;
  }
  // For a volume of `size` voxels: views as half the circumference of a slice has pixels. Pixels are voxels, or
  // larger where a side has more than `most` of them.
  Tomograph(const mesh::Mesh& mesh, std::array<std::size_t, 3> size, Vec3 spacing_m, double per_m,
            std::span<const Ball> markers = {}, std::size_t most = most_cells);
  bool is_fine() const { return fine_; }         // a pixel a voxel
  double longest_m() const { return longest_; }  // of all line integrals of the shape
  const Detector& detector() const { return detector_; }
  // What pixels read: minus the logarithm of the intensity, over per_m.
  Readings read() const;
  // What they lack, for each unit of the amount (or of the one given): equations of lib/volume/mechanisms.
  Readings lack_by_hardening() const;
  Readings lack_by_streak() const;
  std::vector<Readings> lack_by_floor(std::span<const double> floors) const;
  // `spread`: sd in pixels along the slices, as many metres across them; `variance`: of the spectrum.
  Readings lack_by_blur(double spread, double variance) const;
  // Scattered photons are spread by a Gaussian an eighth of the detector wide.
  std::vector<Readings> lack_by_scatter(std::span<const double> shares) const;

  // Four at a time cost as much as one.
  std::vector<std::array<float, 4>> reconstructed(std::span<const Readings> four, std::span<const Vec3> places_m) const;
  // The mean over the views of readings through each place.
  std::vector<double> mean_reading(const Readings& values, std::span<const Vec3> places_m) const;

 private:
  Detector detector_;
  std::size_t across_ = 0;
  double per_m_ = 1, longest_ = 0;
  bool fine_ = true;
  std::vector<float> intensity_;
  std::vector<float> without_;  // markers; empty where there are none
};

}  // namespace gonio::explain::volumes
