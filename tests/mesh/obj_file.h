// Triangles of an OBJ file whose faces name vertices alone, or first.
#pragma once
#include <fstream>
#include <sstream>
#include <string>

#include "io/ply.h"

namespace gonio::tests {

inline io::TriangleMesh read_obj(const char* path) {
  io::TriangleMesh mesh;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vec3 p;
      words >> p.x >> p.y >> p.z;
      mesh.positions_m.push_back(p);
    } else if (kind == "f") {
      std::array<std::uint32_t, 3> t{};
      for (std::uint32_t& corner : t) {
        std::string word;
        words >> word;
        corner = static_cast<std::uint32_t>(std::stoul(word)) - 1;
      }
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

}  // namespace gonio::tests
