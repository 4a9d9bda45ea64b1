// optics.vignetting on any reading whose place in the picture is known.
#include "scene/mechanisms/optics_vignetting.h"

#include "explain/tables/table_model.h"

namespace gonio::explain::tables::terms {

const Term& optics_vignetting() {
  static const Term term{.mechanism = mechanism::optics_vignetting,
                         .order = term_order::optics,
                         .columns = {{"image_radius", "1", "distance from the picture's centre over half its width"}},
                         .models = {"sensor", "light", "surface", "expression", "chart"}};
  return term;
}

}  // namespace gonio::explain::tables::terms
