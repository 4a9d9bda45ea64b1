// The parts of the search for markers (markers.h): candidates from the surface, edges from the volume, what makes a
// sphere a marker. Places are index * scale, in voxels of the smallest spacing.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/volume.h"
#include "volume/contour.h"
#include "volume/markers.h"
#include "volume/sampling.h"

namespace gonio::volume::marker {

// Vertices of a surface in a grid of cells, for what lies near a place.
class Cloud {
 public:
  Cloud(const Contour& surface, Vec3 scale);
  std::size_t size() const { return order_.size(); }
  Vec3 place(std::uint32_t v) const;
  Vec3 normal(std::uint32_t v) const;
  Vec3 low() const { return low_; }
  Vec3 high() const { return high_; }
  // Of the cells that a box touches.
  template <class Body>
  void for_each_near(Vec3 from, Vec3 to, const Body& body) const {
    std::array<std::size_t, 3> a{}, b{};
    for (int axis = 0; axis < 3; ++axis) {
      const double x = from[axis] - low_[axis], y = to[axis] - low_[axis];
      const auto at = static_cast<std::size_t>(axis);
      if (y < 0 || x >= static_cast<double>(cells_[at]) * cell) return;
      a[at] = x > 0 ? static_cast<std::size_t>(x / cell) : 0;
      b[at] = std::min(cells_[at] - 1, static_cast<std::size_t>(y / cell));
    }
    for (std::size_t k = a[2]; k <= b[2]; ++k)
      for (std::size_t j = a[1]; j <= b[1]; ++j) {
        const std::size_t row = (k * cells_[1] + j) * cells_[0];
        for (std::uint32_t n = starts_[row + a[0]]; n < starts_[row + b[0] + 1]; ++n) body(order_[n]);
      }
  }
  // Vertices of one cell of an octree after another, `edge` long; cells without any are left out.
  std::vector<std::vector<std::uint32_t>> patches(double edge, std::size_t at_most, std::uint64_t seed) const;

  static constexpr double cell = 4;

 private:
  const Contour& surface_;
  Vec3 scale_, low_{}, high_{};
  std::array<std::size_t, 3> cells_{};
  std::vector<std::uint32_t> starts_, order_;
};

// A sphere that the surface supports. Its radius is negative where the surface's outward normals point to the centre.
struct Candidate {
  Vec3 centre{};
  double radius = 0, cover = 0;
};
// Directions that are spread evenly (Fibonacci).
std::vector<Vec3> even_directions(std::size_t count);
std::vector<Candidate> candidates(const Cloud& cloud, const MarkerWish& wish);

// The box of voxels round a candidate.
struct Crop {
  Block block{};
  std::vector<float> values{};
};
std::vector<Crop> crops(io::VolumeSource& source, const std::vector<Candidate>& of, Vec3 scale);
// Room round a sphere that its crop holds.
double room_round(double radius);

// A sphere's edges in the volume.
struct RadialEdge {
  Vec3 direction{};
  double distance = 0, sigma = 0, air = 0, object = 0, width = 0;  // distance from the centre
};
struct Sphere {
  Vec3 centre{};                    // place
  double radius = 0, sigma_radius = 0;
  std::array<double, 9> covariance{};  // of the place
  double rms = 0, width = 0, noise = 0;
  std::size_t directions = 0;       // that were asked
  std::vector<RadialEdge> edges{};  // that were taken
  std::vector<bool> covered{};      // per direction
  std::vector<Vec3> asked{};
  double cover() const {
    return directions > 0 ? static_cast<double>(edges.size()) / static_cast<double>(directions) : 0;
  }
};
struct NoiseModel {
  double sd = 0, neighbour_correlation = 0;
};
// From differences of voxels well within the spheres, one to three apart.
NoiseModel noise_within(const std::vector<Candidate>& spheres, const std::vector<Crop>& crops, Vec3 scale,
                        std::optional<double> known_correlation);
// `radius`: held fixed where it is given.
Sphere refined(const Candidate& start, const Crop& crop, const NoiseModel& noise, Vec3 scale,
               std::optional<double> radius);

// What lies within and behind a sphere.
struct Evidence {
  double within = 0, centre = 0, air = 0;  // medians: of the ball, of its middle, of what lies round it
  double grown = 0;   // share of directions in which the sphere's own material goes on beyond it
  double unseen = 0;                       // share of directions that leave the volume
  double flatness = 1;                     // least second moment of the directions with an edge; 1/3 for a whole sphere
};
// `others`: what goes on into one of them does not count.
Evidence evidence(const Sphere& sphere, const Crop& crop, Vec3 scale, const std::vector<Candidate>& others);
// Why it is no marker; empty where it may be one. What speaks of the others is judged elsewhere.
std::string reason_against(const Sphere& sphere, const Evidence& evidence, const MarkerWish& wish);

}  // namespace gonio::volume::marker
