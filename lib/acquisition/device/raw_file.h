// A camera's raw file (io/camera_raw.h) as a frame.
#pragma once
#include <optional>
#include <string>

#include "acquisition/device/devices.h"

namespace gonio::acquisition {

// `pixel_format`: what the file has to hold, or empty. `base_iso`: the ISO whose gain is 0 dB: voltages double, and 6
// dB are added, where the ISO doubles. What the file says of its exposure and ISO is the frame's. Error(data) at
// `path`.
RawFrame frame_of_raw_file(const std::string& bytes, const std::string& path, const std::string& pixel_format,
                           std::optional<double> base_iso);
double gain_of_iso(double iso, double base_iso);  // dB

}  // namespace gonio::acquisition
