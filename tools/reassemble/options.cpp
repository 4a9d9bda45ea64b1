// The command line of reassemble.
#include <cmath>

#include "base/assignment.h"
#include "base/error.h"
#include "base/quantity.h"
#include "base/text.h"
#include "cli/common_options.h"
#include "tools/reassemble/work.h"

namespace gonio::tools::reassemble {
namespace {

using cli::Type;

AskedPiece piece_of(const std::string& text) {
  AskedPiece piece;
  const auto equals = text.find('=');
  if (equals != std::string::npos) piece.name = text.substr(0, equals);
  piece.file = equals == std::string::npos ? text : text.substr(equals + 1);
  const auto hash = piece.file.rfind('#');
  if (hash != std::string::npos) {
    piece.object = piece.file.substr(hash + 1);
    piece.file.resize(hash);
  }
  if (piece.file.empty() || equals == 0)
    throw Error(Exit::usage, "--piece", "\"" + text + "\" names no file", "say --piece pot=pot.json");
  return piece;
}

Vec3 direction_of(const std::string& text, const char* option) {
  const std::vector<std::string> parts = pieces(text, ',');
  Vec3 v{};
  if (parts.size() == 3) v = {std::atof(parts[0].c_str()), std::atof(parts[1].c_str()), std::atof(parts[2].c_str())};
  if (!(norm(v) > 0) || !std::isfinite(norm(v)))
    throw Error(Exit::usage, option, "\"" + text + "\" is no direction", "give x,y,z of the world, as 0,0,1");
  return normalized(v);
}

std::vector<cli::Option> piece_options() {
  return {
      {.name = "specimen",
       .type = Type::choice,
       .help = "Write something to try things with, and end: a porcelain bowl and its lid, photographed six times.",
       .choices = {"bowl"}},
      {.name = "piece",
       .type = Type::text,
       .help = "A piece: a manifest of ct-mesh-clean with its mesh and markers, under the name that it gets here; "
               "#OBJECT where that manifest has several. Default: the objects of the scene that have markers.",
       .metavar = "[NAME=]FILE[#OBJECT]",
       .repeat = true},
      {.name = "image",
       .type = Type::text,
       .help = "A photograph to look for markers in. Default: all images.",
       .metavar = "ID",
       .repeat = true},
      {.name = "marker-radius",
       .type = Type::quantity,
       .help = "Radius of the markers, where all are alike. Default: as the pieces' manifests have it.",
       .dimension = Dimension::length,
       .lower = 0},
      {.name = "contrast",
       .type = Type::choice,
       .help = "Markers are brighter or darker than what surrounds them.",
       .preset = "either",
       .choices = {"either", "bright", "dark"}},
      {.name = "smallest",
       .type = Type::number,
       .help = "Least radius of a marker in the photographs, px.",
       .preset = "4",
       .lower = 2,
       .upper = 5000},
      {.name = "largest",
       .type = Type::number,
       .help = "Largest radius of a marker in the photographs, px.",
       .preset = "200",
       .lower = 3,
       .upper = 5000},
      {.name = "least-cover",
       .type = Type::number,
       .help = "Share of a marker's outline that has to show an edge.",
       .preset = "0.5",
       .lower = 0.2,
       .upper = 1},
      {.name = "free-scale",
       .type = Type::flag,
       .help = "The tomograph's scale is fitted with the poses, one for all pieces; their meshes are written anew."},
      {.name = "max-error",
       .type = Type::quantity,
       .help = "Exit 2 where a piece's markers are placed less surely than this (one standard deviation).",
       .dimension = Dimension::length,
       .lower = 0},
      {.name = "marker-surface",
       .type = Type::text,
       .help = "Markers enter the scene as spheres with this surface. Default: they do not.",
       .metavar = "NAME"}};
}

std::vector<cli::Option> background_options() {
  return {
      {.name = "background",
       .type = Type::input_file,
       .help =
           "Mesh of the surroundings, scanned in place: a PLY file in the world's frame, or the cloud of one camera "
           "and a projector (structured-light)."},
      {.name = "background-surface",
       .type = Type::text,
       .help = "Its surface, where no label says another.",
       .metavar = "NAME",
       .preset = "background"},
      {.name = "labels",
       .type = Type::flag,
       .help = "Find out by the photographs which surface each face of the background has.",
       .needs = {"background"}},
      {.name = "label-surface",
       .type = Type::text,
       .help = "A surface that the background may have: name in surfaces. Default: found by themselves.",
       .metavar = "NAME",
       .repeat = true,
       .needs = {"labels"}},
      {.name = "seeds",
       .type = Type::text,
       .help = "What a person painted over a photograph: grey value k is the k-th --label-surface, 0 nothing.",
       .metavar = "IMAGE=FILE.png",
       .repeat = true,
       .needs = {"label-surface"}},
      {.name = "shading-spp",
       .type = Type::integer,
       .help = "The light that falls in is rendered with so many samples and divided out. 0: colours alone decide.",
       .preset = "0",
       .lower = 0,
       .upper = 4096,
       .needs = {"label-surface"}}};
}

std::vector<cli::Option> contact_options() {
  return {{.name = "contact",
           .type = Type::choice,
           .help = "How the background gives way to a piece that would stand in it.",
           .preset = "none",
           .choices = {"none", "push", "elastic"},
           .needs = {"background"}},
          {.name = "deepest",
           .type = Type::quantity,
           .help = "A background that would have to give way by more is not moved. Default: 7 % of the piece's size.",
           .dimension = Dimension::length,
           .lower = 0},
          {.name = "settle",
           .type = Type::flag,
           .help = "Pieces that float above or sink into another are moved into contact, within their uncertainty."},
          {.name = "up", .type = Type::text, .help = "The world's vertical.", .metavar = "X,Y,Z", .preset = "0,0,1"},
          cli::report_option()};
}

}  // namespace

std::vector<cli::Option> options() {
  std::vector<cli::Option> all = piece_options();
  for (auto part : {background_options(), contact_options()})
    for (cli::Option& option : part) all.push_back(std::move(option));
  return all;
}

Asked asked(const cli::Invocation& call) {
  Asked a;
  if (call.given("piece"))
    for (const std::string& text : call.texts("piece")) a.pieces.push_back(piece_of(text));
  if (call.given("image")) a.images = call.texts("image");
  if (call.given("marker-radius")) a.marker_radius_m = call.number("marker-radius");
  if (a.marker_radius_m && !(*a.marker_radius_m > 0))
    throw Error(Exit::usage, "--marker-radius", "is 0", "give the radius of the spheres: 2.5mm");
  a.place.radius_m = a.marker_radius_m;
  a.place.free_scale = call.flag("free-scale");
  a.place.seed = call.seed;
  const std::string& contrast = call.text("contrast");
  a.detect.contrast = contrast == "bright" ? reassembly::Contrast::bright
                      : contrast == "dark" ? reassembly::Contrast::dark
                                           : reassembly::Contrast::either;
  a.detect.smallest_px = call.number("smallest");
  a.detect.largest_px = call.number("largest");
  if (a.detect.largest_px <= a.detect.smallest_px)
    throw Error(Exit::usage, "--largest",
                format("%g px is not above --smallest, %g px", a.detect.largest_px, a.detect.smallest_px),
                "give radii in pixels");
  a.detect.least_cover = call.number("least-cover");
  if (call.given("max-error")) a.max_error_m = call.number("max-error");
  if (call.given("marker-surface")) a.marker_surface = call.text("marker-surface");
  if (call.given("background")) a.background = call.text("background");
  a.background_surface = call.text("background-surface");
  a.labels = call.flag("labels");
  if (call.given("label-surface")) a.label_surfaces = call.texts("label-surface");
  if (call.given("seeds"))
    for (const std::string& text : call.texts("seeds")) {
      const auto equals = text.find('=');
      if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
        throw Error(Exit::usage, "--seeds", "\"" + text + "\" is not IMAGE=FILE", "say --seeds left01=seeds.png");
      a.seeds.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    }
  a.shading_spp = static_cast<int>(call.integer("shading-spp"));
  if (call.text("contact") != "none")
    a.contact = call.text("contact") == "push" ? reassembly::Yield::push : reassembly::Yield::elastic;
  if (call.given("deepest")) a.deepest_m = call.number("deepest");
  a.settle = call.flag("settle");
  a.down = -direction_of(call.text("up"), "--up");
  return a;
}

}  // namespace gonio::tools::reassemble
