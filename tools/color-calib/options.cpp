// See options.h.
#include "tools/color-calib/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "colour/chart_specimen.h"
#include "colour/metamerism.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/image.h"
#include "optics/spectrum.h"

namespace gonio::tools::color_calib {
namespace {

using cli::Type;
using colour::Take;

const char* const classic = "colorchecker-24";
const std::vector<std::string> takes{"auto", "keep", "remove"};

std::vector<std::string> models() {
  std::vector<std::string> names = colour::model_names();
  names.insert(names.begin(), "auto");
  return names;
}

Take take_of(const cli::Invocation& call, const char* option) {
  const std::string& word = call.text(option);
  return word == "auto" ? Take::automatic : word == "keep" ? Take::never : Take::always;
}

// "x,y x,y x,y x,y"; a semicolon or spaces between corners.
std::array<Vec2, 4> corners(const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    if (*at == ' ' || *at == ',' || *at == ';') {
      ++at;
      continue;
    }
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value))
      throw Error(Exit::usage, "--corners", "holds what is no number: " + std::string(at, end),
                  "say x,y x,y x,y x,y in pixels");
    numbers.push_back(value), at = next;
  }
  if (numbers.size() != 8)
    throw Error(Exit::usage, "--corners", format("are %zu numbers, needs 8", numbers.size()),
                "say x,y x,y x,y x,y in pixels");
  return {Vec2{numbers[0], numbers[1]}, {numbers[2], numbers[3]}, {numbers[4], numbers[5]}, {numbers[6], numbers[7]}};
}

std::function<double(double)> light_of(cli::Invocation& call) {
  const std::string& name = call.text("light");
  if (!name.ends_with(".csv")) return optics::illuminant(name, "--light");
  call.note_input(name);
  const optics::Spectrum spectrum = optics::read_spectrum(name);
  if (!spectrum.covers(400e-9) || !spectrum.covers(700e-9))
    throw Error(Exit::data, name, format("covers %g to %g nm", 1e9 * spectrum.first_m(), 1e9 * spectrum.last_m()),
                "400 to 700 nm are needed");
  return [spectrum](double w) { return spectrum.at(std::clamp(w, spectrum.first_m(), spectrum.last_m())); };
}

colour::Chart chart_of(cli::Invocation& call) {
  const std::string& name = call.text("chart");
  if (name == classic) {
    if (call.text("light") != "D50" && !call.given("sensor"))
      throw Error(Exit::usage, "--light",
                  "is for charts whose file has reflectances, and " + name + " has L*a*b* of D50",
                  "leave it out, or name a chart's file");
    return colour::colorchecker_classic(call.text("edition"), "--edition");
  }
  if (!name.ends_with(".json"))
    throw Error(Exit::usage, "--chart", "is no chart that is known: " + name,
                std::string("say ") + classic + ", or name a file (.json)");
  if (call.given("edition"))
    throw Error(Exit::usage, "--edition", "is for " + std::string(classic) + ", and --chart names a file",
                "leave it out");
  call.note_input(name);
  return colour::read_chart(name, light_of(call), call.text("light"));
}

colour::ChartPhotograph photograph_of(cli::Invocation& call) {
  if (!call.given("PHOTOGRAPH")) {
    auto photograph = colour::photograph_of_image(call.document, call.given("image") ? call.text("image") : "");
    if (call.given("response")) photograph.response = call.text("response");
    if (call.given("saturation")) photograph.saturation = call.number("saturation");
    return photograph;
  }
  const std::string& file = call.texts("PHOTOGRAPH").front();
  colour::ChartPhotograph photograph{file, {}, {}, {}, file, {}, {}};
  if (call.given("response")) photograph.response = call.text("response");
  if (call.given("saturation")) photograph.saturation = call.number("saturation");
  if (call.given("mask")) photograph.mask = call.text("mask");
  return photograph;
}

