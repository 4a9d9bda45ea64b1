// Clear interface of GGX slopes to a homogeneous medium: surface/dielectric_model.h.
// albedo(), reflected and transmitted together, is 1: exact where it is smooth, to the tables' error where it is rough
// (surface/interface_loss.h: 1e-2, and 3e-2 towards the horizon).
#include "surface/dielectric_model.h"

namespace gonio::surface {
namespace {

class Dielectric final : public DielectricModel<Slopes::ggx> {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "dielectric",
        .sentence = "A clear interface, smooth or rough, to glass, liquid or a cloudy medium inside.",
        .source = "Walter et al. 2007; Heitz 2014, 2018; Kulla & Conty 2017",
        .parameters = parameters(),
    };
    return info;
  }
};

}  // namespace

const Model& dielectric() {
  static const Dielectric model;
  return model;
}

}  // namespace gonio::surface
