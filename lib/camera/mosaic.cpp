#include "camera/mosaic.h"

#include "base/error.h"
#include "photograph/mosaic.h"

namespace gonio::camera {

int filter_pitch(const std::string& mosaic, const std::string& place) {
  if (mosaic.empty()) return 1;
  if (photograph::is_bayer(mosaic) || mosaic == polarizers) return 2;
  throw Error(Exit::data, place, "\"" + mosaic + "\" is no known mosaic",
              "RGGB, GRBG, GBRG, BGGR, polarizers, or leave it out");
}

}  // namespace gonio::camera
