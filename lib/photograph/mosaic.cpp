// See mosaic.h.
#include "photograph/mosaic.h"

#include <algorithm>

#include "base/error.h"

namespace gonio::photograph {

namespace {

struct Grid {
  const char *name, *corner;
};
constexpr std::array<Grid, 4> grids{
    {{"BayerRG", "RGGB"}, {"BayerGR", "GRBG"}, {"BayerGB", "GBRG"}, {"BayerBG", "BGGR"}}};

}  // namespace

bool is_bayer(const std::string& corner) {
  return std::ranges::any_of(grids, [&](const Grid& g) { return corner == g.corner; });
}

Mosaic Mosaic::named(const std::string& name, const std::string& place) {
  Mosaic m;
  if (name == "Mono") m.kind_ = Kind::mono;
  if (name == "polarizers") m.kind_ = Kind::polarizers, m.corner_ = {0, 1, 2, 3};
  if (m.kind_ != Kind::bayer) return m;
  const auto found = std::ranges::find_if(grids, [&](const Grid& g) { return name == g.name || name == g.corner; });
  if (found == grids.end())
    throw Error(Exit::data, place, "\"" + name + "\" is no mosaic", "Mono, RGGB, GRBG, GBRG, BGGR or polarizers");
  for (std::size_t k = 0; k < m.corner_.size(); ++k)
    m.corner_[k] = static_cast<int>(std::string("RGB").find(found->corner[k]));
  return m;
}

}  // namespace gonio::photograph
