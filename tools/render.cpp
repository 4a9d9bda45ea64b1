// render: the photographs that a scene would give, path traced to EXR with variance and geometry.
#include "base/text.h"
#include "cli/program.h"
#include "io/picture.h"
#include "render/entries.h"
#include "render/path_tracer.h"
#include "render/preview.h"
#include "render/specimen.h"
#include "render/virtual_sensor.h"
#include "scene/mechanisms.h"

namespace gonio::tools::render {
namespace {

using namespace gonio::render;
using cli::Type;

std::vector<std::string> specimen_names() {
  std::vector<std::string> names;
  for (const Specimen& s : specimens()) names.push_back(s.name);
  return names;
}

cli::Program describe() {
  cli::Program program;
  program.name = "render";
  program.sentence = "simulate photographs of a scene by path tracing";
  program.synopsis = {"[OPTION]... --out DIR [scene.json]", "--specimen NAME [--out DIR]"};
  program.operands = {{.name = "SCENE", .type = Type::input_file, .help = "Manifest with the scene; ends in .json."}};
  program.options = {
      {.name = "image", .type = Type::text, .help = "Simulate this image only.", .metavar = "ID", .repeat = true},
      {.name = "spp",
       .type = Type::integer,
       .help = "Samples per pixel, at least 2; rounded up to complete strata.",
       .preset = "256",
       .lower = 1,
       .upper = 1 << 20},
      {.name = "max-bounces",
       .type = Type::integer,
       .help = "Longest path, in scattering events.",
       .preset = "128",
       .lower = 1,
       .upper = 10000},
      {.name = "aov",
       .type = Type::choice,
       .help = "Write position, normal, id, distance and visibility of lights, too.",
       .preset = "on",
       .choices = {"on", "off"}},
      {.name = "with",
       .type = Type::text,
       .help = "Switch on this mechanism for the pictures alone: ID:PARAMETER=VALUE,...,on=NAME. The manifest that is "
               "written does not mention it outside its provenance.",
       .metavar = "MECHANISM",
       .repeat = true},
      {.name = "record",
       .type = Type::flag,
       .help = "Make virtual recordings: add the noise that the images state, enter the pictures as the images' files, "
               "and set free parameters with bounds to their middle.",
       .needs = {"out"}},
      {.name = "preview",
       .type = Type::flag,
       .help = "Write a PNG beside every picture, in sRGB, its 99th percentile white.",
       .needs = {"out"}},
      {.name = "specimen",
       .type = Type::choice,
       .help = "Print the manifest of a built-in scene and end; meshes are written into --out.",
       .choices = specimen_names()},
  };
  program.standalone = {"specimen"};
  program.takes_out = program.takes_seed = true;
  program.sections_read = {"files", "cameras", "images", "meshes", "surfaces", "lights", "objects", "mechanisms"};
  program.sections_written = {"files", "images", "renderings"};
  program.files = {{"ID.exr",
                    "R, G, B radiance; variance.R/G/B of the pixel's mean; id (object's place + 1), position.X/Y/Z, "
                    "normal.X/Y/Z (world, m); distance.LIGHT (m), visibility.LIGHT (0 to 1)"},
                   {"ID.png", "--preview"}};
  program.references = {"Kajiya, The rendering equation, SIGGRAPH 1986",
                        "Veach, Robust Monte Carlo methods for light transport simulation, 1997",
                        "Wald et al., Embree, ACM TOG 33(4), 2014"};
  program.see_also = {"compare(1)", "explain(1)", "gonio-manifest(5)", "gonio-conventions(7)"};
  return program;
}

scene::Scene scene_of(cli::Invocation& call) {
  manifest::Document seen = call.document;
  for (const std::string& text : call.texts("with")) {
    const auto [mechanism, use] = scene::parse_mechanism(text, "--with");
    seen.mechanisms[mechanism->id] = use;
  }
  scene::Reading reading;
  reading.on_file = [&](const std::filesystem::path& path) { call.note_input(path); };
  return scene::build_scene(seen, reading);
}

void check(cli::Invocation& call) {
  if (call.given("specimen")) return;
  if (!call.texts("SCENE").empty())
    throw Error(Exit::usage, call.text("SCENE"), "is no manifest by its name",
                "give a file that ends in .json, or use -i");
  if (!call.has_document) throw Error(Exit::no_input, "render", "has no scene", "name one: render scene.json --out r");
  if (call.out.empty()) throw Error(Exit::usage, "--out", "is missing", "name the folder for the pictures");
  for (const std::size_t i : chosen_images(call.document, call.texts("image")))
    if (call.flag("record") && !call.document.images[i].noise)
      throw Error(Exit::data, manifest::place(call.document, "/images/" + std::to_string(i)),
                  "states no noise to record with", "add \"noise\": {\"gain\", \"read\"}");
  if (call.flag("check")) scene_of(call);
}

Exit run(cli::Invocation& call) {
  if (call.given("specimen")) {
    call.document = specimen(call.text("specimen"), call.out);
    return Exit::done;
  }
  const auto images = chosen_images(call.document, call.texts("image"));
  std::vector<std::filesystem::path> paths;  // asked for before the work begins: an existing file is an error at once
  for (const std::size_t i : images) paths.push_back(call.output_path(file_stem(call.document.images[i].id) + ".exr"));
  const scene::Scene scene = scene_of(call);
  const RayCaster caster(scene.instances);
  const Options options{.spp = static_cast<int>(call.integer("spp")),
                        .seed = call.seed,
                        .geometry = call.text("aov") == "on" && !call.flag("record"),
                        .transport = {.max_bounces = static_cast<int>(call.integer("max-bounces"))}};
  for (std::size_t k = 0; k < images.size(); ++k) {
    const manifest::ImageEntry& image = call.document.images[images[k]];
    io::Image picture = gonio::render::render(scene, images[k], caster, options);
    if (call.flag("record")) picture = recorded(picture, *image.noise, image.id, call.seed);
    io::write_picture(paths[k], picture);
    if (call.flag("preview")) io::write_picture(call.output_path(file_stem(image.id) + ".png"), preview(picture));
    if (call.flag("record"))
      enter_recording(call.document, images[k], paths[k]);
    else
      enter_rendering(call.document, images[k], paths[k], sample_plan(options.spp).spp(), call.seed);
  }
  if (call.flag("record")) forget_free_values(call.document);
  return Exit::done;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program = [] {
    cli::Program p = describe();
    p.check = check;
    p.run = run;
    return p;
  }();
  return program;
}

}  // namespace gonio::tools::render
