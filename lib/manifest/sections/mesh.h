// "meshes": shapes of objects.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace gonio::manifest {

struct Mesh {  // "meshes": a PLY file or an analytic shape
  std::string file;
  std::optional<double> sphere_radius_m;            // {"sphere": {"radius_m": r}}, centred at the object's origin
  std::optional<std::vector<double>> plane_size_m;  // {"plane": {"size_m": [x, y]}}, in its own xy plane, normal +z
  // A thing that deforms: file ids of its shapes, one after the other: PLY files with the vertices of `file` at other
  // places. An image says how far through them it was (ImageEntry::shapes); between two of them vertices go straight.
  std::vector<std::string> shapes{};
  std::string normals{};  // "smooth" (default: the file's, else averaged by area and angle) | "flat"
};

}  // namespace gonio::manifest
