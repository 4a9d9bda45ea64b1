// A surface of the manifest for the contrast experiment (specimen.h). scene::build_scene reads it, on a plane made for
// the purpose, so that files, bases and mechanisms mean what they mean to the renderer.
#include "contrast/predict/specimen.h"

#include <algorithm>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "scene/scene.h"

namespace gonio::contrast {

struct Specimen::State {
  std::string place;
  scene::Appearance appearance;
  std::size_t index = 0;
  manifest::Sigmas sigma;
  const scene::Surface& surface() const { return appearance.surfaces[index]; }
};

namespace {

manifest::Document on_a_plane(manifest::Document document, const std::string& surface) {
  keep_images(document, {});
  document.cameras.clear();
  document.meshes = {{"sample", {}}};
  document.meshes["sample"].plane_size_m = std::vector<double>{1, 1};
  document.objects = {{.id = "sample", .mesh = "sample", .surface = surface, .world_from_object = {}}};
  return document;
}

// The surfaces that a reflectance evaluates, and where they lie: they outlive the specimen.
struct Held {
  scene::Surface top, beneath;
  surface::Layer base;
};

}  // namespace

Specimen::Specimen(const manifest::Document& document, const std::string& surface) : state_(std::make_unique<State>()) {
  state_->place = manifest::place(document, "/surfaces/" + surface);
  const auto entry = document.surfaces.find(surface);
  if (entry == document.surfaces.end()) {
    std::string known;
    for (const auto& [id, s] : document.surfaces) known += (known.empty() ? "" : ", ") + id;
    throw Error(Exit::data, manifest::place(document, "/surfaces"), "has no surface \"" + surface + "\"",
                known.empty() ? "describe one there, or name a --model" : "it has " + known);
  }
  if (const surface::Model* model = surface::find(entry->second.model); model != nullptr && model->transmits())
    throw Error(Exit::data, state_->place + "/model", "is \"" + entry->second.model + "\", which lets light through",
                "predict the contrast of an opaque surface");
  state_->sigma = entry->second.sigma;
  state_->appearance = scene::build_scene(on_a_plane(document, surface)).appearance;
  const auto& all = state_->appearance.surfaces;
  state_->index = static_cast<std::size_t>(std::ranges::find(all, surface, &scene::Surface::id) - all.begin());
  const scene::Surface& built = state_->surface();
  if (built.varies() || (built.base && all[*built.base].varies()))
    throw Error(Exit::data, state_->place, "varies over the object (textures, vertices, labels or laws)",
                "state one number for each parameter: contrast is predicted of a uniform sample");
  for (const auto& [parameter, sigma] : state_->sigma)
    parameter_named(info(), parameter, state_->place + "/sigma", Exit::data);
}

Specimen::~Specimen() = default;
Specimen::Specimen(Specimen&&) noexcept = default;

const std::string& Specimen::name() const {
  return state_->surface().id;
}
const manifest::ModelInfo& Specimen::info() const {
  return state_->surface().model->info();
}
const manifest::Parameters& Specimen::parameters() const {
  return state_->surface().parameters;
}
const manifest::Sigmas& Specimen::sigma() const {
  return state_->sigma;
}
const std::string& Specimen::place() const {
  return state_->place;
}

Reflectance Specimen::with(const manifest::Parameters& changed) const {
  auto held = std::make_shared<Held>();
  held->top = state_->surface();
  for (const auto& [name, parameter] : changed) held->top.parameters[name] = parameter;
  if (!changed.empty()) scene::refresh(held->top, state_->place);
  if (held->top.base) {
    held->beneath = state_->appearance.surfaces[*held->top.base];
    held->base = {held->beneath.model, held->beneath.values};
    held->top.values.base = &held->base;
  }
  return [held](Vec3 wo, Vec3 wi) { return mean(held->top.model->evaluate(held->top.values, wo, wi)); };
}

const manifest::ParameterInfo& Specimen::declared(const std::string& parameter, const std::string& place) const {
  return parameter_named(info(), parameter, place);
}

double Specimen::number(const std::string& parameter, const std::string& place) const {
  const manifest::ParameterInfo& wanted = declared(parameter, place);
  const auto stated = parameters().find(parameter);
  if (stated != parameters().end() && stated->second.given()) return mean(stated->second.rgb());
  return wanted.preset.value_or(0);
}

const manifest::ParameterInfo& parameter_named(const manifest::ModelInfo& model, const std::string& name,
                                               const std::string& place, Exit code) {
  const auto found = std::ranges::find(model.parameters, name, &manifest::ParameterInfo::name);
  if (found != model.parameters.end()) return *found;
  std::string known;
  for (const auto& p : model.parameters) known += (known.empty() ? "" : ", ") + p.name;
  throw Error(code, place, "names \"" + name + "\", which model \"" + model.id + "\" has not", "it takes " + known);
}

}  // namespace gonio::contrast
