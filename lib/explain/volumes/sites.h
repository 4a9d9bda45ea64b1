// Places on the believed surface at which a volume is read, and readings there. Private to volumes/.
#pragma once
#include <optional>
#include <vector>

#include "explain/volumes/believed_body.h"
#include "explain/volumes/observed.h"
#include "mesh/triangle_tree.h"
#include "volume/threshold.h"

namespace gonio::explain::volumes {

struct Site {
  Vec3 at_m{}, normal{};          // scanner's frame
  double curvature = 0;           // 1/voxel, positive where the surface bulges
  double behind = 0, before = 0;  // to the next wall along the normal, voxels; at most `far_voxels`
};
inline constexpr double far_voxels = 60;

// About `count` places, evenly by area, on walls that are at least `thinnest_voxels` thick, as far from the next.
inline constexpr double thinnest_voxels = 2;
std::vector<Site> sites_of(const mesh::Mesh& mesh, const mesh::TriangleTree& tree, double voxel_m, std::size_t count);
mesh::Mesh moved(mesh::Mesh mesh, Vec3 turn_rad, Vec3 shift_m);

// A volume that is sampled: trilinear, in the scanner's frame.
class Sampled {
 public:
  Sampled(const io::VolumeData& volume, Vec3 spacing_m);
  double at(Vec3 scanner_m) const;  // NaN outside
  bool within(Vec3 scanner_m, double margin_voxels) const;
  Vec3 index_of(Vec3 scanner_m) const;
  Vec3 place_of(Vec3 index) const;
  const io::VolumeData& volume() const { return volume_; }
  Vec3 spacing_m() const { return spacing_m_; }
  double voxel_m() const { return voxel_m_; }
  double field_m() const { return field_m_; }
  Vec3 extent_m() const { return extent_m_; }

 private:
  const io::VolumeData& volume_;
  Vec3 spacing_m_, middle_, extent_m_;
  double voxel_m_, field_m_;
};

struct Values {  // of the volume
  double air = 0, material = 0, noise = 0;
};
// Medians of voxels that the believed shape holds wholly or not at all; where walls are too thin to have such voxels,
// the material's from means over boxes round the sites, which blur does not change: what they have beyond air, over the
// share of the shape in them. Error(data) where there are too few, or where the two do not differ by three widths of
// the noise.
Values values_of(const Sampled& sampled, const Body& body, const std::vector<Site>& sites, const std::string& place);

// The profile along the normal: as far as a wall that is too near to be left out, and beyond it.
inline constexpr double profile_step = 0.5;
struct ProfileRange {
  double low = 0, high = 0;  // voxels
};
inline ProfileRange profile_range(const Site& site, double reach) {
  return {site.behind < 2 * reach ? -std::min(2 * reach, site.behind + reach) : -reach,
          site.before < 2 * reach ? std::min(2 * reach, site.before + reach) : reach};
}
// The edge at a site. `reach`: half the profile, voxels.
volume::Edge edge_at(const Sampled& sampled, const Site& site, const Values& values, double reach);

// Fills Row::ring of the grey values; returns the root mean square of what it filled in before that was scaled to one.
double add_rings(const Sampled& sampled, const Body& body, const Values& values, std::vector<Row>& rows);

}  // namespace gonio::explain::volumes
