// See map_options.h.
#include "relief/map_options.h"

#include <algorithm>

namespace gonio::relief {

using cli::Type;

const std::vector<std::string>& levelling_names() {
  static const std::vector<std::string> names{"none", "plane", "quadratic"};
  return names;
}

std::vector<cli::Option> map_options() {
  const auto length = [](const char* name, const char* help) {
    return cli::Option{
        .name = name, .type = Type::quantity, .help = help, .dimension = Dimension::length, .lower = 1e-12, .upper = 1};
  };
  return {{.name = "levelling",
           .type = Type::choice,
           .help = "What is taken off the heights first, fitted by least squares; their mean always is.",
           .preset = "plane",
           .choices = levelling_names()},
          length("s-filter",
                 "Nesting index of the S-filter, which smooths: Gaussian, half of such a wave passes. Default: none."),
          length("l-filter", "Nesting index of the L-filter, which takes longer waves away. Default: none."),
          length("step", "Distance of neighbouring points, where an OpenEXR or TIFF does not say it."),
          length("step-y", "That along columns, where it is another."),
          length("unit", "What a height of 1 means in an OpenEXR (default: 1 m) or TIFF."),
          {.name = "channel",
           .type = Type::text,
           .help = "Channel of an OpenEXR that holds the heights, where it has several and none named Z.",
           .metavar = "NAME"}};
}

io::HeightPicture picture_asked(const cli::Invocation& call) {
  io::HeightPicture picture;
  if (call.given("step")) picture.step_x_m = picture.step_y_m = call.number("step");
  if (call.given("step-y")) picture.step_y_m = call.number("step-y");
  if (call.given("unit")) picture.unit_m = call.number("unit");
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
