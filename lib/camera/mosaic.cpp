#include "camera/mosaic.h"

#include "base/error.h"

namespace gonio::camera {

bool is_bayer(const std::string& mosaic) {
  return mosaic == "RGGB" || mosaic == "GRBG" || mosaic == "GBRG" || mosaic == "BGGR";
}

int filter_pitch(const std::string& mosaic, const std::string& place) {
  if (mosaic.empty()) return 1;
  if (is_bayer(mosaic) || mosaic == polarizers) return 2;
  throw Error(Exit::data, place, "\"" + mosaic + "\" is no known mosaic",
              "RGGB, GRBG, GBRG, BGGR, polarizers, or leave it out");
}

}  // namespace gonio::camera
