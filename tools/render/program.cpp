// render: the photographs that a scene would give, path traced to EXR with variance and geometry.
#include "cli/program.h"

#include "render/specimen.h"
#include "tools/render/call.h"

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
  program.synopsis = {"[OPTION]... --out DIR [scene.json]", "--merge --out DIR [scene.json] SHARE.exr...",
                      "--specimen NAME [--out DIR]"};
  program.operands = {{.name = "FILE",
                       .type = Type::input_file,
                       .help = "Manifest with the scene, which ends in .json; with --merge, shares of pictures.",
                       .repeat = true}};
  program.options = {
      {.name = "image", .type = Type::text, .help = "Simulate this image only.", .metavar = "ID", .repeat = true},
      {.name = "spp",
       .type = Type::integer,
       .help = "Samples per pixel, at least 2; rounded up to complete passes. With --time or --noise: at most.",
       .preset = "256",
       .lower = 1,
       .upper = 1 << 20},
      {.name = "time",
       .type = Type::quantity,
       .help = "Stop after this time, once the pass is complete; per image.",
       .dimension = Dimension::time,
       .lower = 0,
       .conflicts = {"samples"}},
      {.name = "noise",
       .type = Type::quantity,
       .help = "Stop when the estimated relative error of the picture is this small; 1% is usual.",
       .dimension = Dimension::ratio,
       .lower = 1e-6,
       .upper = 1,
       .conflicts = {"samples"}},
      {.name = "samples",
       .type = Type::text,
       .help = "Render a share: samples A to B - 1 of the --spp of each pixel. Keeps ID.sums for --merge.",
       .metavar = "A:B",
       .conflicts = {"record"}},
      {.name = "merge",
       .type = Type::flag,
       .help = "Join shares into the very picture that one run over all their samples gives.",
       .conflicts = {"samples", "time", "noise", "spp", "record", "specimen", "resume"},
       .needs = {"out"}},
      {.name = "sums",
       .type = Type::flag,
       .help = "Keep the exact sums beside each picture, for --merge.",
       .conflicts = {"record"},
       .needs = {"out"}},
      {.name = "checkpoint",
       .type = Type::quantity,
       .help = "Write what is done so far this often, for --resume; never more than a twentieth of the time.",
       .preset = "10s",
       .dimension = Dimension::time,
       .lower = 0},
      {.name = "max-bounces",
       .type = Type::integer,
       .help = "Longest path, in scattering events.",
       .preset = "128",
       .lower = 1,
       .upper = 10000},
      {.name = "aov",
       .type = Type::choice,
       .help = "Write position, normal, depth, id, mask, distance and visibility of lights, too.",
       .preset = "on",
       .choices = {"on", "off"}},
      {.name = "per-light", .type = Type::flag, .help = "Write the light of each lamp as a layer, too."},
      {.name = "stokes", .type = Type::flag, .help = "Follow polarization; write the Stokes vectors' s1, s2, s3, too."},
      {.name = "wavelengths",
       .type = Type::text,
       .help = "Write spectral channels, too: N wavelengths from A to B, such as 400nm:700nm:31.",
       .metavar = "A:B:N"},
      {.name = "allow-open", .type = Type::flag, .help = "Let meshes with holes bound glass and liquids."},
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
      {.name = "preview-layers",
       .type = Type::flag,
       .help = "Write a PNG of each other layer: depth, normals, Stokes vectors.",
       .needs = {"out"}},
      {.name = "specimen",
       .type = Type::choice,
       .help = "Print the manifest of a built-in scene and end; meshes are written into --out.",
       .choices = specimen_names()},
  };
  program.standalone = {"specimen"};
  program.takes_out = program.takes_seed = program.takes_resume = true;
  program.sections_read = {"files",        "cameras", "images",  "meshes",    "surfaces",
                           "environments", "lights",  "objects", "mechanisms"};
  program.sections_written = {"files", "images", "renderings"};
  program.files = {{"ID.exr",
                    "R, G, B radiance; variance.R/G/B of the pixel's mean; id (object's place + 1), position.X/Y/Z, "
                    "normal.X/Y/Z (world, m), depth.Z (m along the camera's axis), mask.A (share of samples that met a "
                    "surface), back_normal.X/Y/Z (of objects that let light through); distance.LIGHT (m), "
                    "visibility.LIGHT (0 to 1); light.LIGHT.R/G/B with --per-light; s1.R to s3.B and their variance "
                    "with --stokes; S0.550,0nm with --wavelengths"},
                   {"ID.sums", "--samples, --sums: exact sums for --merge"},
                   {"ID.checkpoint", "while the work goes on"},
                   {"ID-mosaic.exr",
                    "--stokes, of cameras whose mosaic is \"polarizers\": R, G, B of every pixel behind "
                    "its polarizer, super-pixel [90 45; 135 0] degrees"},
                   {"ID.png", "--preview"},
                   {"ID-LAYER.png",
                    "--preview-layers: depth (near dark, far bright), normal and back-normal (0.5 + 0.5 n; red, green, "
                    "blue for the world's x, y, z), s1, s2, s3 (red positive, blue negative, one scale)"}};
  program.exits = {{Exit::quality, "A picture is noisier than --noise asks for; --spp or --time ended first."}};
  program.references = {"Kajiya, The rendering equation, SIGGRAPH 1986",
                        "Veach, Robust Monte Carlo methods for light transport simulation, 1997",
                        "Wald et al., Embree, ACM TOG 33(4), 2014",
                        "Fichet et al., An OpenEXR layout for spectral images, JCGT 10(3), 2021"};
  program.see_also = {"compare(1)", "explain(1)", "gonio-manifest(5)", "gonio-conventions(7)"};
  return program;
}

Exit run(cli::Invocation& call) {
  if (call.given("specimen")) {
    call.document = specimen(call.text("specimen"), call.out);
    return Exit::done;
  }
  return call.flag("merge") ? merge(call) : render_images(call);
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
