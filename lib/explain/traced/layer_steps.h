// How thick the layers of a print would be, if every second one were rougher: where a fit of surface.print-layers
// begins. Of a few hundred thicknesses and places of the first layer the pair is taken whose steps take most off the
// residuals that one brightness a picture and one roughness leave. What is found where there are no layers is noise,
// which the race judges as it does every hypothesis.
#pragma once
#include "explain/engine.h"
#include "explain/traced/traced_model.h"

namespace gonio::explain::traced {

struct LayerSteps {
  double layer_m = 0.001, offset_m = 0;
};
LayerSteps find_layers(const TracedModel& model, std::size_t surface, const Observations& o);

}  // namespace gonio::explain::traced
