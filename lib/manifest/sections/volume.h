// "volumes": samples on a grid, of a tomograph, and what was made of them. "markers": spheres glued to an object.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manifest/parameter.h"

namespace gonio::manifest {

struct IndexMap {  // index (i, j, k), voxel centres at integers -> metres in the object's frame
  std::vector<std::vector<double>> matrix{};  // 4 x 4, its rows; the last is 0 0 0 1
};
struct VolumeStep {    // one step that ct-mesh-clean took, in order
  std::string name{};  // "look", "cupping", "threshold", ...
  std::string how{};   // in words
  std::map<std::string, double> figures{};
  std::string picture{};  // file id
};
struct Volume {                       // "volumes"
  std::string file{};                 // file id: the head, or the first slice
  std::vector<std::string> slices{};  // file ids of the others, where there are several files
  std::vector<std::int64_t> size{};   // voxels [i, j, k]
  std::vector<double> spacing_m{};    // [i, j, k]
  std::optional<IndexMap> volume_from_index{};
  std::string type{};                 // of the samples: "uint16"
  std::vector<std::int64_t> tiles{};  // of an atlas: [columns, rows]
  std::string value{};                // what its values mean: "hounsfield", "attenuation", ...
  std::optional<double> threshold{};  // inside is above it
  std::string connectivity{};         // of the inside: "6" | "26"
  Sigmas sigma{};                     // of the threshold
  std::string mesh{};                 // name in meshes: the surface that was made
  std::string reference{};            // name in meshes: its shape from elsewhere, which explain holds it against
  std::string markers_mesh{};         // name in meshes: the markers' surface
  std::vector<VolumeStep> steps{};
  std::optional<bool> sound{};  // closed, 2-manifold, oriented, no self-intersection
};

struct Marker {  // "markers"
  std::string id{};
  std::string object{};  // whose frame centre_m is given in; empty: the volume's
  std::string volume{};  // name in volumes where it was found
  std::vector<double> centre_m{};
  std::optional<double> radius_m{};
  std::vector<double> covariance_m2{};       // of the centre, 3 x 3, row by row
  Sigmas sigma{};                            // of the radius
  std::optional<double> cover{};             // share of the sphere's directions that show its surface
  std::vector<std::string> seen_in{};        // images
  std::vector<std::vector<double>> pixel{};  // where its centre is seen, [x, y] for each of them
};

}  // namespace gonio::manifest
