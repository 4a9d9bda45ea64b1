// optics.vignetting on any reading whose place in the picture is known. Equation: scene/scene.h, vignetting().
#include "explain/tables/table_model.h"

namespace gonio::mechanism {
const Mechanism& optics_vignetting();
}

namespace gonio::explain::tables {

const Term& optics_vignetting() {
  static const Term term{.mechanism = mechanism::optics_vignetting,
                         .order = term_order::optics,
                         .columns = {{"image_radius", "1", "distance from the picture's centre over half its width"}},
                         .models = {"sensor", "light", "surface", "expression"},
                         .act = [](double f, std::span<const double> at, std::span<const double> p) {
                           return f * (1 - p[0] * at[0] * at[0]);
                         }};
  return term;
}

}  // namespace gonio::explain::tables
