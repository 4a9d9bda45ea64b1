// surface.coat: the interface of a uniform matte surface, on a part of each of its objects.
#include <algorithm>
#include <memory>

#include "scene/edit.h"
#include "scene/model_choice.h"
#include "scene/variation.h"
#include "surface/coat_region.h"

namespace gonio::mechanism {
const Mechanism& surface_coat();
const Mechanism& surface_interface();
}  // namespace gonio::mechanism

namespace gonio::scene::edits {
namespace {

// Between bare and coated the interface is weaker; f0 is as good as linear in the light that it adds.
class PartlyCoated final : public Rule {
 public:
  explicit PartlyCoated(const Amounts& a) : f0_(a[0]), region_{a[2], a[3], a[4], a[5]} {}
  Rgb at(const Place& place) const override {
    const double f0 = f0_ * region_.cover(place.position_m);
    return {f0, f0, f0};
  }
  void fits(const mesh::Mesh*, const manifest::ParameterInfo&, const std::string&) const override {}

 private:
  double f0_;
  surface::CoatRegion region_;
};
// A surface that has a coat everywhere has none to end somewhere.
bool has_coat(const Surface& surface) {
  const auto& own = surface.model->info().parameters;
  const auto f0 = std::ranges::find(own, "f0", &manifest::ParameterInfo::name);
  return f0 != own.end() && !(surface.values.rgb(static_cast<std::size_t>(f0 - own.begin())) == Rgb{});
}
bool can_coat(const Surface& surface) {
  return !surface.varies() && !surface.base && !has_coat(surface) &&
         model_for(surface, mechanism::surface_interface()) != nullptr;
}
void coat(Surface& surface, const Amounts& amounts) {
  surface.model = model_for(surface, mechanism::surface_interface());
  surface.parameters["f0"] = manifest::Parameter(amounts[0]);
  surface.parameters["alpha"] = manifest::Parameter(amounts[1]);
  surface.varying.push_back({"f0", std::make_shared<const PartlyCoated>(amounts)});
}

}  // namespace

const Edit& surface_coat() {
  static const Edit edit{.mechanism = mechanism::surface_coat, .fits_surface = can_coat, .surface = coat};
  return edit;
}

}  // namespace gonio::scene::edits
