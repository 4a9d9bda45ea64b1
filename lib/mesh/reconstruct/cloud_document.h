// The manifest's clouds as one mesh in the manifest.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "mesh/reconstruct.h"

namespace gonio::mesh {

struct CloudMeshRequest {
  std::vector<std::string> clouds{};           // names in clouds; empty: all
  std::map<std::string, Vec3> viewpoints_m{};  // of clouds, instead of what the manifest says; in the points' frame
  std::string name{};                          // in meshes
  ReconstructionWish wish{};
  std::filesystem::path page{};  // report to write; empty: none
  std::function<std::filesystem::path(const std::string& name)> output_path{};
  std::function<void(const std::filesystem::path&)> note_input{};
};

// Every cloud is there, lies in one frame with the others, and was seen from somewhere. No point is read.
void check_cloud_mesh(const manifest::Document& document, const CloudMeshRequest& request);

struct CloudMeshSummary {
  bool surface = false;  // where there is none, nothing was written
  double whitened = 0, rms_m = 0, noise_ratio = 1;
};

// Writes NAME.ply, with sigma and deviation (the mean one of the points about a vertex, positive outside) and, where
// the clouds have them, red, green, blue; and enters it. What was found is logged. Error(data) where a cloud cannot be
// used.
CloudMeshSummary cloud_mesh_document(manifest::Document& document, const CloudMeshRequest& request);

}  // namespace gonio::mesh
