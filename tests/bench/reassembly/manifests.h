// The manifests of scripts/experiments/reassembly.mk: the laboratory as it truly is, the chrome ball, what the authors
// of each step believe. Paths in them start at the folder that they are written to.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "manifest/value.h"
#include "table.h"

namespace gonio::reassembly_experiment {

using manifest::Value;

struct Laboratory {
  Table table;
  int width_px = 320;       // of the pictures that are compared; photographs of markers are three times as wide
  double near_per_m = 0.5;  // one over the distance of the walls
  double falloff = 0.10;    // of the lens
};
constexpr double ball_radius_m = 0.05;
constexpr Vec3 ball_eta{3.11, 3.18, 2.33}, ball_k{3.31, 3.33, 3.14};  // chrome near 650, 550 and 450 nm

Value truth(const Laboratory& laboratory, std::size_t voxels);  // with light, lens, pressed cloth, absorption
Value believed();                          // a patch of the recorded truth: what stands there is unknown
Value ball(const Laboratory& laboratory);  // the probe in the same room, at the middle of the scene
Value poses(const Laboratory& laboratory, std::size_t voxels);  // {piece: world_from_object}
Value measured_surfaces();                                      // of background and markers
Value lambertian_surfaces();                                    // matte, with their bihemispherical reflectance

// RFC 7386: what `patch` says replaces what `into` says, null takes it away.
void merge(Value& into, const Value& patch);

// A background mesh with labels as one mesh for each surface, STEM-SURFACE.ply, and these as objects. Normals are those
// of the whole, so that no seam shows.
void write_parts(const std::filesystem::path& folder, const std::string& stem, io::TriangleMesh mesh);
void add_background(Value& document, const std::string& stem);

// `rig` with the background of write_parts() and the pieces that ct-mesh-clean wrote into their manifests, where
// `poses` says that they stand: what `reassemble` is for.
Value assembled(Value rig, const std::string& background, const Value& poses, const std::vector<Value>& pieces);

}  // namespace gonio::reassembly_experiment
