// See call.h.
#include "tools/lobe/call.h"

#include "base/assignment.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "cli/common_options.h"
#include "cli/height_maps.h"
#include "geom/angle.h"
#include "io/picture.h"
#include "manifest/sections/relief.h"
#include "manifest/sections/surface_fit.h"
#include "manifest/sections/table.h"
#include "relief/document.h"
#include "relief/lobe_report.h"
#include "relief/pictures.h"
#include "report/number_text.h"
#include "report/page.h"

namespace gonio::tools::lobe {

using namespace gonio::relief;

namespace {

using cli::Type;

// "eta=1.5", "f0=0.9,0.8,0.6"; a smooth dielectric where nothing is said
manifest::Parameters parameters_asked(const cli::Invocation& call) {
  manifest::Parameters all;
  for (const std::string& text : call.texts("set")) {
    const auto [name, list] = parse_assignment(text, "--set", "write --set alpha=0.1");
    std::vector<double> values;
    for (const std::string& value : pieces(list, ','))
      values.push_back(parse_quantity(value, Dimension::none, "--set " + name));
    all[name] = manifest::Parameter(values);
  }
  if (call.text("facets") == "conductor") {
    all.try_emplace("eta", 1.5);
    all.try_emplace("k", 0.0);
    all.try_emplace("alpha", 0.0);
  }
  return all;
}

Material material_asked(const cli::Invocation& call) {
  return material_of(call.text("facets"), parameters_asked(call), "--facets");
}

std::vector<double> incidences_asked(const cli::Invocation& call) {
  std::vector<double> all;
  for (const std::string& text : call.texts("incidence"))
    all.push_back(parse_quantity(text, Dimension::angle, "--incidence"));
  if (all.empty()) all.push_back(45 * degree);
  for (const double incidence : all)
    if (!(incidence >= 0 && incidence < 89.5 * degree))
      throw Error(Exit::usage, "--incidence", report::number_text(incidence / degree, 4) + " degrees is too large",
                  "below 89.5 degrees from the normal");
  return all;
}

std::string picture_name(const std::string& relief, double incidence) {
  return relief + "-lobe-" + file_stem(format("%g", incidence / degree)) + ".png";
}

// What the command line says, the same for all maps.
struct Wish {
  std::vector<double> incidences;
  double azimuth = 0;
  manifest::Parameters parameters;
  Material material;
  LobeCells cells;
  Effort effort;
  std::string facets, tiling;
};

Wish wish_of(const cli::Invocation& call) {
  return {.incidences = incidences_asked(call),
          .azimuth = call.number("azimuth"),
          .parameters = parameters_asked(call),
          .material = material_asked(call),
          .cells = {static_cast<int>(call.integer("theta-cells")), static_cast<int>(call.integer("phi-cells")),
                    static_cast<int>(call.integer("picture"))},
          .effort = {.paths = call.integer("paths"), .seed = call.seed},
          .facets = call.text("facets"),
          .tiling = call.text("tiling")};
}

// One map with its lobes.
struct Traced {
  cli::NamedMap read;
  Treatment treatment;
  Treated surface;
  std::vector<TracedLobe> lobes;
  std::filesystem::path table;  // below --out; empty where there is none
  std::vector<std::filesystem::path> pictures;
};

// Where the files will lie; asked for before anything is traced.
void place_files(cli::Invocation& call, const Wish& wish, Traced& all) {
  if (call.out.empty()) return;
  all.table = call.output_path(all.read.name + "-lobe.csv");
  for (const double incidence : wish.incidences)
    all.pictures.push_back(call.output_path(picture_name(all.read.name, incidence)));
}

Traced traced(cli::Invocation& call, const cli::AskedMap& asked, const Wish& wish) {
  cli::NamedMap read = cli::read_map(call, asked);
  const Treatment treatment = cli::treatment_for(call, call.document.reliefs.at(read.name));
  Traced all{read, treatment, treated(read.map, treatment, read.file), {}, {}, {}};
  place_files(call, wish, all);
  const Relief relief =
      relief_of(all.surface.map, wish.tiling == "mirrored" ? Tiling::mirrored : Tiling::repeated, read.file);
  for (const double incidence : wish.incidences) {
    const Vec3 light = direction_of(incidence, wish.azimuth);
    all.lobes.push_back({light, lobe_table(relief, wish.material, light, wish.cells, wish.effort)});
  }
  return all;
}

void enter_lobes(cli::Invocation& call, const Traced& all, const Wish& wish) {
  manifest::ReliefMap& relief = call.document.reliefs.at(all.read.name);
  relief.lobes.clear();
  for (std::size_t i = 0; i < all.lobes.size(); ++i) {
    manifest::ReliefLobe entry = lobe_entry(wish.incidences[i], wish.azimuth, all.lobes[i].lobe);
    entry.treatment = treatment_entry(all.treatment, all.surface), entry.tiling = wish.tiling;
    entry.facets = wish.facets, entry.parameters = wish.parameters, entry.paths = wish.effort.paths;
    if (!all.pictures.empty()) {
      io::write_picture(all.pictures[i], picture_of(all.lobes[i].lobe, call.number("decades")));
      entry.picture = manifest::add_file(call.document, all.pictures[i], all.pictures[i].stem().string());
    }
    relief.lobes.push_back(std::move(entry));
  }
}

// The lobes as a section of "tables", where there is a folder for the file: brdf-fit and explain read it.
void enter_table(cli::Invocation& call, const Traced& all) {
  manifest::ReliefMap& relief = call.document.reliefs.at(all.read.name);
  relief.table.clear();
  if (all.table.empty()) return;
  const std::string name = all.read.name + "-lobe";
  write_file(all.table, lobe_csv(all.lobes));
  manifest::Table table = lobe_columns();
  table.file = manifest::add_file(call.document, all.table, name), table.surface = relief.surface;
  call.document.tables[name] = std::move(table);
  relief.table = name;
}

// The surface that stands for the relief, under the relief's name unless another surface bears that.
void enter_surface(cli::Invocation& call, const Traced& all, const Wish& wish) {
  manifest::Document& document = call.document;
  manifest::ReliefMap& relief = call.document.reliefs.at(all.read.name);
  const RoughSurface rough = surface_of(wish.facets, wish.parameters, normals_of(all.surface.map));
  if (!rough.surface) {
    log(LogLevel::info, all.read.file + ": no surface stands for it: " + rough.reason);
    return;
  }
  if (relief.surface.empty()) {
    relief.surface = all.read.name;
    for (int n = 2; document.surfaces.contains(relief.surface); ++n)
      relief.surface = all.read.name + "-" + std::to_string(n);
  }
  document.surfaces[relief.surface] = *rough.surface;
  document.surface_fits[relief.surface] = surface_entry(rough, all.lobes, "reliefs/" + all.read.name);
  log(LogLevel::info, document.surface_fits[relief.surface].sentence);
}

void write_page(const cli::Invocation& call, const std::vector<Traced>& all, const Wish& wish) {
  report::Page page("Lobe", all.size() == 1 ? "The lobe of " + all[0].read.file : "The lobes of several maps",
                    "Paths over a patch with facets of \"" + wish.facets + "\".");
  for (const Traced& one : all) {
    page.section(one.read.file);
    page.paragraph("The hemisphere from above: x to the right, y up; f in false colours over " +
                   report::number_text(call.number("decades"), 3) + " decades (0: linear) below its largest value.");
    std::vector<report::Figure> figures;
    for (std::size_t i = 0; i < one.lobes.size(); ++i)
      figures.push_back({.png = io::encode_png(picture_of(one.lobes[i].lobe, call.number("decades"))),
                         .title = format("%g degrees", wish.incidences[i] / degree),
                         .caption = energy_sentence(one.lobes[i].lobe)});
    page.figures(figures);
    if (const std::string& name = call.document.reliefs.at(one.read.name).surface; !name.empty())
      page.paragraph(call.document.surface_fits.at(name).sentence);
  }
  write_file(call.text("html"), page.html());
}

}  // namespace

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
      cli::report_option(),
      cli::relief_option()};
  for (cli::Option& option : cli::map_options()) all.push_back(std::move(option));
  return all;
}

void check(cli::Invocation& call) {
  material_asked(call);
  incidences_asked(call);
  cli::check_maps(call);
  if (call.given("html")) check_writable(call.text("html"));
}

Exit run(cli::Invocation& call) {
  const Wish wish = wish_of(call);
  std::vector<Traced> all;
  for (const cli::AskedMap& asked : cli::maps_asked(call)) {
    all.push_back(traced(call, asked, wish));
    enter_lobes(call, all.back(), wish);
    enter_surface(call, all.back(), wish);
    enter_table(call, all.back());
  }
  if (call.given("html")) write_page(call, all, wish);
  return Exit::done;
}

}  // namespace gonio::tools::lobe
