// The numbers of a camera that a fit moves, and the models that say which of the lens terms exist.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "camera/lens_terms.h"
#include "manifest/sections.h"

namespace gonio::camera {

struct Intrinsics {  // of a perspective camera; pixels, pixel centres at integers
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  std::array<double, distortion_terms> distortion{};  // in the order of distortion_names
};

// Perspective models: pinhole, radial-tangential, thin-prism, each with the first `terms` of distortion_names.
// orthographic stands apart: it has px_per_m instead of focal lengths, and no lens.
struct CameraModelInfo {
  std::string_view name;
  std::size_t terms;
  bool perspective;
  std::string_view sentence;
};
std::span<const CameraModelInfo> camera_models();
const CameraModelInfo& camera_model_info(const std::string& name, const std::string& place);  // Error(data) for others
std::size_t distortion_index(const std::string& name, const std::string& place);              // Error(data) for others

// Error(data) at `place`, the camera's own (".../cameras/c"), for missing or impossible values and for distortion terms
// that the model lacks (unless they are zero).
Intrinsics intrinsics_of(const manifest::Camera& camera, const std::string& place);
void store(const Intrinsics& intrinsics,
           manifest::Camera& camera);  // values only: fx_px .. cy_px, and the model's distortion

}  // namespace gonio::camera
