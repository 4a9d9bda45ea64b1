// The manifest's clouds compared, and on request moved to each other.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "mesh/register.h"

namespace gonio::mesh {

struct CloudRegisterRequest {
  std::vector<std::string> clouds{};           // names in clouds; empty: all
  std::map<std::string, Vec3> viewpoints_m{};  // of clouds, instead of what the manifest says
  std::string fixed{};                         // the cloud that stays; empty: the first
  RegisterWish wish{};
  std::filesystem::path page{};  // report to write; empty: none
  std::function<std::filesystem::path(const std::string& name)> output_path{};
  std::function<void(const std::filesystem::path&)> note_input{};
};

// Two clouds at least are there, in one frame. No point is read.
void check_cloud_register(const manifest::Document& document, const CloudRegisterRequest& request);

struct CloudRegisterSummary {
  std::size_t pairs = 0;  // that overlap
  bool refused = false;
  double consistency = 0;  // as the views are left
};

// Enters `registration`. Where views are moved: writes NAME.ply of each that moves, with covariances turned along, and
// moves the poses of its images. What was found is logged. Error(data) where a cloud cannot be used.
CloudRegisterSummary cloud_register_document(manifest::Document& document, const CloudRegisterRequest& request);

}  // namespace gonio::mesh
