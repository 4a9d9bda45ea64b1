// See options.h.
#include "tools/align/options.h"

#include <map>

#include "base/error.h"

namespace gonio::tools::align {
namespace {

using cli::Type;

// NAME=VALUE, each name once.
std::map<std::string, std::string> pairs_of(cli::Invocation& call, const std::string& option) {
  std::map<std::string, std::string> pairs;
  for (const std::string& text : call.texts(option)) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
      throw Error(Exit::usage, "--" + option, "\"" + text + "\" is no IMAGE=NAME");
    pairs[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return pairs;
}

}  // namespace

alignment::AlignmentRequest request_of(cli::Invocation& call) {
  alignment::AlignmentRequest request;
  request.input.objects = call.texts("object");
  for (const std::string& what : call.texts("free")) request.input.freed.insert(what);
  for (const std::string& what : call.texts("hold")) request.input.held.insert(what);
  for (const std::string& light : call.texts("carried")) request.input.carried.insert(light);
  request.input.scale_sigma = call.number("scale-sigma");
  request.input.contact_m = call.flag("no-contact") ? 0 : call.number("contact");
  request.input.smooth_px = call.number("smooth");
  const std::string& from = call.text("from");
  using From = alignment::AlignWish::From;
  request.wish.from = from == "stated" ? From::stated : from == "nothing" ? From::nothing : From::either;
  request.input.any_start = request.wish.from != From::stated;
  request.wish.lamps_known = request.input.held.contains("light");
  request.wish.reach_px = call.number("reach");
  request.wish.least_share = call.number("least-share");
  request.wish.most_sigma_px = call.number("limit");
  request.wish.search.directions = static_cast<int>(call.integer("directions"));
  request.wish.search.move_station = request.input.freed.contains("camera") && request.input.held.contains("pose");
  if (call.flag("picture")) request.pictures.emplace();
  using By = alignment::MaskWish::By;
  const std::map<std::string, By> ways{{"given", By::given},
                                       {"lamps", By::lamps},
                                       {"background", By::background},
                                       {"alone", By::alone},
                                       {"strokes", By::strokes}};
  request.masks.by = ways.at(call.text("masks"));
  if (request.input.objects.size() == 1) request.masks.object = request.input.objects[0];
  request.masks.backgrounds = pairs_of(call, "background");
  for (const auto& [image, file] : pairs_of(call, "strokes")) request.masks.strokes[image] = file;
  if (call.given("html")) request.page = call.text("html");
  if (!call.out.empty()) request.output_path = [&call](const std::string& name) { return call.output_path(name); };
  request.note_input = [&call](const std::filesystem::path& path) { call.note_input(path); };
  return request;
}

std::vector<cli::Option> options() {
  return {
      {.name = "object",
       .type = Type::text,
       .help = "Object to align; may be repeated. Left out: all that outlines show.",
       .metavar = "ID",
       .repeat = true},
      {.name = "masks",
       .type = Type::choice,
       .help = "Where masks come from: the manifest's outlines; several pictures from one place under several lamps; a "
               "picture without the object; one picture alone; strokes that somebody drew.",
       .preset = "given",
       .choices = {"given", "lamps", "background", "alone", "strokes"}},
      {.name = "background",
       .type = Type::text,
       .help = "With --masks background: which image shows the same place, without the object, under the same lamp.",
       .metavar = "IMAGE=IMAGE",
       .repeat = true},
      {.name = "strokes",
       .type = Type::text,
       .help =
           "With --masks strokes: a picture as large as the photograph, pure red on the object, blue on its shadow, "
           "green on the ground.",
       .metavar = "IMAGE=FILE",
       .repeat = true},
      {.name = "from",
       .type = Type::choice,
       .help =
           "Where to begin: at the stated pose, from nothing, or at the stated one and, where that leads nowhere, from "
           "nothing.",
       .preset = "either",
       .choices = {"stated", "nothing", "either"}},
      {.name = "free",
       .type = Type::choice,
       .help = "What else is not known, beside poses and lamps: the mesh's three scales, one size, the cameras' poses, "
               "their "
               "focal lengths, the ground. May be repeated.",
       .choices = {"scale", "size", "camera", "focal", "ground"},
       .repeat = true},
      {.name = "hold",
       .type = Type::choice,
       .help = "What is known exactly. May be repeated.",
       .choices = {"pose", "light"},
       .repeat = true},
      {.name = "carried",
       .type = Type::text,
       .help =
           "Lamp that a robot's tool carries: it has another place at every base_from_tool of the images, and these "
           "are written as light_positions. May be repeated.",
       .metavar = "LIGHT",
       .repeat = true},
      {.name = "scale-sigma",
       .type = Type::number,
       .help = "One standard deviation of scales about 1, before anything is seen.",
       .preset = "0.05",
       .lower = 1e-6,
       .upper = 1},
      {.name = "contact",
       .type = Type::quantity,
       .help = "One standard deviation of the lowest vertex's height over the ground.",
       .preset = "0.1mm",
       .dimension = Dimension::length,
       .lower = 1e-7,
       .upper = 1},
      {.name = "no-contact",
       .help = "The object hangs, or the ground is known badly: it need not touch.",
       .conflicts = {"contact"}},
      {.name = "picture",
       .help = "A last step: refine what is free by the photographs themselves, direct light and shading beside the "
               "rims. Where that contradicts the rims, their answer is kept, and a warning says so.",
       .conflicts = {"carried"}},
      {.name = "reach",
       .type = Type::number,
       .help = "How far rims may be off at the stated pose, px.",
       .preset = "60",
       .lower = 4,
       .upper = 2000},
      {.name = "smooth",
       .type = Type::number,
       .help = "Gaussian that smooths the staircase of binary masks, px.",
       .preset = "1.2",
       .lower = 0.3,
       .upper = 10},
      {.name = "limit",
       .type = Type::number,
       .help = "Lost where points lie farther off the rims than this, one standard deviation, px.",
       .preset = "0.75",
       .lower = 0.05,
       .upper = 50},
      {.name = "least-share",
       .type = Type::number,
       .help = "Lost where less of the model's rims was seen than this, or less of what was seen is the model's.",
       .preset = "0.8",
       .lower = 0.1,
       .upper = 1},
      {.name = "directions",
       .type = Type::integer,
       .help = "From nothing: directions from which the object may be seen.",
       .preset = "400",
       .lower = 20,
       .upper = 100000},
      {.name = "html", .type = Type::output_file, .help = "Write a report page here."}};
}

}  // namespace gonio::tools::align
