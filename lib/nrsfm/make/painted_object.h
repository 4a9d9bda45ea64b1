// What deforms as a thing of a scene, for renderers and simulated laboratories: its mesh goes through its shapes
// (scene/deformed.h), is painted with the noise that pictures.h paints with, and stands on the world's plane z = 0 with
// its middle over the origin. The rig that moves it is a second object that goes along, grey. Object frame: the
// animatronic's.
#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "manifest/sections/forward.h"
#include "nrsfm/make/animatronic.h"

namespace gonio::nrsfm {

struct PaintOptions {
  double grain_m = 0.003;  // the finest of the paint; triangles are cut so small that they carry it
  std::uint64_t seed = 1;
};

// The same surface of smaller triangles: every edge in `parts`, as anchors on the surface's own.
struct Refined {
  std::vector<Anchor> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
Refined refined(const std::vector<std::array<std::uint32_t, 3>>& triangles, int parts);

// Where it went: a box around all of it in all shapes, world.
struct Extent {
  Eigen::Vector3d lower_m, upper_m;
};

// Writes PLY files to where `path_for` ("sheet.ply") says, and enters them, the meshes, surfaces and objects `id` and,
// where there is a rig, `id`-rig; what was there of these names makes way.
Extent enter_painted(manifest::Document& document, const DeformingSurface& surface, const std::string& id,
                     const PaintOptions& options,
                     const std::function<std::filesystem::path(const std::string&)>& path_for);

}  // namespace gonio::nrsfm
