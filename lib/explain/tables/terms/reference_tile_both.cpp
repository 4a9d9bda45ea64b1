// reference.tile in tables of reflectance, at both angles.
#include "explain/tables/tile_term.h"

namespace gonio::explain::tables {

const Term& reference_tile_both() {
  static const Term term = tile_term(true, true);
  return term;
}

}  // namespace gonio::explain::tables
