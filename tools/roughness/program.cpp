// roughness: areal parameters and the distribution of normals of height maps (lib/relief/areal.h, normals.h).
#include "base/atomic_file.h"
#include "base/text.h"
#include "cli/common_options.h"
#include "cli/height_maps.h"
#include "manifest/sections/relief.h"
#include "relief/document.h"
#include "tools/roughness/page.h"

namespace gonio::tools::roughness {
namespace {

using namespace gonio::relief;
using cli::Type;

std::string csv_of(const std::vector<Measured>& all) {
  std::string csv = "file,parameter,unit,value,sigma\n";
  for (const Measured& m : all) {
    std::string name = "\"";
    for (const char c : m.name) name += c == '"' ? "\"\"" : std::string(1, c);
    name += "\"";
    const auto line = [&](const std::string& parameter, const std::string& unit, double value, std::string sigma) {
      csv += name + "," + parameter + "," + unit + "," + shortest_text(value) + "," + sigma + "\n";
    };
    for (const Figure& f : m.roughness.figures) line(f.name, f.unit, f.value, f.sigma ? shortest_text(*f.sigma) : "");
    for (const SlopeFit& f : m.normals.fits) {
      line(f.distribution + "_alpha_u", "1", f.alpha_u, shortest_text(f.sigma_alpha_u));
      line(f.distribution + "_alpha_v", "1", f.alpha_v, shortest_text(f.sigma_alpha_v));
      line(f.distribution + "_azimuth", "rad", f.azimuth_rad, shortest_text(f.sigma_azimuth_rad));
    }
  }
  return csv;
}

void check(cli::Invocation& call) {
  cli::check_maps(call);
  for (const char* option : {"csv", "html"})
    if (call.given(option)) check_writable(call.text(option));
}

// Named by the user, else below --out, else nowhere.
std::filesystem::path place_of(const cli::Invocation& call, const char* option, const char* name) {
  if (call.given(option)) return call.text(option);
  return call.out.empty() ? std::filesystem::path() : call.output_path(name);
}

Exit run(cli::Invocation& call) {
  const std::filesystem::path csv = place_of(call, "csv", "roughness.csv"),
                              page = place_of(call, "html", "report.html");
  const Treatment treatment = cli::treatment_asked(call);
  std::vector<Measured> all;
  for (const cli::AskedMap& asked : cli::maps_asked(call)) {
    const cli::NamedMap read = cli::read_map(call, asked);
    all.push_back(measured(read.map, treatment, read.file));
    enter_roughness(call.document.reliefs.at(read.name), all.back());
  }
  if (!csv.empty()) write_file(csv, csv_of(all));
  if (!page.empty()) write_file(page, roughness_page(all));
  return Exit::done;
}

std::vector<cli::Option> options() {
  std::vector<cli::Option> all = cli::map_options();
  all.push_back(cli::relief_option());
  all.push_back({.name = "csv", .type = Type::output_file, .help = "Write the figures as a table."});
  all.push_back(cli::report_option());
  return all;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "roughness",
      .sentence = "areal roughness and the distribution of normals of height maps",
      .synopsis = {"[OPTION]... MAP...", "[OPTION]... [-i FILE | manifest.json]"},
      .options = options(),
      .operands = {cli::map_operand()},
      .takes_out = true,
      .sections_read = {"files", "reliefs"},
      .sections_written = {"files", "reliefs"},
      .files = {{"report.html", "the report page"}, {"roughness.csv", "the figures as a table"}},
      .references = {"ISO 25178-2, Surface texture: areal: terms, definitions and parameters, 2021.",
                     "ISO 16610-61, Filtration: linear areal filters: Gaussian filters, 2015.",
                     "Flyvbjerg & Petersen, Error estimates on averages of correlated data, J. Chem. Phys. 91, 1989.",
                     "Walter, Marschner, Li & Torrance, Microfacet models for refraction, EGSR 2007."},
      .see_also = {"lobe(1)", "relief(1)", "explain(1)", "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::roughness
