// "meshes": shapes of objects.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gonio::manifest {

struct MeasuredMesh {  // what cloud-mesh says of a mesh that it made
  std::vector<std::string> clouds{};
  std::string chain{};                                 // "gonio" | "thesis"
  std::optional<double> sigma_m{};                     // median of the vertices' standard deviations
  std::optional<double> rms_m{}, median_m{}, p95_m{};  // of the points off the mesh, along its normals
  std::optional<double> whitened{};                    // rms of that over what the points' covariances say
  std::optional<double> noise_ratio{};                 // what points scatter by, over what they state
  std::int64_t points = 0, bare = 0;                   // that were given; that have no surface beside them
  std::int64_t components = 0, dropped = 0;
};

struct Mesh {  // "meshes": a PLY file or an analytic shape
  std::string file;
  std::optional<double> sphere_radius_m;            // {"sphere": {"radius_m": r}}, centred at the object's origin
  std::optional<std::vector<double>> plane_size_m;  // {"plane": {"size_m": [x, y]}}, in its own xy plane, normal +z
  // A thing that deforms: file ids of its shapes, one after the other: PLY files with the vertices of `file` at other
  // places. An image says how far through them it was (ImageEntry::shapes); between two of them vertices go straight.
  std::vector<std::string> shapes{};
  std::optional<MeasuredMesh> measured{};
  std::string normals{};  // "smooth" (default: the file's, else averaged by area and angle) | "flat"
};

}  // namespace gonio::manifest
