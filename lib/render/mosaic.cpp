#include "render/mosaic.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "geom/luminance.h"
#include "geom/vector.h"
#include "photograph/mosaic.h"

namespace gonio::render {
namespace {

std::array<int, 3> channels_of(const io::Image& picture, const std::string& prefix, const Error& missing) {
  std::array<int, 3> places{};
  for (std::size_t c = 0; c < 3; ++c) {
    places[c] = picture.channel(prefix + std::string(1, "RGB"[c]));
    if (places[c] < 0) throw missing;
  }
  return places;
}

std::array<int, 3> colours_of(const io::Image& picture) {
  return channels_of(picture, "", Error(Exit::data, "picture", "has no channels R, G, B to record", "render in RGB"));
}

}  // namespace

io::Image bayer_mosaic(const io::Image& picture, const std::string& mosaic) {
  if (!photograph::is_bayer(mosaic))
    throw Error(Exit::data, "mosaic", "\"" + mosaic + "\" is no colour filter array", "RGGB, GRBG, GBRG or BGGR");
  const auto filters = photograph::Mosaic::named(mosaic, "mosaic");
  const auto from = colours_of(picture);
  io::Image result(picture.width, picture.height, {"Y"});
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      result.at(x, y, 0) = picture.at(x, y, from[static_cast<std::size_t>(filters.colour(x, y))]);
  return result;
}

io::Image polarizer_mosaic(const io::Image& picture) {
  const Error missing(Exit::usage, "mosaic", "polarizers need the picture's Stokes planes s1 and s2", "add --stokes");
  const auto s0 = colours_of(picture), s1 = channels_of(picture, "s1.", missing),
             s2 = channels_of(picture, "s2.", missing);
  io::Image result(picture.width, picture.height, {"R", "G", "B"});
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        result.at(x, y, static_cast<int>(c)) = static_cast<float>(behind_polarizer(
            picture.at(x, y, s0[c]), picture.at(x, y, s1[c]), picture.at(x, y, s2[c]), polarizer_angle(x, y)));
  return result;
}

io::Image luminance(const io::Image& picture) {
  const auto from = colours_of(picture);
  io::Image result(picture.width, picture.height, {"Y"});
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      result.at(x, y, 0) = static_cast<float>(
          luminance_of<double>(picture.at(x, y, from[0]), picture.at(x, y, from[1]), picture.at(x, y, from[2])));
  return result;
}

}  // namespace gonio::render
