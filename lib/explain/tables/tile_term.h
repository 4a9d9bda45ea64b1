// reference.tile in tables of reflectance: a sample's readings over those of a white tile that sends less than it
// should towards grazing, so that both numbers of v *= 1 + incidence (1 - cos theta_i)^2 + exitance (1 - cos theta_o)^2
// are at least 0. Three alternatives of one family, either angle alone and both: a number that ends at 0 belongs to no
// name. What an expression predicts may as well be the tile's own reading: there both signs stand
// (terms/reference_tile.cpp).
#pragma once
#include "explain/tables/table_model.h"

namespace gonio::explain::tables {

Term tile_term(bool incidence, bool exitance);

}  // namespace gonio::explain::tables
