// See raw_file.h.
#include "acquisition/device/raw_file.h"

#include <cmath>
#include <utility>

#include "acquisition/device/unpack.h"
#include "base/error.h"
#include "base/text.h"
#include "io/camera_raw.h"

namespace gonio::acquisition {

double gain_of_iso(double iso, double base_iso) {
  return 20 * std::log10(iso / base_iso);
}

RawFrame frame_of_raw_file(const std::string& bytes, const std::string& path, const std::string& pixel_format,
                           std::optional<double> base_iso) {
  io::CameraRaw raw = io::decode_camera_raw(bytes, path);
  const auto said = parse_pixel_format(pixel_format);
  if (said && (said->mosaic != raw.mosaic || said->bits < raw.bits))
    throw Error(Exit::data, path,
                "holds " + raw.mosaic + std::to_string(raw.bits) + ", pixel_format says " + pixel_format,
                "let the laboratory say what the camera writes");
  RawFrame frame;
  frame.width_px = raw.width;
  frame.height_px = raw.height;
  frame.bits = said ? said->bits : raw.bits;
  frame.pixel_format = said ? said->unpacked() : raw.mosaic + std::to_string(raw.bits);
  frame.samples = std::move(raw.samples);
  frame.exposure_s = raw.exposure_s;
  if (raw.iso && base_iso) frame.gain_db = gain_of_iso(*raw.iso, *base_iso);
  return frame;
}

}  // namespace gonio::acquisition
