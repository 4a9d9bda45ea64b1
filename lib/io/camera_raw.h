// Raw files of cameras that people hold in their hands (CR2, NEF, ARW, RAF, DNG, ... ), through LibRaw: the sensor's
// own numbers and what the camera wrote about them. Nothing is demosaiced, scaled, or taken off.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gonio::io {

struct CameraRaw {
  int width = 0, height = 0;           // of what sees light: the masked border is left out
  int bits = 16;                       // that the largest code takes
  std::string mosaic;                  // "Mono", "BayerRG", "BayerGR", "BayerGB", "BayerBG": its upper left corner
  std::vector<std::uint16_t> samples;  // row by row, as the sensor lies: not turned with the camera
  std::string camera;                  // maker and model
  std::array<double, 4> black{};       // code without light, of the 2 x 2 samples at the upper left corner, row by row
  double white = 0;                    // code at which the sensor is full; 0: not known
  std::array<double, 3> neutral{};     // what a grey is to the camera in the light of the shot, green 1; 0: not known
  std::optional<double> exposure_s, iso;
};

bool is_camera_raw(const std::filesystem::path& path);  // by its extension
// Error(data) at `place` for what is none, is cut off, holds colours instead of a mosaic, or a mosaic of another kind.
CameraRaw decode_camera_raw(const std::string& bytes, const std::string& place);

}  // namespace gonio::io
