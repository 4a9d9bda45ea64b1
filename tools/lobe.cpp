// lobe: the BRDF of a height map, by tracing paths over a patch of it (lib/relief/lobe.h).
#include <iostream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "cli/program.h"
#include "io/picture.h"
#include "manifest/value.h"
#include "relief/lobe_report.h"
#include "relief/map_options.h"
#include "relief/roughness_page.h"
#include "report/number_text.h"
#include "report/page.h"

namespace gonio::tools::lobe {
namespace {

using namespace gonio::relief;
using cli::Type;
using manifest::Value;

constexpr double degree = pi / 180;

// "eta=1.5", "f0=0.9,0.8,0.6"
manifest::Parameters parameters_of(const std::vector<std::string>& texts) {
  manifest::Parameters all;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw Error(Exit::usage, "--set", "\"" + text + "\" is no NAME=VALUE", "write --set alpha=0.1");
    std::vector<double> values;
    for (std::size_t at = equals + 1; at <= text.size();) {
      const std::size_t comma = std::min(text.find(',', at), text.size());
      values.push_back(parse_quantity(text.substr(at, comma - at), Dimension::none, "--set"));
      at = comma + 1;
    }
    all[text.substr(0, equals)] = manifest::Parameter(values);
  }
  return all;
}

Material material_asked(const cli::Invocation& call) {
  manifest::Parameters parameters = parameters_of(call.texts("set"));
  if (call.text("facets") == "conductor") {  // a smooth dielectric where nothing is said
    parameters.try_emplace("eta", 1.5);
    parameters.try_emplace("k", 0.0);
    parameters.try_emplace("alpha", 0.0);
  }
  return material_of(call.text("facets"), parameters, "--facets");
}

Exit run(cli::Invocation& call) {
  const std::string file = call.texts("MAP").front();
  call.note_input(file);
  const Material material = material_asked(call);
  const Treated surface = treated(io::read_height_map(file, picture_asked(call)), treatment_asked(call), file);
  const Relief relief =
      relief_of(surface.map, call.text("tiling") == "mirrored" ? Tiling::mirrored : Tiling::repeated, file);
  const LobeCells cells{static_cast<int>(call.integer("theta-cells")), static_cast<int>(call.integer("phi-cells")),
                        static_cast<int>(call.integer("picture"))};
  std::vector<double> incidences;
  for (const std::string& text : call.texts("incidence"))
    incidences.push_back(parse_quantity(text, Dimension::angle, "--incidence"));
  if (incidences.empty()) incidences.push_back(45 * degree);
  for (const double incidence : incidences)
    if (!(incidence >= 0 && incidence < 89.5 * degree))
      throw Error(Exit::usage, "--incidence", report::number_text(incidence / degree, 4) + " degrees is too large",
                  "below 89.5 degrees from the normal");
  const double azimuth = call.number("azimuth");
  report::Page page("Lobe", "The lobe of " + file,
                    "Paths over a patch with facets of \"" + call.text("facets") + "\".");
  std::vector<report::Figure> figures;
  Value list = Value::array();
  for (const double incidence : incidences) {
    const LobeTable lobe = lobe_table(relief, material, direction_of(incidence, azimuth), cells,
                                      {.paths = call.integer("paths"), .seed = call.seed});
    list.push_back(lobe_value(incidence, azimuth, lobe));
    const io::Image picture = picture_of(lobe, call.number("decades"));
    const std::string name = "lobe-" + file_stem(format("%g", incidence / degree));
    if (!call.out.empty()) {
      write_file(call.output_path(name + ".csv"), lobe_csv(lobe));
      io::write_picture(call.output_path(name + ".png"), picture);
    }
    figures.push_back({.png = io::encode_png(picture),
                       .title = format("%g degrees", incidence / degree),
                       .caption = energy_sentence(lobe)});
  }
  if (call.given("html")) {
    page.section("Lobes");
    page.paragraph("The hemisphere from above: x to the right, y up; f in false colours over " +
                   report::number_text(call.number("decades"), 3) + " decades (0: linear) below its largest value.");
    page.figures(figures);
    write_file(call.text("html"), page.html());
  }
  std::cout << manifest::print_json(Value::object({{"file", file}, {"lobes", list}})) << "\n" << std::flush;
  return Exit::done;
}

std::vector<cli::Option> options() {
  std::vector<cli::Option> all{
      {.name = "incidence",
       .type = Type::text,
       .help = "Angle from the normal; may be repeated. Default: 45deg.",
       .metavar = "ANGLE",
       .repeat = true},
      {.name = "azimuth",
       .type = Type::quantity,
       .help = "Direction that the light comes from, counter-clockwise from the rows' direction.",
       .preset = "0deg",
       .dimension = Dimension::angle},
      {.name = "facets",
       .type = Type::text,
       .help = "Surface model of the facets, of gonio-surfaces(7). Without parameters conductor is a smooth dielectric "
               "of index 1.5.",
       .metavar = "MODEL",
       .preset = "conductor"},
      {.name = "set",
       .type = Type::text,
       .help = "Parameter of the facets' model: eta=1.49, f0=1; alpha is their roughness below the map's resolution.",
       .metavar = "NAME=VALUE",
       .repeat = true},
      {.name = "tiling",
       .type = Type::choice,
       .help = "How the patch goes on: by its mirror images, or by itself, which makes steps of its edges.",
       .preset = "mirrored",
       .choices = {"mirrored", "repeated"}},
      {.name = "paths",
       .type = Type::integer,
       .help = "Paths per incidence.",
       .preset = "1000000",
       .lower = 64,
       .upper = 1e12},
      {.name = "theta-cells",
       .type = Type::integer,
       .help = "Cells of the table from the normal to the horizon.",
       .preset = "45",
       .lower = 2,
       .upper = 1000},
      {.name = "phi-cells",
       .type = Type::integer,
       .help = "Cells of the table around.",
       .preset = "72",
       .lower = 4,
       .upper = 4000},
      {.name = "picture",
       .type = Type::integer,
       .help = "Side of the picture, pixels.",
       .preset = "128",
       .lower = 8,
       .upper = 2048},
      {.name = "decades",
       .type = Type::number,
       .help = "Decades of f that the colours span; 0: linear.",
       .preset = "3",
       .lower = 0,
       .upper = 12},
      {.name = "html", .type = Type::output_file, .help = "Write the report: one page that needs no network."}};
  for (cli::Option& option : map_options()) all.push_back(std::move(option));
  return all;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "lobe",
      .sentence = "the lobe of reflected light of a height map, by path tracing a patch of it",
      .synopsis = {"[OPTION]... MAP"},
      .options = options(),
      .operands = {{.name = "MAP",
                    .type = Type::input_file,
                    .help = "Height map: .sur, .opd, .nms, .x3p, OpenEXR or TIFF.",
                    .repeat = true,
                    .required = true}},
      .reads = cli::Reads::none,
      .writes_manifest = false,
      .takes_out = true,
      .takes_seed = true,
      .files = {{"lobe-ANGLE.csv", "f and its sigma by direction, 1/sr"},
                {"lobe-ANGLE.png", "the hemisphere from above in false colours"}},
      .references = {"Westin, Arvo & Torrance, Predicting reflectance functions from complex surfaces, SIGGRAPH 1992.",
                     "Tevs, Ihrke & Seidel, Maximum mipmaps for fast, accurate, and scalable dynamic height field "
                     "rendering, I3D 2008."},
      .see_also = {"roughness(1)", "relief(1)", "gonio-surfaces(7)"},
      .check =
          [](cli::Invocation& call) {
            material_asked(call);
            if (call.texts("MAP").size() != 1)
              throw Error(Exit::usage, "MAP", "is given more than once", "one map a call");
          },
      .run = run};
  return program;
}

}  // namespace gonio::tools::lobe
