// A mesh prepared for outlines: which of its edges can lie on a rim, seen from a point.
//
// Any set of triangles will do: closed or not, of any genus, edges with any number of triangles. Every triangle covers
// its projection once, whichever side is seen. Going over the edge a -> b from its right to its left, the number of
// triangles that cover a place grows by the edge's JUMP, the sum over its triangles of +1 where the projected triangle
// lies to the left and -1 where it lies to the right. Where nothing jumps, no rim runs: between two triangles on either
// side of the edge. What is left are contours (both triangles on one side: +-2) and borders (+-1). On which side a
// triangle lies follows from whether it faces the eye, in the mesh's own frame; so no vertex need be projected for it.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geom/vector.h"

namespace gonio::alignment {

struct RimEdge {
  std::uint32_t a = 0,
                b = 0;  // vertices; the left of a -> b is covered `jump` times more, where facing counts as stated
  int jump = 0;         // positive
};

class Shape {
 public:
  Shape() = default;
  // Frame of the mesh, metres. Triangles without area are left out: they cover nothing. Vertices at one place are one:
  // files repeat them along seams of textures, where no rim runs.
  Shape(std::vector<Vec3> positions_m, std::span<const std::array<std::uint32_t, 3>> triangles);

  const std::vector<Vec3>& positions_m() const { return positions_; }
  std::size_t triangles() const { return nx_.size(); }
  const std::array<std::uint32_t, 3>& triangle(std::size_t t) const { return corners_[t]; }
  Vec3 lower_m() const { return lower_; }
  Vec3 upper_m() const { return upper_; }
  Vec3 centre_m() const { return (lower_ + upper_) * 0.5; }  // of its box
  double radius_m() const { return radius_; }                // of the vertices about the centre
  std::size_t open_edges() const { return open_edges_; }     // with one triangle
  // Volume that it encloses, negative where its triangles are turned inside out (of closed meshes).
  double volume_m3() const { return volume_; }

  // A rough one with about `cells` cells across its radius, in each of which vertices are one: to begin a search with.
  Shape rough(int cells) const;

  // Edges that may lie on a rim, seen from `eye_m`, mesh frame, for pictures in which triangles that face the eye are
  // turned as they are stored (cross product of their sides positive); `mirrored`: the other way round. `faces` is
  // room to work in. Exact in the sense of floating point: a triangle seen edge-on falls to one side.
  void rim_edges(Vec3 eye_m, bool mirrored, std::vector<std::uint8_t>& faces, std::vector<RimEdge>& edges) const;

 private:
  struct Edge {
    std::uint32_t a, b, first, second;  // triangles: 2 t + (1 where it runs b -> a); `none` where there is no second
  };
  static constexpr std::uint32_t none = ~0U;
  std::vector<Vec3> positions_;
  std::vector<std::array<std::uint32_t, 3>> corners_;
  std::vector<double> nx_, ny_, nz_, offset_;  // planes of the triangles: n . x = offset
  std::vector<Edge> edges_;
  std::vector<std::vector<std::uint32_t>> crowds_;  // triangles of edges that have more than two: a, b, then as above
  Vec3 lower_, upper_;
  double radius_ = 0, volume_ = 0;
  std::size_t open_edges_ = 0;
};

}  // namespace gonio::alignment
