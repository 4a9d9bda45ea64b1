// What is asked of a height map: its roughness (areal.h) and the distribution of its normals (normals.h), of the
// surface that a treatment leaves.
#pragma once
#include <string>

#include "relief/areal.h"
#include "relief/normals.h"

namespace gonio::relief {

struct Measured {
  std::string name;  // of the file
  Treatment treatment;
  Treated surface;
  Roughness roughness;
  Normals normals;
};
// Heights in metres. Error(data) at `name` where less than half of the points were measured.
Measured measured(const io::HeightMap& map, const Treatment& treatment, const std::string& name);

}  // namespace gonio::relief
