// Volumes whose walls are known: closed forms of balls, slabs and tubes smeared by an isotropic normal function, with
// seeded noise that neighbours share, and the surfaces that a contour of them would be.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "geom/vector.h"
#include "io/volume.h"
#include "volume/contour.h"

namespace gonio::volume::phantom {

// Share of a voxel at `place` (index * scale) within; all smeared with sd `w`.
double ball(Vec3 place, Vec3 centre, double radius, double w);
double half_space(Vec3 place, Vec3 at, Vec3 normal, double w);  // within where (place - at) . normal < 0
// Discs smeared in two dimensions have no closed form: tabulated over the radius.
class Disc {
 public:
  Disc(double radius, double w);
  double at(double rho) const;

 private:
  std::vector<double> table_;
};

using Field = std::function<double(Vec3)>;
// Values at the voxels, and noise of sd `noise` whose correlation between direct neighbours is q (0 <= q < 1), of the
// shape q^(d^2).
io::VolumeData sampled(std::array<std::size_t, 3> size, const Field& field, double noise = 0, double q = 0,
                       std::uint64_t seed = 0, Vec3 scale = {1, 1, 1});
std::unique_ptr<io::VolumeSource> in_memory(io::VolumeData data);

// A surface by two parameters, m x n vertices, closed in the first: as dense as a contour, places given as indices.
struct Patch {
  Vec3 place{}, normal{};
};
Contour grid_surface(std::size_t m, std::size_t n, const std::function<Patch(double, double)>& at, Vec3 scale = {1, 1, 1});
Contour sphere_surface(Vec3 centre, double radius, Vec3 scale = {1, 1, 1});
Contour tube_surface(Vec3 centre, Vec3 axis, double radius, double length, bool inwards);
// Naive surface nets: a vertex in every cell that the threshold crosses, at the mean of the crossings. Closed at the
// border, not always manifold: enough to look for spheres on.
Contour rough_surface(const io::VolumeData& data, double threshold);
void append(Contour& to, const Contour& more);

}  // namespace gonio::volume::phantom
