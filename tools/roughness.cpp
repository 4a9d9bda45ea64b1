// roughness: areal parameters and the distribution of normals of height maps (lib/relief/areal.h, normals.h).
#include <iostream>

#include "base/atomic_file.h"
#include "base/text.h"
#include "cli/program.h"
#include "manifest/value.h"
#include "relief/map_options.h"
#include "relief/roughness_page.h"

namespace gonio::tools::roughness {
namespace {

using namespace gonio::relief;
using cli::Type;
using manifest::Value;

Value figures_of(const Measured& m) {
  Value v = Value::object();
  for (const Figure& f : m.roughness.figures) {
    Value figure = Value::object({{"value", f.value}, {"unit", f.unit}});
    if (f.sigma) figure["sigma"] = *f.sigma;
    v[f.name] = figure;
  }
  return v;
}

Value normals_value(const Normals& n) {
  Value fits = Value::array();
  for (const SlopeFit& f : n.fits)
    fits.push_back(Value::object({{"distribution", f.distribution},
                                  {"alpha_u", f.alpha_u},
                                  {"alpha_v", f.alpha_v},
                                  {"azimuth_rad", f.azimuth_rad},
                                  {"sigma", std::vector<double>{f.sigma_alpha_u, f.sigma_alpha_v, f.sigma_azimuth_rad}},
                                  {"log_likelihood_per_slope", f.log_likelihood}}));
  return fits;
}

Value value_of(const Measured& m) {
  const Treatment& t = m.treatment;
  return Value::object({{"file", m.name},
                        {"width", static_cast<std::int64_t>(m.surface.map.width)},
                        {"height", static_cast<std::int64_t>(m.surface.map.height)},
                        {"step_m", std::vector<double>{m.surface.map.step_x_m, m.surface.map.step_y_m}},
                        {"missing", static_cast<std::int64_t>(m.surface.missing)},
                        {"levelling", levelling_names()[static_cast<std::size_t>(t.levelling)]},
                        {"tilt", std::vector<double>{m.surface.tilt_x, m.surface.tilt_y}},
                        {"s_filter_m", t.s_filter_m > 0 ? Value(t.s_filter_m) : Value()},
                        {"l_filter_m", t.l_filter_m > 0 ? Value(t.l_filter_m) : Value()},
                        {"independent_areas", m.roughness.independent_areas},
                        {"waves_as_long_as_the_map", m.roughness.long_waves},
                        {"parameters", figures_of(m)},
                        {"normals", normals_value(m.normals)}});
}

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

Exit run(cli::Invocation& call) {
  const Treatment treatment = treatment_asked(call);
  std::vector<Measured> all;
  Value list = Value::array();
  for (const std::string& file : call.texts("MAP")) {
    call.note_input(file);
    all.push_back(measured(io::read_height_map(file, picture_asked(call)), treatment, file));
    list.push_back(value_of(all.back()));
  }
  if (call.given("csv")) write_file(call.text("csv"), csv_of(all));
  if (call.given("html")) write_file(call.text("html"), roughness_page(all));
  std::cout << manifest::print_json(Value::object({{"roughness", list}})) << "\n" << std::flush;
  return Exit::done;
}

std::vector<cli::Option> options() {
  std::vector<cli::Option> all = map_options();
  all.push_back({.name = "csv", .type = Type::output_file, .help = "Write the figures as a table."});
  all.push_back(
      {.name = "html", .type = Type::output_file, .help = "Write the report: one page that needs no network."});
  return all;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "roughness",
      .sentence = "areal roughness and the distribution of normals of height maps",
      .synopsis = {"[OPTION]... MAP..."},
      .options = options(),
      .operands = {{.name = "MAP",
                    .type = Type::input_file,
                    .help = "Height maps: .sur, .opd, .nms, .x3p, OpenEXR or TIFF.",
                    .repeat = true,
                    .required = true}},
      .reads = cli::Reads::none,
      .writes_manifest = false,
      .references = {"ISO 25178-2, Surface texture: areal: terms, definitions and parameters, 2021.",
                     "ISO 16610-61, Filtration: linear areal filters: Gaussian filters, 2015.",
                     "Flyvbjerg & Petersen, Error estimates on averages of correlated data, J. Chem. Phys. 91, 1989.",
                     "Walter, Marschner, Li & Torrance, Microfacet models for refraction, EGSR 2007."},
      .see_also = {"lobe(1)", "relief(1)", "explain(1)"},
      .run = run};
  return program;
}

}  // namespace gonio::tools::roughness
