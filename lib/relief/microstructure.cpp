// See microstructure.h.
#include "relief/microstructure.h"

namespace gonio::relief {

const Microstructure* find_microstructure(const std::string& id) {
  for (const Microstructure* structure : all_microstructures())
    if (structure->info().id == id) return structure;
  return nullptr;
}

}  // namespace gonio::relief
