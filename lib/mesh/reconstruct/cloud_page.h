// What became of clouds, as a page: the mesh coloured by its own standard deviation and by how far its points lie off
// it, and the figures.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "mesh/reconstruct.h"

namespace gonio::mesh {

struct CloudMeshFigures {
  std::vector<std::string> clouds{};
  std::string name{};
  Chain chain = Chain::gonio;
  double sigma_m = 0;  // median of the vertices'
  std::size_t points = 0;
};

std::string cloud_page(const MeasuredPoints& points, const Reconstruction& made, const CloudMeshFigures& figures);

}  // namespace gonio::mesh
