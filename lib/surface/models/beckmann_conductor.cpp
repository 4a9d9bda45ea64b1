// Metal of measured optical constants and Beckmann slopes: surface/conductor_model.h.
// albedo() is exact where it is smooth, else a quadrature (some ten microseconds), exact to 4e-3 where it is isotropic
// and to 1e-2 where it is not.
#include "surface/conductor_model.h"

namespace gonio::surface {
namespace {

class BeckmannConductor final : public MetalModel<Slopes::beckmann, ConductorOptics> {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "beckmann-conductor",
        .sentence = "A metal with Gaussian slopes, smooth or rough, by its measured complex index of refraction.",
        .source = "Walter et al. 2007; Heitz & d'Eon 2014; Born & Wolf 1999, section 14.2; Kulla & Conty 2017",
        .parameters = ConductorOptics::parameters(),
    };
    return info;
  }
};

}  // namespace

const Model& beckmann_conductor() {
  static const BeckmannConductor model;
  return model;
}

}  // namespace gonio::surface
