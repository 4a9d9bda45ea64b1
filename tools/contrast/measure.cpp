// The command line of `contrast measure` (run_measure.h), its tables, and what it enters into the manifest.
#include "tools/contrast/measure.h"

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "contrast/measure/measure_maps.h"
#include "contrast/measure/measure_tables.h"
#include "io/picture.h"
#include "tools/contrast/measure_page.h"

namespace gonio::tools::contrast {

using namespace gonio::contrast;

namespace {

using cli::Type;

MeasureOptions options_of(cli::Invocation& call) {
  MeasureOptions options;
  options.inner = call.number("inner");
  options.corner_sigma_px = call.number("corner-sigma");
  options.robot_sigma_m = call.number("robot-position");
  options.robot_sigma_rad = call.number("robot-angle");
  if (call.given("full-scale")) options.full_scale = call.number("full-scale");
  options.alarm_rate = call.number("alarm-rate");
  options.refine = !call.flag("no-refine");
  options.seed = call.seed;
  options.note_input = [&call](const std::filesystem::path& path) { call.note_input(path); };
  return options;
}

void write_outputs(cli::Invocation& call, const Measured& m) {
  const std::vector<std::pair<std::string, std::string>> tables{
      {"views.csv", views_csv(m)}, {"cells.csv", cells_csv(m)}, {"series.csv", series_csv(m)}};
  std::vector<std::pair<std::string, io::Image>> maps{{"pattern.png", pattern_map(m)},
                                                      {"distance.png", distance_map(m)}};
  if (!m.turns.empty()) maps.emplace_back("turn.png", turn_map(m));
  std::vector<std::filesystem::path> paths;  // asked for before the first is written
  for (const auto& [name, content] : tables) paths.push_back(call.output_path(name));
  for (const auto& [name, picture] : maps) paths.push_back(call.output_path(name));
  for (std::size_t i = 0; i < tables.size(); ++i) write_file(paths[i], tables[i].second);
  for (std::size_t i = 0; i < maps.size(); ++i) io::write_picture(paths[tables.size() + i], maps[i].second);
  for (const auto& path : paths) manifest::add_file(call.document, path, "measured-" + path.stem().string());
}

}  // namespace

std::vector<cli::Option> measure_options() {
  return {
      {.name = "pattern",
       .type = Type::text,
       .help = "measure: pattern of the manifest, where it has several.",
       .metavar = "NAME"},
      {.name = "corners",
       .type = Type::input_file,
       .help = "measure: corners marked in a few images; CSV with the columns image, corner, u_px, v_px, and sigma_px "
               "if known."},
      {.name = "inner",
       .type = Type::quantity,
       .help = "measure: largest share of a cell's width and height that counts.",
       .preset = "60%",
       .dimension = Dimension::ratio,
       .lower = 0.05,
       .upper = 1},
      {.name = "corner-sigma",
       .type = Type::quantity,
       .help = "measure: standard deviation of a marked corner that states none.",
       .preset = "0.5px",
       .dimension = Dimension::pixel,
       .lower = 1e-6},
      {.name = "robot-position",
       .type = Type::quantity,
       .help = "measure: repeatability of camera poses that state none, one standard deviation of a coordinate.",
       .preset = "0.1mm",
       .dimension = Dimension::length,
       .lower = 0},
      {.name = "robot-angle",
       .type = Type::quantity,
       .help = "measure: the same, about one axis.",
       .preset = "0.2mrad",
       .dimension = Dimension::angle,
       .lower = 0},
      {.name = "no-refine",
       .type = Type::flag,
       .help = "measure: take the poses as they are stated; views are not laid onto the pattern."},
      {.name = "full-scale",
       .type = Type::number,
       .help = "measure: linear value from which on a pixel is saturated; by default what sensor.saturation states.",
       .lower = 1e-300},
      {.name = "alarm-rate",
       .type = Type::quantity,
       .help = "measure: how often a sample without defects may show any.",
       .preset = "5%",
       .dimension = Dimension::ratio,
       .lower = 0.001,
       .upper = 0.5}};
}

void check_measure(cli::Invocation& call) {
  if (!call.has_document)
    throw Error(Exit::no_input, "contrast measure", "has no manifest to read",
                "name it: contrast measure session.json --corners corners.csv");
}

Exit run_measure(cli::Invocation& call) {
  const MeasureOptions options = options_of(call);
  std::vector<CornerMark> marks;
  if (call.given("corners")) {
    call.note_input(call.text("corners"));
    marks = read_marks(call.text("corners"), call.document);
  }
  const Measured measured = measure(call.document, call.given("pattern") ? call.text("pattern") : "", marks, options);
  for (const std::string& note : measured.notes) log(LogLevel::warning, note);
  for (const std::string& image : measured.dropped) log(LogLevel::warning, "left out: " + image);
  if (!call.out.empty()) write_outputs(call, measured);
  if (call.given("html")) write_file(call.text("html"), measure_page(measured, options));
  enter(call.document, measured);
  log(LogLevel::info, measure_headline(measured));
  return measured.defects.found.empty() ? Exit::done : Exit::negative;
}

}  // namespace gonio::tools::contrast
