// The makers' collision models of known arms (data folder), in base coordinates with all joints at zero.
#pragma once
#include <string>
#include <vector>

#include "io/ply.h"

namespace gonio::tests {

inline constexpr const char* arms_with_meshes[] = {"ur3", "ur5", "ur5e", "ur10e", "abb-irb-1600", "abb-irb-1600-1.2"};

// Base, then one a link.
std::vector<io::TriangleMesh> robot_meshes(const std::string& model);

// Points on the triangles, none farther than about `spacing_m` from the next.
std::vector<Vec3> points_on(const io::TriangleMesh& mesh, double spacing_m);

}  // namespace gonio::tests
