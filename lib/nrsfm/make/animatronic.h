// Simulated animatronics: deforming triangle meshes with points to follow. Each kind is one file in animatronics/ (the
// stem names the function, namespace gonio::nrsfm::animatronics); the build gathers them. Metres; z up.
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

struct AnimatronicOptions {
  Eigen::Index frames = 60;
  Eigen::Index points = 100;
  std::uint64_t seed = 1;
};

// A point of the material: on `triangle`, with the weights b1, b2 of its second and third corner.
struct Anchor {
  std::uint32_t triangle = 0;
  double b1 = 0, b2 = 0;
};

// Its place, of vertices in columns: three rows for one frame, or three for each of several.
template <class Vertices>
Eigen::Matrix<double, Vertices::RowsAtCompileTime, 1> on_triangle(const Vertices& vertices_m,
                                                                  const std::array<std::uint32_t, 3>& corners,
                                                                  double b1, double b2) {
  return (1 - b1 - b2) * vertices_m.col(corners[0]) + b1 * vertices_m.col(corners[1]) + b2 * vertices_m.col(corners[2]);
}

// A rigid part of the rig that holds and moves a surface: it hides what is behind it, and nothing is followed on it.
struct RigBox {
  Eigen::Vector3d half_m = Eigen::Vector3d::Zero();
  Eigen::Isometry3d world_from_box = Eigen::Isometry3d::Identity();
};
inline RigBox upright_box(const Eigen::Vector3d& centre_m, const Eigen::Vector3d& half_m) {
  return {half_m, Eigen::Isometry3d(Eigen::Translation3d(centre_m))};
}
bool inside(const RigBox& box, const Eigen::Vector3d& point_m, double margin_m = 0);
using Rig = std::vector<RigBox>;

struct DeformingSurface {
  std::vector<std::array<std::uint32_t, 3>> triangles;  // the same in every frame; a tear parts corners that coincide
  Shapes vertices_m;                                    // 3F x V
  std::vector<Anchor> anchors;                          // of the points that are followed
  Shapes points_m;                                      // 3F x P, on the surface of each frame
  std::vector<Rig> rig;                                 // of each frame, the same boxes in the same order; or empty
  double residual = 0;  // of simulated ones: largest unbalanced force over the largest force, over all frames
  Eigen::Index frames() const { return vertices_m.rows() / 3; }
};
// Where the anchors are on the frames of `vertices_m`.
Shapes anchored(const DeformingSurface& surface);

struct AnimatronicInfo {
  std::string id;        // "bending"
  std::string sentence;  // what deforms, how it is driven
  std::string source;    // of the mechanics
};
class Animatronic {
 public:
  virtual ~Animatronic() = default;
  virtual const AnimatronicInfo& info() const = 0;
  virtual DeformingSurface make(const AnimatronicOptions& options) const = 0;
};
std::span<const Animatronic* const> all_animatronics();  // sorted by id; defined in a generated source
const Animatronic* find_animatronic(const std::string& id);

}  // namespace gonio::nrsfm
