// See options.h.
#include "tools/structured-light/options.h"

#include "base/quantity.h"
#include "scan/decode.h"
#include "tools/structured-light/pattern.h"

namespace gonio::tools::structured_light {

using cli::Type;

std::vector<cli::Option> options() {
  std::vector<cli::Option> all = pattern_options();
  const std::vector<cli::Option> more{
      {.name = "name",
       .type = Type::text,
       .help = "Of the projection in the manifest; left out, measuring takes the only one.",
       .metavar = "NAME",
       .preset = "projection"},
      {.name = "camera",
       .type = Type::text,
       .help = "Which looks on; the first one's pixels are those of the points that it sees.",
       .metavar = "NAME",
       .repeat = true},
      {.name = "projector",
       .type = Type::text,
       .help =
           "The camera of the rig that is the projector. Left out: the cameras measure, and the projector only marks.",
       .metavar = "NAME"},
      {.name = "response",
       .type = Type::choice,
       .help = "What the codes of PICTURE mean.",
       .preset = "linear",
       .choices = {"linear", "srgb"}},
      {.name = "least-light",
       .type = Type::number,
       .help =
           "Pixels that the projector's white lights by less, as a share of a full picture, are dark, whatever their "
           "noise.",
       .preset = "0",
       .lower = 0,
       .upper = 1e6},
      {.name = "least-difference",
       .type = Type::number,
       .help = "A bit and its inverse that differ by less, as a share of a full picture, are the border of a stripe, "
               "whatever their noise.",
       .preset = "0",
       .lower = 0,
       .upper = 1e6},
      {.name = "least-share",
       .type = Type::number,
       .help = "The same, as a share of what white adds there.",
       .preset = "0.05",
       .lower = 0,
       .upper = 0.9},
      {.name = "least-sigmas",
       .type = Type::number,
       .help = "The same, in standard deviations of the difference.",
       .preset = "2",
       .lower = 0,
       .upper = 100},
      {.name = "least-direct",
       .type = Type::number,
       .help = "Of cosines: pixels that send back a smaller share of light straight, against the best tenth of the "
               "picture, lie on something translucent and are refused. 0: none.",
       .preset = "0.25",
       .lower = 0,
       .upper = 1},
      {.name = "keep-moved", .type = Type::flag, .help = "Keep pixels that saw something move."},
      {.name = "keep-indirect", .type = Type::flag, .help = "Keep pixels that indirect light may have changed."},
      {.name = "shape",
       .type = Type::choice,
       .help = "What all points lie on, where that is known: explain(1) asks of four clouds and more why they do not.",
       .choices = {"plane", "sphere"}},
      {.name = "radius",
       .type = Type::quantity,
       .help = "Of the sphere, calibrated.",
       .dimension = Dimension::length,
       .lower = 1e-6,
       .upper = 1e3,
       .needs = {"shape"}},
      {.name = "html", .type = Type::output_file, .help = "Write a report page here."},
      {.name = "codes", .type = Type::flag, .help = "Write VIEW-CAMERA-codes.exr, too."}};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::string refusals() {
  std::string all = "0 told";
  for (std::size_t r = 1; r < scan::refusal_names.size(); ++r)
    all += ", " + std::to_string(r) + " " + std::string(scan::refusal_names[r]);
  return all;
}

}  // namespace gonio::tools::structured_light
