// One exposure as the sensor read it: codes above black, the mosaic, where it is full.
//   camera raws (DNG, CR2, NEF, ARW, ...)    mosaic, black, full scale, exposure and ISO by the file
//   PNG, TIFF, EXR of one channel            codes of 8 or 16 bits, or numbers; the rest as stated
// What is stated goes before what a file says.
#pragma once
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "photograph/linearity.h"
#include "photograph/mosaic.h"

namespace gonio::photograph {

struct RawStated {
  std::string mosaic;           // Mosaic's names; empty: by the file, Mono where that says nothing
  std::optional<double> black;  // code
  std::optional<double> white;  // code at which the sensor is full
  std::optional<double> exposure_s;
  std::shared_ptr<const Linearity> linearity;  // of codes above black; none: they are linear
};

struct RawFrame {
  int width = 0, height = 0;
  Mosaic mosaic;
  std::vector<float> codes;  // black taken off, made linear, row by row
  double floor = 0;          // above black: the lowest code; minus infinity where there is none (EXR)
  double full_scale = 0;     // above black: from here on a sample is saturated
  double full_code = 1;      // of the file: what a 1 is in its picture (io::read_picture); EXR 1, camera raws 65535
  std::optional<double> exposure_s, iso;
  std::string camera;               // maker and model; empty: not known
  std::array<double, 3> neutral{};  // io::CameraRaw's
};

// Error(no_input | data) as io's readers; Error(data) for pictures of several channels, and for a black that is no less
// than the full scale, and for a linearity table that ends below half of it.
RawFrame read_raw_frame(const std::filesystem::path& path, const RawStated& stated);

// RawFrame::full_code, without its samples.
double full_code_of(const std::filesystem::path& path);

}  // namespace gonio::photograph
