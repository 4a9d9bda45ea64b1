// A CT volume against the simulated CT of the shape that the user believes in: a CAD model, a part that was measured
// otherwise, or a surface that was cut from another scan.
//
// Observations, three thousand places spread evenly over the believed surface (explain/volumes/observed.h): where the
// wall stands along the normal, how wide its edge is (voxels), and the grey value at a depth below it and at a height
// above it (shares of material less air). Each has the noise that neighbouring places show. A grey value that is off by
// a quarter of the step counts as much as a wall that is off by a voxel: the score is in voxels.
//
// Base model: a pose of six numbers, a value of air and one of the material, the width of edges of a tomograph that
// resolves its voxels (0.25 to 0.8 of them, along the slices and across them). Hypotheses: ct.*
// (explain/volumes/terms), one file each. Groups: sixteen blocks of space.
//
// Frames: `scanner`, metres, origin in the middle of the volume, axes along its indices; the rotation axis is the
// third.
#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "explain/engine.h"
#include "explain/volumes/line_integrals.h"
#include "geom/rigid.h"
#include "io/volume.h"
#include "manifest/parameter.h"
#include "manifest/sections/forward.h"
#include "mesh/mesh.h"

namespace gonio::explain {

struct VolumesInput {
  std::string name, place;  // in "volumes"; for messages
  std::string mesh_name;
  io::VolumeData volume;
  Vec3 spacing_m{};
  mesh::Mesh mesh;                                    // in the scanner's frame
  bool attenuation = false;                           // values are 1/m
  std::vector<volumes::Ball> markers;                 // in the scanner's frame
  std::map<std::string, manifest::Parameters> given;  // mechanisms that the manifest has switched on
};

// Volumes that name a mesh which the manifest has.
bool has_volumes(const manifest::Document& document);
std::vector<VolumesInput> volumes_inputs(const manifest::Document& document);
std::unique_ptr<Problem> volumes_problem(VolumesInput input);
std::vector<std::filesystem::path> volumes_files(const manifest::Document& document);

}  // namespace gonio::explain
