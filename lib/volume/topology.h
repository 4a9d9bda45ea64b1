// What is connected to what in a volume that was cut by a threshold, counted from its voxels alone: components,
// enclosed cavities, the Euler number. Independent of volume/contour.h, whose surfaces are held against it.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/volume.h"
#include "volume/contour.h"

namespace gonio::volume {

// Euler number of the solid (components - tunnels + cavities) by counting vertices, edges, faces and cells of the
// cubical complex (Kong & Rosenfeld 1989), slice by slice. `inside` as in contour.h.
std::int64_t euler_number(io::VolumeSource& source, double threshold, Connectivity inside);

struct Component {
  std::uint32_t id = 0;  // 1 is the largest
  std::uint64_t voxels = 0;
  std::array<std::size_t, 3> low{}, high{};  // bounding box in voxels, both inclusive
  Vec3 centroid{};                           // index coordinates
  double mean_value = 0, sd_value = 0;
  bool touches_border = false;
  bool enclosed = false;  // every way from it to the volume's border crosses another component
  bool light = false;     // split off: nothing of it is near a core
};

// Runs of voxels and a union-find over them: memory grows with the number of runs, not of voxels.
struct Components {
  std::vector<Component> list;  // by size, largest first; equal sizes by first voxel
  // Runs of row (j, k), sorted by i: [first, last] belong to component id.
  struct Run {
    std::uint32_t first, last, id;
  };
  std::vector<std::size_t> row_starts;  // size[1] * size[2] + 1 entries into `runs`
  std::vector<Run> runs;
  std::uint32_t at(std::size_t i, std::size_t j, std::size_t k) const;  // 0: outside
  std::array<std::size_t, 3> size{};
};
Components components(io::VolumeSource& source, double threshold, Connectivity inside);

// The same of what is farther than `reach` steps over faces, all above the threshold, from values above `core`, and of
// what is not, each by itself: a lighter table apart from the piece that stands on it.
struct SplitWish {
  double core = 0;
  std::size_t reach = 3;  // voxels within which an edge falls from `core` to the threshold
};
Components split_components(io::VolumeSource& source, double threshold, Connectivity inside, const SplitWish& wish);

// Of directions spread over the sphere, the share in which straight ways from the component's middle to the volume's
// border cross another component: 1 where it is enclosed, and nearly so in a pot whose spout is open.
double surrounded_share(const Components& all, const Component& one);

// Which components stay. Rules are tried in the order of the members; empty rules keep everything.
struct KeepRule {
  std::size_t largest = 0;  // 0: all
  std::uint64_t at_least_voxels = 0;
  std::optional<double> above_mean{}, below_mean{};                    // of the component's values
  std::optional<std::array<std::array<double, 3>, 2>> touching_box{};  // index coordinates: low, high
  bool drop_enclosed = false;                                          // and what is surrounded for nine tenths
  bool drop_touching_border = false;
};
struct Kept {
  std::vector<bool> keep;           // by position in Components::list
  std::vector<std::string> reason;  // "kept: largest", "dropped: 12 voxels, fewer than 100"
};
Kept chosen(const Components& all, const KeepRule& rule);

// The volume with what was not kept set to `outside`, read through from `source`, which must outlive it: voxels of
// dropped components, and of the 26 neighbours of each those that neither belong to a kept component nor touch one
// (those say where the kept one's wall is).
std::unique_ptr<io::VolumeSource> only(io::VolumeSource& source, const Components& all, const Kept& kept,
                                       float outside);

}  // namespace gonio::volume
