// See raw_frame.h.
#include "photograph/raw_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "io/camera_raw.h"
#include "io/codes.h"
#include "io/picture.h"

namespace gonio::photograph {
namespace {

constexpr double half_a_code = 0.5;  // black need not be a whole one

struct Codes {
  RawFrame frame;  // codes with black
  std::string mosaic;
  std::array<double, 4> black{};
  double white = 0, lowest = 0;
};

Codes codes_of_camera_raw(const std::filesystem::path& path) {
  io::CameraRaw raw = io::decode_camera_raw(read_file(path), path.string());
  Codes c{{}, raw.mosaic, raw.black, raw.white > 0 ? raw.white : static_cast<double>((1 << raw.bits) - 1)};
  c.frame.width = raw.width, c.frame.height = raw.height;
  c.frame.codes.assign(raw.samples.begin(), raw.samples.end());
  c.frame.exposure_s = raw.exposure_s, c.frame.iso = raw.iso;
  c.frame.camera = raw.camera, c.frame.neutral = raw.neutral;
  return c;
}

Codes codes_of_picture(const std::filesystem::path& path) {
  const int bits = io::code_bits(path);
  io::Image picture = io::read_picture(path);
  if (picture.channels.size() != 1)
    throw Error(Exit::data, path.string(),
                format("has %zu channels: it is no sensor's picture", picture.channels.size()),
                "raw frames have one number for each sample");
  Codes c{{}, "Mono", {}, std::numeric_limits<double>::infinity()};
  c.frame.width = picture.width, c.frame.height = picture.height;
  c.frame.codes = std::move(picture.data);
  if (bits == 0) {
    c.lowest = -std::numeric_limits<double>::infinity();
    return c;
  }
  c.white = static_cast<double>((1 << bits) - 1);
  const auto white = static_cast<float>(c.white);
  // To the nearest whole number, which none of them is far from.
  for (float& v : c.frame.codes) v = static_cast<float>(static_cast<int>(v * white + 0.5f));
  return c;
}

// Right after black: dark current and shading are linear in the light.
void make_linear(const Linearity& linearity, const std::string& place, RawFrame& frame) {
  const double last = linearity.last_code();
  if (std::isfinite(frame.full_scale) && last < 0.5 * frame.full_scale)
    throw Error(Exit::data, linearity.place(),
                format("ends at code %g, and %s is full at %g above black", last, place.c_str(), frame.full_scale),
                "a table that reaches to where the sensor is full");
  // Codes beyond the table are of unknown light: full.
  frame.full_scale = linearity(std::min(frame.full_scale, last));
  if (std::isfinite(frame.floor)) frame.floor = linearity(frame.floor);
  for (float& code : frame.codes) code = static_cast<float>(linearity(code));
}

}  // namespace

RawFrame read_raw_frame(const std::filesystem::path& path, const RawStated& stated) {
  Codes c = io::is_camera_raw(path) ? codes_of_camera_raw(path) : codes_of_picture(path);
  if (stated.black) c.black.fill(*stated.black);
  if (stated.white) c.white = *stated.white;
  if (stated.exposure_s) c.frame.exposure_s = stated.exposure_s;
  RawFrame& frame = c.frame;
  frame.full_code = full_code_of(path);
  frame.mosaic = Mosaic::named(stated.mosaic.empty() ? c.mosaic : stated.mosaic, path.string());
  const double black = std::ranges::max(c.black);
  if (!(c.white > black))
    throw Error(Exit::data, path.string(), format("is full at code %g, and black is %g", c.white, black),
                "state the code without light, and that at which the sensor is full");
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x)
      frame.codes[static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.width) + static_cast<std::size_t>(x)] -=
          static_cast<float>(c.black[static_cast<std::size_t>((y & 1) * 2 + (x & 1))]);
  frame.full_scale = c.white - black - half_a_code;
  frame.floor = c.lowest - std::ranges::min(c.black);
  if (stated.linearity) make_linear(*stated.linearity, path.string(), frame);
  return std::move(c.frame);
}

double full_code_of(const std::filesystem::path& path) {
  if (io::is_camera_raw(path)) return 65535;
  const int bits = io::code_bits(path);
  return bits == 0 ? 1 : static_cast<double>((1 << bits) - 1);
}

}  // namespace gonio::photograph
