// The report of one height map: the map, its heights, its normals and the lobe that they make, the figures.
#pragma once
#include <string>

#include "io/image.h"
#include "relief/areal.h"
#include "relief/lobe.h"
#include "relief/normals.h"

namespace gonio::relief {

struct Measured {
  std::string name;  // of the file
  Treatment treatment;
  Treated surface;
  Roughness roughness;
  Normals normals;
};
Measured measured(const io::HeightMap& map, const Treatment& treatment, const std::string& name);
std::string treatment_text(const Measured& m);  // "levelled by a plane; no filter; 12 of 4096 points missing, left out"
std::string roughness_page(const std::vector<Measured>& all);

io::Image picture_of(const io::HeightMap& map);  // false colour, rows from the top; missing points magenta
// Logarithmic false colours over `decades` below the largest value; the unit disc, white outside of it.
io::Image picture_of(const LobeTable& lobe, double decades);

}  // namespace gonio::relief
