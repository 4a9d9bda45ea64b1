// lens.rational: rays of the views that scene/mechanisms.h makes (relighting/shifted_views.h). A denominator says how
// the polynomial falls short: it is asked of lenses that have one.
#include <algorithm>

#include "camera/lens_terms.h"
#include "relighting/shifted_views.h"

namespace gonio::mechanism {
const Mechanism& lens_rational();
}

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  std::vector<Use> uses = shifted_uses(s, mechanism::lens_rational());
  std::erase_if(uses, [&](const Use& use) {
    const auto& lens = s.recordings.views[use.targets[0]].model.intrinsics().distortion;
    return lens[camera::LensTerm::k1] == 0 || lens[camera::LensTerm::fisheye] == 1;
  });
  return uses;
}

}  // namespace

const Term& lens_rational() {
  static const Term term = shifted_term(mechanism::lens_rational, candidates);
  return term;
}

}  // namespace gonio::relighting::terms
