// See mosaic.h.
#include "photograph/mosaic.h"

#include "base/error.h"

namespace gonio::photograph {

Mosaic Mosaic::named(const std::string& name, const std::string& place) {
  Mosaic m;
  if (name == "Mono") {
    m.mono_ = true;
  } else if (name == "BayerRG" || name == "RGGB") {
    m.corner_ = {0, 1, 1, 2};
  } else if (name == "BayerGR" || name == "GRBG") {
    m.corner_ = {1, 0, 2, 1};
  } else if (name == "BayerGB" || name == "GBRG") {
    m.corner_ = {1, 2, 0, 1};
  } else if (name == "BayerBG" || name == "BGGR") {
    m.corner_ = {2, 1, 1, 0};
  } else {
    throw Error(Exit::data, place, "\"" + name + "\" is no mosaic", "Mono, RGGB, GRBG, GBRG or BGGR");
  }
  return m;
}

}  // namespace gonio::photograph
