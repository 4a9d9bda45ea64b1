// Clear interface of Beckmann slopes to a homogeneous medium: surface/dielectric_model.h.
// albedo(), reflected and transmitted together, is 1: exact where it is smooth, to the tables' error where it is rough
// (surface/interface_loss.h: 1e-2, and 3e-2 towards the horizon).
#include "surface/dielectric_model.h"

namespace gonio::surface {
namespace {

class BeckmannDielectric final : public DielectricModel<Slopes::beckmann> {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "beckmann-dielectric",
        .sentence =
            "A clear interface with Gaussian slopes, smooth or rough, to glass, liquid or a cloudy medium inside.",
        .source = "Walter et al. 2007; Heitz & d'Eon 2014; Kulla & Conty 2017",
        .parameters = parameters(),
    };
    return info;
  }
};

}  // namespace

const Model& beckmann_dielectric() {
  static const BeckmannDielectric model;
  return model;
}

}  // namespace gonio::surface
