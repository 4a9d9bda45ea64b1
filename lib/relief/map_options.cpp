// See map_options.h.
#include "relief/map_options.h"

#include <algorithm>
#include <cctype>

#include "base/error.h"
#include "base/quantity.h"

namespace gonio::relief {

using cli::Type;

const std::vector<std::string>& levelling_names() {
  static const std::vector<std::string> names{"none", "plane", "quadratic"};
  return names;
}

namespace {

constexpr double shortest_m = 1e-12, longest_m = 1;

cli::Option map_length(const char* name, const char* help) {
  return {.name = name,
          .type = Type::quantity,
          .help = help,
          .dimension = Dimension::length,
          .lower = shortest_m,
          .upper = longest_m};
}

// "um" is what people say for 1um.
double unit_of_heights(const std::string& text) {
  const bool bare = !text.empty() && std::isalpha(static_cast<unsigned char>(text[0]));
  const double metres = parse_quantity((bare ? "1" : "") + text, Dimension::length, "--unit");
  if (!(metres >= shortest_m && metres <= longest_m))
    throw Error(Exit::usage, "--unit", "'" + text + "' is outside 1e-12 to 1 m", "say what a height of 1 means: um");
  return metres;
}

}  // namespace

std::vector<cli::Option> picture_options() {
  return {map_length("step", "Distance of neighbouring points, where an OpenEXR or TIFF does not say it."),
          map_length("step-y", "That along columns, where it is another."),
          {.name = "unit",
           .type = Type::text,
           .help = "What a height of 1 means in an OpenEXR (default: 1 m) or TIFF: um, 25nm.",
           .metavar = "LENGTH"},
          {.name = "channel",
           .type = Type::text,
           .help = "Channel of an OpenEXR that holds the heights, where it has several and none named Z.",
           .metavar = "NAME"}};
}

std::vector<cli::Option> map_options() {
  std::vector<cli::Option> all = {
      {.name = "levelling",
       .type = Type::choice,
       .help = "What is taken off the heights first, fitted by least squares; their mean always is.",
       .preset = "plane",
       .choices = levelling_names()},
      map_length("s-filter",
                 "Nesting index of the S-filter, which smooths: Gaussian, half of such a wave passes. Default: none."),
      map_length("l-filter", "Nesting index of the L-filter, which takes longer waves away. Default: none.")};
  for (cli::Option& option : picture_options()) all.push_back(std::move(option));
  return all;
}

io::HeightPicture picture_asked(const cli::Invocation& call) {
  io::HeightPicture picture;
  if (call.given("step")) picture.step_x_m = picture.step_y_m = call.number("step");
  if (call.given("step-y")) picture.step_y_m = call.number("step-y");
  if (call.given("unit")) picture.unit_m = unit_of_heights(call.text("unit"));
  if (call.given("channel")) picture.channel = call.text("channel");
  return picture;
}

Treatment treatment_asked(const cli::Invocation& call) {
  Treatment treatment;
  treatment.levelling =
      static_cast<Levelling>(std::ranges::find(levelling_names(), call.text("levelling")) - levelling_names().begin());
  if (call.given("s-filter")) treatment.s_filter_m = call.number("s-filter");
  if (call.given("l-filter")) treatment.l_filter_m = call.number("l-filter");
  return treatment;
}

}  // namespace gonio::relief
