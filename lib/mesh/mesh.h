// A triangle mesh ready to be rendered: finite, indexed properly, no triangle without area, unit normals at the
// vertices.
//
// Object frame, metres. Vertex normals are the file's where it has them, else the mean of the adjoining triangles'
// normals, each weighted by the triangle's area and by its angle at the vertex; or none at all ("flat"), which shades
// every triangle by its own normal. Orientation is the file's: counter-clockwise seen from outside.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "io/ply.h"

namespace gonio::mesh {

enum class Shading { smooth, flat };

struct Mesh {
  std::vector<Vec3> positions_m;
  std::vector<Vec3> normals;  // unit, one per vertex; empty: flat
  std::vector<Vec2> texture;  // one per vertex, or empty
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::vector<float>> properties;  // of the vertices, as they were asked for; empty: not in the file
  std::vector<std::int32_t> labels;            // one per triangle, or empty
  std::vector<float> mean_curvature_per_m;     // one per vertex where somebody asked: mesh/curvature.h
};

// Error(data) at `place` where nothing with an area is left, or where a coordinate is not finite. Triangles without
// area are dropped; `dropped` (may be null) receives their number.
Mesh prepare(io::TriangleMesh raw, Shading shading, const std::string& place, std::size_t* dropped = nullptr);

// Normals averaged by area and angle. A vertex that no triangle uses, or whose triangles cancel, gets +z.
std::vector<Vec3> averaged_normals(const std::vector<Vec3>& positions_m,
                                   const std::vector<std::array<std::uint32_t, 3>>& triangles);

double area_m2(const Mesh& mesh);

}  // namespace gonio::mesh
