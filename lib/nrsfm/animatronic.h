// Simulated animatronics: deforming triangle meshes with points to follow. Each kind is one file in animatronics/ (the
// stem names the function, namespace gonio::nrsfm::animatronics); the build gathers them. Metres; z up.
#pragma once
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

struct DeformingSurface {
  std::vector<std::array<std::uint32_t, 3>> triangles;  // the same topology in every frame ...
  std::vector<std::vector<char>> removed;  // ... but for triangles that a tear has opened, by frame; or empty
  Shapes vertices_m;                       // 3F x V
  std::vector<std::uint32_t> tracked;      // vertices, or points on triangles:
  Shapes points_m;                         // 3F x P, on the surface of each frame
};

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

// Points that the surface itself hides from the camera, and points on faces that look away: F x P.
Visible self_occlusion(const DeformingSurface& surface, const std::vector<CameraFromObject>& cameras,
                       Projection projection);

}  // namespace gonio::nrsfm
