// reference.tile in tables of reflectance, at exitance alone.
#include "explain/tables/tile_term.h"

namespace gonio::explain::tables {

const Term& reference_tile_exitance() {
  static const Term term = tile_term(false, true);
  return term;
}

}  // namespace gonio::explain::tables
