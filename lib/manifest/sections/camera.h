// "cameras".
#pragma once
#include <optional>
#include <string>

#include "manifest/parameter.h"
#include "manifest/sections/camera_quality.h"
#include "manifest/value.h"

namespace gonio::manifest {

struct Camera {                   // "cameras"
  std::string model = "pinhole";  // camera/intrinsics.h lists them
  int width_px = 0, height_px = 0;
  Parameter fx_px, fy_px, cx_px, cy_px;  // orthographic: fx, fy are pixels per metre (px_per_m_x ...) instead
  Parameter px_per_m;                    // orthographic only
  Parameters distortion;                 // camera/lens_terms.h; left out: zero
  Sigmas sigma;
  std::optional<double> rms_px;
  Value covariance;  // {"order": [...], "values": [[...]]} or null
  std::optional<CameraQuality> quality;
  std::optional<bool> held{};  // true: calibrated on other views than this document's, and not asked of these again
  std::string mosaic{};  // filters over the pixels: "RGGB", "GRBG", "GBRG", "BGGR"; "polarizers": [90 45; 135 0]
};

}  // namespace gonio::manifest