std::vector<cli::Option> chart_options() {
  return {{.name = "chart",
           .type = Type::text,
           .help = "The chart: colorchecker-24, or the file (.json) of another one.",
           .metavar = "NAME|FILE",
           .preset = classic},
          {.name = "edition",
           .type = Type::choice,
           .help = "Of colorchecker-24's reference values: charts made since November 2014, or before.",
           .preset = "after-2014",
           .choices = colour::colorchecker_editions()},
          {.name = "light",
           .type = Type::text,
           .help = "Light of the photograph, for charts whose file has reflectances and for --sensor: A, E, D50, D55, "
                   "D65, D75, or a spectrum (.csv).",
           .metavar = "NAME|FILE",
           .preset = "D50"},
          {.name = "sensor",
           .type = Type::input_file,
           .help = "Sensitivities of the camera, a table (.csv) of wavelength in nm, R, G, B: says what no correction "
                   "can mend under --light."},
          {.name = "corners",
           .type = Type::text,
           .help = "Where the chart lies instead of searching for it: \"x,y x,y x,y x,y\", px, of the outer corners of "
                   "its corner patches, from the first patch clockwise as the chart is read.",
           .metavar = "POINTS"},
          {.name = "image",
           .type = Type::text,
           .help = "Id of the manifest's image that shows the chart; needed where several have a file.",
           .metavar = "ID"},
          {.name = "response",
           .type = Type::choice,
           .help = "How the codes of an 8 or 16-bit photograph become linear.",
           .choices = {"linear", "srgb"}},
          {.name = "saturation",
           .type = Type::number,
           .help = "Stored values from here on are clipped. Default: the highest code, and none in OpenEXR.",
           .lower = 0},
          {.name = "mask",
           .type = Type::input_file,
           .help = "Picture that is white where the photograph's pixels can be trusted."}};
}

std::vector<cli::Option> model_options() {
  return {
      {.name = "model",
       .type = Type::choice,
       .help = "Terms of the correction; auto: of those that keep exposure, the simplest that predicts patches that it "
               "was not fitted to as well as the best does.",
       .preset = "auto",
       .choices = models()},
      {.name = "to",
       .type = Type::choice,
       .help = "Colours that come out.",
       .preset = "cie-rgb",
       .choices = colour::target_names()},
      {.name = "least-squares", .type = Type::flag, .help = "Stop after least squares: no BFGS on the mean CIEDE2000."},
      {.name = "offset",
       .type = Type::choice,
       .help = "Glare, or black that was left, on the chart: take it off where the greys show it, never, or always.",
       .preset = "auto",
       .choices = takes},
      {.name = "gradient",
       .type = Type::choice,
       .help = "Light that changes across the chart: divide it out where the patches show it, never, or always.",
       .preset = "auto",
       .choices = takes},
      {.name = "name",
       .type = Type::text,
       .help = "Of the correction in the manifest. Default: the camera's, else camera.",
       .metavar = "NAME"},
      {.name = "preview",
       .type = Type::output_file,
       .help = "PNG to draw: before and after, patches as halves, read and reference."},
      {.name = "specimen",
       .type = Type::flag,
       .help = "Write a simulated photograph of the chart to try the program on, chart.exr below --out.",
       .conflicts = {"corners", "image", "response", "saturation", "mask", "preview", "accept"}},
      {.name = "accept",
       .type = Type::number,
       .help = "Largest mean held-out CIEDE2000; above it the exit status is 2.",
       .lower = 0}};
}

}  // namespace

std::vector<cli::Option> options() {
  std::vector<cli::Option> all = chart_options(), more = model_options();
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

void write_specimen(cli::Invocation& call) {
  const colour::Chart chart = chart_of(call);
  const auto path = call.output_path("chart.exr");
  io::write_picture(
      path, photograph_of(chart, example_specimen(chart, call.seed), colour::example_width, colour::example_height));
  manifest::enter_image(call.document, {.id = "chart"});
  call.document.images.back().file = manifest::add_file(call.document, path, "chart");
}

colour::ChartRequest request_of(cli::Invocation& call) {
  colour::ChartRequest request;
  request.chart = chart_of(call);
  if (call.given("corners")) request.corners = corners(call.text("corners"));
  if (call.text("model") != "auto") request.calibration.model = colour::model_named(call.text("model"), "--model");
  request.calibration.target = colour::target_named(call.text("to"), "--to");
  request.calibration.refine = !call.flag("least-squares");
  request.calibration.offset = take_of(call, "offset"), request.calibration.gradient = take_of(call, "gradient");
  request.photograph = photograph_of(call);
  request.name = call.given("name")                  ? call.text("name")
                 : request.photograph.camera.empty() ? "camera"
                                                     : request.photograph.camera;
  if (call.given("sensor")) {
    call.note_input(call.text("sensor"));
    const colour::Sensitivities sensor = colour::read_sensitivities(call.text("sensor"));
    request.metamerism_de00 = colour::metamerism_de00(sensor, light_of(call), call.text("sensor"));
    request.sensed = colour::sensed(request.chart, sensor, light_of(call), call.text("sensor"));
  }
  if (call.given("preview")) request.preview = call.text("preview");
  return request;
}

}  // namespace gonio::tools::color_calib
