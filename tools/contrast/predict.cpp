// The command line of `contrast predict` (run_predict.h). Without a manifest the surface is described by --model,
// --set and --sigma, and is entered into the manifest that is written.
#include "tools/contrast/predict.h"

#include <algorithm>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/quantity.h"
#include "base/text.h"
#include "manifest/sections/contrast.h"
#include "manifest/sections/surface.h"
#include "surface/surface.h"
#include "tools/contrast/lists.h"
#include "tools/contrast/optimize_page.h"
#include "tools/contrast/predict_page.h"

namespace gonio::tools::contrast {

using namespace gonio::contrast;

namespace {

using cli::Type;

const std::vector<std::string> describing = {"model", "set", "sigma"};

// What --set gives one parameter. Error(usage) at it.
manifest::Parameter value_of(const Assignment& a, const manifest::ParameterInfo& info) {
  const std::string place = "--set " + a.parameter, unit = info.unit == "1" ? "" : " " + info.unit;
  const std::size_t count = a.values.size();
  if (count != 1 && static_cast<int>(count) != info.components)
    throw Error(Exit::usage, place, "has " + std::to_string(count) + " values",
                info.components == 1 ? "give one here, and several to --vary" : "give one, or three");
  for (const double x : a.values)
    if (!(x >= info.lower && x <= info.upper))
      throw Error(Exit::usage, place,
                  "is " + shortest_text(x) + ", outside " + shortest_text(info.lower) + " to " +
                      shortest_text(info.upper) + unit,
                  info.meaning);
  return manifest::Parameter(a.values);
}

// Models that options describe completely.
void check_model(const manifest::ModelInfo& info) {
  const auto refuse = [&](const char* what, const char* remedy) {
    throw Error(Exit::usage, "--model " + info.id, what, remedy);
  };
  if (surface::find(info.id)->transmits()) refuse("lets light through", "predict the contrast of an opaque surface");
  if (info.takes_base) refuse("lies on another surface", "describe both in a manifest");
  if (info.attachment != manifest::Attachment::none) refuse("needs a file", "name it in a manifest");
}

// Enters --model with --set and --sigma as a surface of that name.
void enter_surface(cli::Invocation& call) {
  const std::string id = call.given("model") ? call.text("model") : "ridged";
  const manifest::ModelInfo& info = model_named(id);
  check_model(info);
  manifest::Surface surface;
  surface.model = id;
  if (id == "ridged") surface.parameters = {{"alpha_u", 0.05}, {"alpha_v", 0.05}, {"walls", 0.0}};
  const std::vector<Assignment> set = assignments(call.texts("set"), "--set", info);
  for (const Assignment& a : set) {
    if (std::ranges::count(set, a.parameter, &Assignment::parameter) > 1)
      throw Error(Exit::usage, "--set " + a.parameter, "is given twice", "give one value here, and several to --vary");
    surface.parameters[a.parameter] = value_of(a, parameter_named(info, a.parameter, "--set"));
  }
  for (const Assignment& a : assignments(call.texts("sigma"), "--sigma", info)) {
    if (std::ranges::any_of(a.values, [](double v) { return v < 0; }))
      throw Error(Exit::usage, "--sigma " + a.parameter, "is negative", "a standard deviation is 0 or more");
    surface.sigma[a.parameter] = a.values;
  }
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

using Tables = std::vector<std::pair<std::string, std::string>>;  // name, content

void write_tables(cli::Invocation& call, const Tables& tables) {
  if (call.out.empty()) return;
  std::vector<std::filesystem::path> paths;
  for (const auto& [name, content] : tables) paths.push_back(call.output_path(name));
  for (std::size_t i = 0; i < tables.size(); ++i) {
    write_file(paths[i], tables[i].second);
    manifest::add_file(call.document, paths[i], "predicted-" + file_stem(paths[i].stem().string()));
  }
}

Prediction predicted(const cli::Invocation& call, const Specimen& specimen, std::vector<Varied> varied) {
  return predict(specimen, {.experiment = experiment_of(call),
                            .varied = std::move(varied),
                            .draws = static_cast<int>(call.integer("draws")),
                            .seed = call.seed});
}

// Earlier predictions of the same surface give way; measured contrasts and other surfaces' stay.
void enter_contrasts(cli::Invocation& call, const Prediction& p) {
  std::erase_if(call.document.contrasts,
                [&p](const manifest::Contrast& c) { return c.action == "predict" && c.surface == p.surface; });
  for (manifest::Contrast& entry : entries_of(p)) call.document.contrasts.push_back(std::move(entry));
}

Tables tables_of(const Prediction& p) {
  return {{"contrasts.csv", combinations_csv(p)}, {"means.csv", means_csv(p)}};
}

// --bound, and where it is left out, of ridged, what can be milled; the pitch ends where it would be seen.
std::vector<Bound> bounds_of(const cli::Invocation& call, const manifest::ModelInfo& info) {
  std::vector<Bound> bounds;
  std::vector<std::string> of_model;
  const double visible_m = call.number("distance") * call.number("acuity");
  for (const std::string& text : call.texts("bound")) {
    if (!text.starts_with(std::string(pitch_name) + "=")) {
      of_model.push_back(text);
      continue;
    }
    const auto ends = pieces(text.substr(text.find('=') + 1), ':');
    if (ends.size() != 2) throw Error(Exit::usage, "--bound", "\"" + text + "\" is no range", "write it as LOW:HIGH");
    const auto length = [](const std::string& t) { return parse_quantity(t, Dimension::length, "--bound pitch_m"); };
    bounds.push_back({pitch_name, length(ends[0]), std::min(length(ends[1]), visible_m)});
    if (bounds.back().lower >= visible_m)
      throw Error(Exit::usage, "--bound pitch_m",
                  "begins at " + format("%.4g", bounds.back().lower * 1e6) + " um, and ridges of " +
                      format("%.4g", visible_m * 1e6) + " um are seen one by one at --distance",
                  "look from further away, or allow a smaller pitch");
  }
  for (const Assignment& a : assignments(of_model, "--bound", info, ':'))
    bounds.push_back({a.parameter, a.values[0], a.values[1]});
  if (bounds.empty() && info.id == "ridged")
    bounds = {{"ridge_rad", 1 * degree, 30 * degree}, {"alpha_u", 0.02, 0.3}, {"alpha_v", 0.02, 0.3}};
  if (call.texts("bound").empty() && info.id == "ridged" && visible_m > 20e-6)
    bounds.push_back({pitch_name, 20e-6, visible_m});
  return bounds;
}

Wish wish_of(const cli::Invocation& call, const manifest::ModelInfo& info) {
  return {.experiment = experiment_of(call),
          .bounds = bounds_of(call, info),
          .least = call.text("over") == "least",
          .wavelength_m = call.number("wavelength")};
}

// The surface found goes into the manifest beside the one it was found from.
Exit optimized(cli::Invocation& call, const Specimen& specimen) {
  const Wish wish = wish_of(call, specimen.info());
  const Optimum optimum = optimize(specimen, wish);
  manifest::Surface best = call.document.surfaces.at(specimen.name());
  best.parameters = optimum.parameters;
  best.sigma.clear();
  const std::string name = specimen.name() + "-optimum";
  call.document.surfaces[name] = best;
  const Prediction p = predicted(call, Specimen(call.document, name), {});
  enter_contrasts(call, p);
  Tables tables = tables_of(p);
  tables.emplace_back("optimum.csv", optimum_csv(optimum));
  write_tables(call, tables);
  if (call.given("html")) write_file(call.text("html"), optimize_page(optimum, wish, p));
  log(LogLevel::info, optimum_sentence(optimum, wish));
  for (const auto& n : optimum.numbers)
    if (n.at_bound != 0)
      log(LogLevel::warning, "--bound " + n.parameter + ": its " + (n.at_bound < 0 ? "lower" : "upper") +
                                 " end holds the optimum; the contrast would grow beyond it");
  return Exit::done;
}

}  // namespace

std::vector<cli::Option> predict_options() {
  return {{.name = "model",
           .type = Type::text,
           .help = "Model of the surface, where there is no manifest; ridged by "
                   "default, with ridge angles of 5 to 20 degrees, a roughness of 0.05 and, as published, walls that "
                   "swallow what they meet (walls=0; 1 where they reflect like facets).",
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
           .upper = 100000},
          {.name = "optimize",
           .type = Type::flag,
           .help = "Find the surface of greatest contrast within --bound, and how "
                   "much each of its numbers matters.",
           .conflicts = {"vary"}},
          {.name = "bound",
           .type = Type::text,
           .help = "What --optimize may do to a parameter, or to the pitch_m of ridges.",
           .metavar = "NAME=LOW:HIGH",
           .repeat = true,
           .needs = {"optimize"}},
          {.name = "over",
           .type = Type::choice,
           .help = "What --optimize makes large: the mean over all tilts, or the least "
                   "contrast of a tilt.",
           .preset = "mean",
           .choices = {"mean", "least"},
           .needs = {"optimize"}},
          {.name = "wavelength",
           .type = Type::quantity,
           .help = "At which diffraction spreads the light of ridges.",
           .preset = "550nm",
           .dimension = Dimension::length,
           .lower = 1e-8,
           .upper = 1e-4,
           .needs = {"optimize"}},
          {.name = "distance",
           .type = Type::quantity,
           .help = "From which ridges must not be seen one by one.",
           .preset = "0.5m",
           .dimension = Dimension::length,
           .lower = 1e-3,
           .upper = 1e3,
           .needs = {"optimize"}},
          {.name = "acuity",
           .type = Type::quantity,
           .help = "Angle that eye or camera tells apart.",
           .preset = "0.3mrad",
           .dimension = Dimension::angle,
           .lower = 1e-7,
           .upper = 0.1,
           .needs = {"optimize"}}};
}

void check_predict(cli::Invocation& call) {
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
    call.flag("optimize") ? static_cast<void>(bounds_of(call, model_named(found->second.model)))
                          : static_cast<void>(varied_of(call, model_named(found->second.model)));
}

Exit run_predict(cli::Invocation& call) {
  const Specimen specimen(call.document, surface_name(call));
  if (call.flag("optimize")) return optimized(call, specimen);
  const Prediction p = predicted(call, specimen, varied_of(call, specimen.info()));
  enter_contrasts(call, p);
  write_tables(call, tables_of(p));
  if (call.given("html")) write_file(call.text("html"), predict_page(p));
  return Exit::done;
}

}  // namespace gonio::tools::contrast
