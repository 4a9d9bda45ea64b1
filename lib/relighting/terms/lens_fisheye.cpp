// lens.fisheye: rays of the views that scene/mechanisms.h makes (relighting/shifted_views.h). Asked of lenses that are
// stated to be perspective; beside a polynomial it is the finer name.
#include <algorithm>

#include "relighting/shifted_views.h"

namespace gonio::mechanism {
const Mechanism& lens_fisheye();
}

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  std::vector<Use> uses = shifted_uses(s, mechanism::lens_fisheye());
  std::erase_if(uses, [](const Use& use) { return use.numbers[0].neutral != 0; });
  for (Use& use : uses) use.finer = true;
  return uses;
}

}  // namespace

const Term& lens_fisheye() {
  static const Term term = shifted_term(mechanism::lens_fisheye, candidates);
  return term;
}

}  // namespace gonio::relighting::terms
