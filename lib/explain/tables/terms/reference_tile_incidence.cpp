// reference.tile in tables of reflectance, at incidence alone.
#include "explain/tables/tile_term.h"

namespace gonio::explain::tables {

const Term& reference_tile_incidence() {
  static const Term term = tile_term(true, false);
  return term;
}

}  // namespace gonio::explain::tables
