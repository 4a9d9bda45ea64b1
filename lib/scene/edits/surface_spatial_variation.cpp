// surface.spatial-variation: the albedo of a uniform surface with a stain.
#include <algorithm>
#include <memory>

#include "scene/edit.h"
#include "scene/model_choice.h"
#include "scene/variation.h"
#include "surface/stain.h"

namespace gonio::mechanism {
const Mechanism& surface_spatial_variation();
}

namespace gonio::scene::edits {
namespace {

class StainedAlbedo final : public Rule {
 public:
  StainedAlbedo(Rgb albedo, const Amounts& amounts) : albedo_(albedo), a_(amounts) {}
  Rgb at(const Place& place) const override {
    return albedo_ * surface::stain(place.position_m, {a_[0], a_[1], a_[2]}, a_[3], a_[4]);
  }
  void fits(const mesh::Mesh*, const manifest::ParameterInfo&, const std::string&) const override {}

 private:
  Rgb albedo_;
  Amounts a_;
};
bool can_stain(const Surface& surface) {
  return find_parameter(surface.model->info(), "albedo") && !surface.varies();
}
void stain(Surface& surface, const Amounts& amounts) {
  const auto& own = surface.model->info().parameters;
  const auto albedo = std::find_if(own.begin(), own.end(), [](const auto& p) { return p.name == "albedo"; });
  const Rgb value = surface.values.rgb(static_cast<std::size_t>(albedo - own.begin()));
  surface.varying.push_back({"albedo", std::make_shared<const StainedAlbedo>(value, amounts)});
}

}  // namespace

const Edit& surface_spatial_variation() {
  static const Edit edit{
      .mechanism = mechanism::surface_spatial_variation, .fits_surface = can_stain, .surface = stain};
  return edit;
}

}  // namespace gonio::scene::edits
