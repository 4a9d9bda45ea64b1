#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism* find_mechanism(const std::string& id) {
  for (const Mechanism* m : all_mechanisms())
    if (m->id == id) return m;
  return nullptr;
}

}  // namespace gonio::mechanism
