// Triangle meshes from clouds of measured points: several views, one surface that states its own error.
//
// The thesis's chain (contribution A, section 2.B): in every view, Poisson-disk resampling, normals by plane fits,
// turned to the camera, carried back to the view's points; all views merged; screened Poisson (Kazhdan & Hoppe 2013);
// trimming where points are sparse. It smooths over whatever its plane fits reach, joins what lies close together, and
// leaves its own error unsaid.
//
// Ours: all views merged and resampled; every sample moved to, and its normal taken from, a local quadratic of the
// points about it, weighted by their covariances, over as wide a neighbourhood as they bear (local_surface.h); screened
// Poisson for the topology; parts cut that are far from points or stand where a view saw through (envelope.h); then
// every vertex moved to the local quadratic of the points, whose variance is its own.
//
// Does not register views: points are taken to be in one frame, and what views contradict each other by shows in
// `noise_ratio` and `whitened`. Results do not depend on threads.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "geom/vector.h"
#include "io/ply.h"

namespace gonio::mesh {

struct MeasuredPoints {
  std::vector<Vec3> positions_m;
  std::vector<std::array<double, 6>> covariance_m2;  // xx, xy, xz, yy, yz, zz
  std::vector<std::uint32_t> view;                   // place in viewpoints_m
  std::vector<std::array<float, 3>> colour;          // linear; empty: none
  std::vector<std::vector<Vec3>> viewpoints_m;       // of each view: cameras and projectors that saw all its points
};

enum class Chain { gonio, thesis };

struct ReconstructionWish {
  Chain chain = Chain::gonio;
  int depth = 9;                 // of Poisson's octree
  std::size_t samples = 100000;  // after Poisson-disk resampling
  std::size_t neighbours = 500;  // thesis: of a plane fit
  double trim = 4;               // cut where points lie this many times their usual spacing apart
  double least_share = 0.01;     // of the largest component's area; smaller ones are dropped
  std::uint64_t seed = 0;        // of the resampling
};

struct MeshComponent {
  std::size_t vertices = 0, triangles = 0;
  double area_m2 = 0;
};

struct PointDeviation {  // of the points from the mesh, along its normals
  double rms_m = 0, median_m = 0, p95_m = 0;
  double whitened = 0;     // root mean square over what each point's own covariance says; 1: as stated
  std::size_t points = 0;  // that have a surface beside them
  std::size_t bare = 0;    // that have none
};

struct Reconstruction {
  io::TriangleMesh mesh;           // with unit normals; no triangles: no surface
  std::vector<float> sigma_m;      // of each vertex, along its normal
  std::vector<float> deviation_m;  // of each vertex: mean of the points about it, positive outside
  std::vector<std::array<float, 3>> colour;
  double spacing_m = 0;    // usual distance of a point from its sixth neighbour
  double noise_ratio = 1;  // what the points scatter by, over what they state
  std::size_t poisson_vertices = 0, sparse = 0, seen_through = 0, contradicting = 0;  // before and by cutting
  std::vector<MeshComponent> components;                                              // largest first
  std::size_t dropped_components = 0, dropped_triangles = 0;
  PointDeviation deviation;
};

// Every view has points and a viewpoint, every point a covariance; all finite (asserted by who reads them).
Reconstruction reconstruct(const MeasuredPoints& points, const ReconstructionWish& wish);

}  // namespace gonio::mesh
