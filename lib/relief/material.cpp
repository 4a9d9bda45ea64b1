// What the facets of a relief are made of (lobe.h).
#include "base/error.h"
#include "relief/lobe.h"

namespace gonio::relief {
namespace {

manifest::Parameter three(Rgb v) {
  return manifest::Parameter(std::vector<double>{v.x, v.y, v.z});
}

Material known(const char* model, const manifest::Parameters& parameters) {
  return material_of(model, parameters, "material");
}

}  // namespace

Material mirror() {
  return known("metal", {{"f0", three({1, 1, 1})}, {"alpha", 0.0}});
}

Material white() {
  return known("diffuse", {{"albedo", three({1, 1, 1})}});
}

Material conductor(Rgb eta, Rgb k, double alpha) {
  return known("conductor", {{"eta", three(eta)}, {"k", three(k)}, {"alpha", alpha}});
}

Material facets_of_index(double eta, double alpha) {
  return conductor({eta, eta, eta}, {0, 0, 0}, alpha);
}

Material material_of(const std::string& model, const manifest::Parameters& parameters, const std::string& place) {
  const surface::Model* found = surface::find(model);
  if (found == nullptr)
    throw Error(Exit::data, place, "\"" + model + "\" is no surface model", "gonio-surfaces(7) lists them");
  const manifest::ModelInfo& info = found->info();
  if (info.attachment == manifest::Attachment::table || info.takes_base)
    throw Error(Exit::data, place, "facets of \"" + model + "\" need more than numbers", "take another model");
  Material material{found, surface::values_of(*found, parameters, place)};
  if (found->subsurface(material.values) != nullptr)
    throw Error(Exit::data, place, "light leaves \"" + model + "\" elsewhere than where it entered",
                "take a model that reflects on the spot");
  if (const auto inside = found->interior(material.values)) material.values.eta = inside->eta;
  return material;
}

}  // namespace gonio::relief
