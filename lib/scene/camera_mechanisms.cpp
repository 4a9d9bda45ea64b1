// See mechanisms.h: what mechanisms do to cameras and their views.
#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "camera/intrinsics.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/mechanism_use.h"
#include "scene/amounts.h"
#include "scene/edit.h"
#include "scene/mechanisms.h"

namespace gonio::scene {

using mechanism::Mechanism;
using mechanism::Target;

std::optional<Amounts> camera_amounts(const Mechanism& mechanism, const manifest::MechanismUse& use,
                                      const std::string& name, const std::string& place, const std::string& picture) {
  if (mechanism.target != Target::camera) return {};
  auto found = std::find(use.on.begin(), use.on.end(), picture);
  if (picture.empty() || found == use.on.end()) found = std::find(use.on.begin(), use.on.end(), name);
  if (!use.on.empty() && found == use.on.end()) return {};
  const std::size_t count = std::max<std::size_t>(1, use.on.size());
  const Amounts amounts =
      amounts_of(mechanism, use, use.on.empty() ? 0 : static_cast<std::size_t>(found - use.on.begin()), count, place);
  if (neutral(mechanism, amounts)) return {};
  for (std::size_t i = 0; i < amounts.size(); ++i) {
    const mechanism::Parameter& p = mechanism.parameters[i];
    if (mechanism.stage != "lens" && amounts[i] != p.neutral && !(amounts[i] >= p.lower && amounts[i] <= p.upper))
      throw Error(Exit::data, place_of(place, p.name),
                  "value " + shortest_text(amounts[i]) + " is outside " + shortest_text(p.lower) + " to " +
                      shortest_text(p.upper),
                  p.meaning);
  }
  return amounts;
}

void apply_mechanism(View& view, const Mechanism& mechanism, const manifest::MechanismUse& use,
                     const std::string& place) {
  auto amounts = camera_amounts(mechanism, use, view.image, place);  // of this picture alone
  if (!amounts || use.on.empty())
    amounts = mechanism.stage == "lens" ? std::nullopt : camera_amounts(mechanism, use, view.camera_name, place);
  if (amounts) apply_amounts(view, mechanism, *amounts);
}

void apply_amounts(View& view, const Mechanism& mechanism, const std::vector<double>& amounts) {
  if (neutral(mechanism, amounts)) return;
  if (mechanism.stage == "lens") {
    camera::Intrinsics lens = view.camera.intrinsics();
    for (std::size_t i = 0; i < amounts.size(); ++i)
      lens.distortion[camera::distortion_index(mechanism.parameters[i].name, mechanism.id)] = amounts[i];
    view.camera = view.camera.with(lens);
    return;
  }
  const Edit* edit = find_edit(mechanism);
  if (edit != nullptr && edit->view != nullptr) edit->view(view, amounts);
}

bool moves_pixels(const Mechanism& mechanism) {
  if (mechanism.target != Target::camera) return false;
  const Edit* edit = find_edit(mechanism);
  return mechanism.stage == "lens" || (edit != nullptr && edit->rays);
}

void apply_mechanism(manifest::Camera& camera, const std::string& name, const Mechanism& mechanism,
                     const manifest::MechanismUse& use, const std::string& place) {
  if (mechanism.stage != "lens") return;
  const auto given = camera_amounts(mechanism, use, name, place);
  if (!given) return;
  const Amounts& amounts = *given;
  if (camera.model == "orthographic")
    throw Error(Exit::data, place, mechanism.id + " does not apply to the orthographic camera \"" + name + "\"",
                "name perspective cameras in \"on\"");
  camera::TermSet terms;
  for (std::size_t i = 0; i < amounts.size(); ++i) {
    const std::string& term = mechanism.parameters[i].name;
    camera.distortion[term] = manifest::Parameter(amounts[i]);
    terms.add(camera::distortion_index(term, place));
  }
  camera.model = camera::model_with(camera.model, terms);
}

}  // namespace gonio::scene
