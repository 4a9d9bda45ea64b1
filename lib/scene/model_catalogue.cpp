// The manifest's view of the registered models: defines manifest::models() and manifest::find_model(), declared in
// manifest/model.h. The manifest lies below surfaces and lights and must not include them; the linker closes the circle
// here, in the lowest room that sees both families.
#include <algorithm>
#include <vector>

#include "light/light.h"
#include "manifest/model.h"
#include "relief/microstructure.h"
#include "surface/law.h"
#include "surface/surface.h"

namespace gonio::manifest {
namespace {

template <class Models>
std::vector<const ModelInfo*> infos_of(const Models& all) {
  std::vector<const ModelInfo*> infos;
  for (const auto* model : all) infos.push_back(&model->info());
  std::sort(infos.begin(), infos.end(), [](const ModelInfo* a, const ModelInfo* b) { return a->id < b->id; });
  return infos;
}

}  // namespace

std::span<const ModelInfo* const> models(Family family) {
  static const auto surfaces = infos_of(surface::all_models());
  static const auto lights = infos_of(light::all_models());
  static const auto microstructures = infos_of(relief::all_microstructures());
  static const auto laws = infos_of(surface::all_laws());
  switch (family) {
    case Family::surface: return surfaces;
    case Family::light: return lights;
    case Family::microstructure: return microstructures;
    case Family::law: break;
  }
  return laws;
}

const ModelInfo* find_model(Family family, const std::string& id) {
  for (const ModelInfo* info : models(family))
    if (info->id == id) return info;
  return nullptr;
}

}  // namespace gonio::manifest
