// The command line of `contrast predict` (predict_call.h). Without a manifest the surface is described by --model,
// --set and --sigma, and is entered into the manifest that is written.
#include "contrast/predict_call.h"

#include <algorithm>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/quantity.h"
#include "base/text.h"
#include "contrast/contrast_options.h"
#include "contrast/predict_page.h"

namespace gonio::contrast {
namespace {

using cli::Type;

const std::vector<std::string> describing = {"model", "set", "sigma"};

// Enters --model with --set and --sigma as a surface of that name.
void enter_surface(cli::Invocation& call) {
  const std::string id = call.given("model") ? call.text("model") : "ridged";
  const manifest::ModelInfo& info = model_named(id);
  manifest::Surface surface;
  surface.model = id;
  if (id == "ridged") surface.parameters = {{"alpha_u", 0.05}, {"alpha_v", 0.05}};
  for (const Assignment& a : assignments(call.texts("set"), "--set", info))
    surface.parameters[a.parameter] = manifest::Parameter(a.values);
  for (const Assignment& a : assignments(call.texts("sigma"), "--sigma", info)) surface.sigma[a.parameter] = a.values;
  for (const Assignment& a : assignments(call.texts("vary"), "--vary", info))
    surface.parameters.try_emplace(a.parameter, a.values.front());
  if (id == "ridged") surface.parameters.try_emplace("ridge_rad", 5 * degree);
  for (const auto& p : info.parameters)
    if (!p.preset && !surface.parameters.contains(p.name))
      throw Error(Exit::usage, "--model " + id, "needs " + p.name + " (" + p.meaning + ")",
                  "give it: --set " + p.name + "=" +
                      (p.unit == "m"     ? "20um"
                       : p.unit == "rad" ? "5deg"
                                         : "0.1"));
  call.document.surfaces[id] = surface;
}

std::string surface_name(const cli::Invocation& call) {
  if (!call.has_document) return call.given("model") ? call.text("model") : "ridged";
  if (call.given("surface")) return call.text("surface");
  const auto& all = call.document.surfaces;
  if (all.size() == 1) return all.begin()->first;
  std::string known;
  for (const auto& [id, surface] : all) known += (known.empty() ? "" : ", ") + id;
  throw Error(all.empty() ? Exit::data : Exit::usage, manifest::place(call.document, "/surfaces"),
              all.empty() ? "has no surface" : "has several surfaces: " + known,
              all.empty() ? "describe one there, or leave the manifest out and name a --model"
                          : "name one: --surface " + all.begin()->first);
}

Experiment experiment_of(const cli::Invocation& call) {
  Experiment e;
  e.light_rad = call.number("light");
  e.plane = call.text("light-plane") == "across" ? LightPlane::across : LightPlane::along;
  e.tilts_rad = quantities(call.text("tilts"), Dimension::angle, "--tilts");
  e.pairs_rad = angle_pairs(call.text("pairs"), "--pairs");
  e.light_spread_rad = call.number("light-spread");
  e.camera_spread_rad = call.number("camera-spread");
  e.veil = call.number("veil");
  e.definition = call.text("definition") == "difference" ? Definition::difference : Definition::michelson;
  check(e);
  return e;
}

std::vector<Varied> varied_of(const cli::Invocation& call, const manifest::ModelInfo& info) {
  std::vector<Varied> varied;
  for (Assignment& a : assignments(call.texts("vary"), "--vary", info)) varied.push_back({a.parameter, a.values});
  const bool set =
      std::ranges::any_of(call.texts("set"), [](const std::string& s) { return s.starts_with("ridge_rad"); });
  if (varied.empty() && !call.has_document && info.id == "ridged" && !set)
    varied.push_back({"ridge_rad", {5 * degree, 10 * degree, 15 * degree, 20 * degree}});
  return varied;
}

void write_tables(cli::Invocation& call, const Prediction& p) {
  const std::vector<std::pair<std::string, std::string>> tables{{"contrasts.csv", combinations_csv(p)},
                                                                {"means.csv", means_csv(p)}};
  std::vector<std::filesystem::path> paths;
  for (const auto& [name, content] : tables) paths.push_back(call.output_path(name));
  for (std::size_t i = 0; i < tables.size(); ++i) {
    write_file(paths[i], tables[i].second);
    manifest::add_file(call.document, paths[i], "predicted-" + file_stem(paths[i].stem().string()));
  }
}

}  // namespace

std::vector<cli::Option> predict_options() {
  return {{.name = "model",
           .type = Type::text,
           .help = "Model of the surface, where there is no manifest; ridged by "
                   "default, with ridge angles of 5 to 20 degrees and a roughness of 0.05.",
           .metavar = "ID"},
          {.name = "set",
           .type = Type::text,
           .help = "A parameter of --model, with its unit.",
           .metavar = "NAME=VALUE",
           .repeat = true},
          {.name = "sigma",
           .type = Type::text,
           .help = "The standard deviation of a parameter of --model.",
           .metavar = "NAME=VALUE",
           .repeat = true},
          {.name = "surface",
           .type = Type::text,
           .help = "Surface of the manifest, where it has several.",
           .metavar = "NAME"},
          {.name = "vary",
           .type = Type::text,
           .help = "Predict for each of these values of a parameter.",
           .metavar = "NAME=VALUE,...",
           .repeat = true},
          {.name = "tilts",
           .type = Type::text,
           .help = "Tilts of the camera against the sample's normal.",
           .metavar = "ANGLE,...",
           .preset = "-20deg,-10deg,0deg,10deg,20deg"},
          {.name = "pairs",
           .type = Type::text,
           .help = "Pairs of rotations about the normal that are compared.",
           .metavar = "ANGLE:ANGLE,...",
           .preset = "0deg:90deg,90deg:180deg"},
          {.name = "light",
           .type = Type::quantity,
           .help = "Angle of the lamp from the camera.",
           .preset = "10deg",
           .dimension = Dimension::angle,
           .lower = -3.1,
           .upper = 3.1},
          {.name = "light-plane",
           .type = Type::choice,
           .help = "Whether the lamp stands across the plane in which the "
                   "camera tilts, or along it.",
           .preset = "across",
           .choices = {"across", "along"}},
          {.name = "light-spread",
           .type = Type::quantity,
           .help = "Half angle of the lamp as the sample sees it.",
           .preset = "0deg",
           .dimension = Dimension::angle,
           .lower = 0,
           .upper = 0.8},
          {.name = "camera-spread",
           .type = Type::quantity,
           .help = "Half angle of the lens as the sample sees it.",
           .preset = "0deg",
           .dimension = Dimension::angle,
           .lower = 0,
           .upper = 0.8},
          {.name = "veil",
           .type = Type::number,
           .help = "Diffuse reflectance of light from beneath, the same in every "
                   "rotation.",
           .preset = "0",
           .lower = 0,
           .upper = 1},
          {.name = "definition",
           .type = Type::choice,
           .help = "Contrast that is averaged: |a - b| as published, or "
                   "|a - b| / (a + b).",
           .preset = "difference",
           .choices = {"difference", "michelson"}},
          {.name = "draws",
           .type = Type::integer,
           .help = "Draws of uncertain parameters.",
           .preset = "400",
           .lower = 20,
           .upper = 100000}};
}

void predict_check(cli::Invocation& call) {
  for (const std::string& name : describing)
    if (call.has_document && (call.given(name) || !call.texts(name).empty()))
      throw Error(Exit::usage, "--" + name, "describes a surface, and the manifest does so already",
                  "leave the manifest out, or change its surface there; --vary replaces numbers");
  if (!call.has_document && call.given("surface"))
    throw Error(Exit::no_input, "--surface", "names a surface of a manifest, and there is none",
                "name the manifest: contrast predict scene.json --surface " + call.text("surface"));
  experiment_of(call);
  if (!call.has_document) enter_surface(call);
  const std::string name = surface_name(call);
  if (const auto found = call.document.surfaces.find(name); found != call.document.surfaces.end())
    varied_of(call, model_named(found->second.model));
}

Exit predict_call(cli::Invocation& call) {
  const Specimen specimen(call.document, surface_name(call));
  const Prediction p = predict(specimen, {.experiment = experiment_of(call),
                                          .varied = varied_of(call, specimen.info()),
                                          .draws = static_cast<int>(call.integer("draws")),
                                          .seed = call.seed});
  if (!call.out.empty()) write_tables(call, p);
  if (call.given("html")) write_file(call.text("html"), predict_page(p));
  return Exit::done;
}

}  // namespace gonio::contrast
