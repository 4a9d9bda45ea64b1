// Metal of measured optical constants and GGX slopes: surface/conductor_model.h.
// albedo() is exact where it is smooth, else a quadrature (some ten microseconds), exact to 4e-3 where it is isotropic
// and to 1e-2 where it is not.
#include "surface/conductor_model.h"

namespace gonio::surface {
namespace {

class Conductor final : public MetalModel<Slopes::ggx, ConductorOptics> {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "conductor",
        .sentence = "A metal, smooth or rough, by its measured complex index of refraction.",
        .source = "Walter et al. 2007; Heitz 2014, 2018; Born & Wolf 1999, section 14.2; Kulla & Conty 2017",
        .parameters = ConductorOptics::parameters(),
    };
    return info;
  }
};

}  // namespace

const Model& conductor() {
  static const Conductor model;
  return model;
}

}  // namespace gonio::surface
