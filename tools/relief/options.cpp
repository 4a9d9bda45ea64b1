// See options.h.
#include "tools/relief/options.h"

#include "base/error.h"
#include "base/quantity.h"
#include "cli/height_maps.h"

namespace gonio::tools::relief {

using namespace gonio::relief;

namespace {

using cli::Type;

cli::Option length(const char* name, const char* help) {
  return {.name = name, .type = Type::quantity, .help = help, .dimension = Dimension::length, .lower = 0, .upper = 1};
}
cli::Option count(const char* name, const char* help, const char* preset, double lower, double upper) {
  return {.name = name, .type = Type::integer, .help = help, .preset = preset, .lower = lower, .upper = upper};
}

}  // namespace

std::vector<cli::Option> options() {
  std::vector<cli::Option> all{
      {.name = "to", .type = Type::output_file, .help = "Height map to write: .sur, .x3p or .exr by its name."},
      {.name = "sq",
       .type = Type::text,
       .help = "noise: root mean square height of a part; once for every part.",
       .metavar = "LENGTH",
       .repeat = true},
      {.name = "cell",
       .type = Type::text,
       .help = "noise: size of its cells, about the distance of its hills; as often as --sq.",
       .metavar = "LENGTH",
       .repeat = true},
      count("points", "noise: points a side.", "512", 2, 8192),
      {.name = "periodic",
       .type = Type::flag,
       .help = "noise: continues over the map's edges; cells become the nearest that divide its side."},
      {.name = "angle",
       .type = Type::quantity,
       .help = "ridges: tilt of the long facets.",
       .dimension = Dimension::angle,
       .lower = 0.001,
       .upper = 0.786},
      length("pitch", "ridges: from crest to crest."),
      length("crest-radius", "ridges: rounding of the crests. Default: sharp."),
      length("trough-radius", "ridges: rounding of the troughs. Default: sharp."),
      {.name = "burr-share",
       .type = Type::quantity,
       .help = "ridges: share of the crests' length that lies under burrs. Default: none.",
       .dimension = Dimension::ratio,
       .lower = 0,
       .upper = 0.99},
      length("burr-height", "ridges: mean height of the burrs."),
      length("burr-width", "ridges: their width across the crest."),
      length("burr-length", "ridges: their length along it. Default: the width."),
      count("ridges", "ridges: how many the map has.", "4", 1, 1000),
      length("length", "ridges: length of the map along them. Default: 32 burrs."),
      count("points-across", "ridges: points from crest to crest; 0: as fine as walls and edges need.", "0", 0, 8192),
      length("amplitude", "sinusoid: half the depth."),
      length("wave-x", "sinusoid: wavelength along the rows; without it there is none."),
      length("wave-y", "sinusoid: wavelength along the columns."),
      count("points-per-wave", "sinusoid: points of a wave.", "128", 4, 8192),
      {.name = "parts",
       .type = Type::integer,
       .help = "ground-noise: number of noises in the sum. Default: 1 to 3, chosen by Schwarz's criterion.",
       .lower = 1,
       .upper = 6},
      length("layer", "ground-noise: thickness of a printed layer, to state weights of the published form."),
      {.name = "name",
       .type = Type::text,
       .help = "ground-noise: its name in ground_noises.",
       .metavar = "NAME",
       .preset = "ground"},
      {.name = "html", .type = Type::output_file, .help = "ground-noise: write the report."},
      cli::relief_option()};
  for (cli::Option& option : cli::picture_options()) all.push_back(std::move(option));
  for (cli::Option& option : all)
    if (option.name == "step")
      option.help = "noise: distance of neighbouring points. ground-noise: that of an OpenEXR or TIFF.";
  return all;
}

std::vector<NoisePart> parts_asked(const cli::Invocation& call) {
  const std::vector<std::string>&sq = call.texts("sq"), &cell = call.texts("cell");
  if (sq.empty() || sq.size() != cell.size())
    throw Error(Exit::usage, "--sq",
                "is given " + std::to_string(sq.size()) + " times and --cell " + std::to_string(cell.size()),
                "give both for every part of the noise");
  std::vector<NoisePart> parts;
  for (std::size_t i = 0; i < sq.size(); ++i)
    parts.push_back(
        {parse_quantity(sq[i], Dimension::length, "--sq"), parse_quantity(cell[i], Dimension::length, "--cell")});
  for (const NoisePart& part : parts)
    if (!(part.sq_m >= 0 && part.cell_m > 0))
      throw Error(Exit::usage, "--cell", "a part has no cell or a negative Sq", "state lengths above 0");
  return parts;
}

}  // namespace gonio::tools::relief
