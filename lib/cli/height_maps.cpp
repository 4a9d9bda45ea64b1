// See height_maps.h.
#include "cli/height_maps.h"

#include <algorithm>
#include <cctype>

#include "base/error.h"
#include "base/quantity.h"
#include "manifest/fields.h"
#include "manifest/sections/file.h"
#include "manifest/sections/relief.h"
#include "relief/document.h"

namespace gonio::cli {
namespace {

namespace fs = std::filesystem;
using relief::levelling_names;

constexpr double shortest_m = 1e-12, longest_m = 1;

Option map_length(const char* name, const char* help) {
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

io::HeightPicture picture_for(const Invocation& call, const manifest::ReliefMap& relief) {
  io::HeightPicture picture = relief::picture_of(relief);
  const io::HeightPicture said = picture_asked(call);
  if (said.step_x_m > 0) picture.step_x_m = picture.step_y_m = said.step_x_m;
  if (said.step_y_m > 0) picture.step_y_m = said.step_y_m;
  if (said.unit_m > 0) picture.unit_m = said.unit_m;
  if (!said.channel.empty()) picture.channel = said.channel;
  return picture;
}

}  // namespace

std::vector<Option> picture_options() {
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

std::vector<Option> map_options() {
  std::vector<Option> all{
      {.name = "levelling",
       .type = Type::choice,
       .help = "What is taken off the heights first, fitted by least squares; their mean always is.",
       .preset = "plane",
       .choices = levelling_names()},
      map_length("s-filter",
                 "Nesting index of the S-filter, which smooths: Gaussian, half of such a wave passes. Default: none."),
      map_length("l-filter", "Nesting index of the L-filter, which takes longer waves away. Default: none.")};
  for (Option& option : picture_options()) all.push_back(std::move(option));
  return all;
}

io::HeightPicture picture_asked(const Invocation& call) {
  io::HeightPicture picture;
  if (call.given("step")) picture.step_x_m = picture.step_y_m = call.number("step");
  if (call.given("step-y")) picture.step_y_m = call.number("step-y");
  if (call.given("unit")) picture.unit_m = unit_of_heights(call.text("unit"));
  if (call.given("channel")) picture.channel = call.text("channel");
  return picture;
}

relief::Treatment treatment_asked(const Invocation& call) {
  relief::Treatment treatment;
  treatment.levelling = static_cast<relief::Levelling>(std::ranges::find(levelling_names(), call.text("levelling")) -
                                                       levelling_names().begin());
  if (call.given("s-filter")) treatment.s_filter_m = call.number("s-filter");
  if (call.given("l-filter")) treatment.l_filter_m = call.number("l-filter");
  return treatment;
}

relief::Treatment treatment_for(const Invocation& call, const manifest::ReliefMap& relief) {
  relief::Treatment treatment = treatment_asked(call);
  if (!relief.treatment) return treatment;
  const manifest::ReliefTreatment& known = *relief.treatment;
  const auto at = std::ranges::find(levelling_names(), known.levelling) - levelling_names().begin();
  if (!call.given("levelling")) treatment.levelling = static_cast<relief::Levelling>(at);
  if (!call.given("s-filter")) treatment.s_filter_m = known.s_filter_m.value_or(0);
  if (!call.given("l-filter")) treatment.l_filter_m = known.l_filter_m.value_or(0);
  return treatment;
}

Option relief_option() {
  return {.name = "relief",
          .type = Type::text,
          .help = "Relief of the manifest to work on; may be repeated. Default: all.",
          .metavar = "NAME",
          .repeat = true};
}

Option map_operand() {
  return {.name = "MAP",
          .type = Type::input_file,
          .help =
              "Height maps: .sur, .opd, .nms, .x3p, .plu, OpenEXR or TIFF; or one manifest that ends in .json. Without "
              "any: the reliefs of the manifest.",
          .repeat = true};
}

std::vector<AskedMap> maps_asked(const Invocation& call) {
  std::vector<AskedMap> all;
  const std::vector<std::string>& names = call.texts("relief");
  for (const std::string& file : call.texts("MAP")) all.push_back({{}, file});
  if (!all.empty() && !names.empty())
    throw Error(Exit::usage, "--relief",
                "names a relief of the manifest, and " + call.texts("MAP").front() + " is a map",
                "leave one of the two out");
  if (!all.empty()) return all;
  if (!call.has_document)
    throw Error(Exit::no_input, "MAP", "is missing, and there is no manifest",
                "name a height map, or pipe in a manifest with reliefs");
  const auto& reliefs = call.document.reliefs;
  std::vector<std::string> known;
  for (const auto& [name, relief] : reliefs) known.push_back(name);
  if (known.empty())
    throw Error(Exit::data, manifest::place(call.document, "/reliefs"), "has no relief", "name a height map: MAP");
  for (const std::string& name : names)
    if (!reliefs.contains(name))
      throw Error(Exit::data, "--relief", "\"" + name + "\" is not in reliefs of " + call.document.name,
                  manifest::remedy_for(name, known));
  for (const std::string& name : names.empty() ? known : names) all.push_back({name, {}});
  return all;
}

void check_maps(const Invocation& call) {
  picture_asked(call);
  maps_asked(call);
}

NamedMap read_map(Invocation& call, const AskedMap& asked) {
  manifest::Document& document = call.document;
  if (!asked.relief.empty()) {
    manifest::ReliefMap& relief = document.reliefs.at(asked.relief);
    const fs::path path = manifest::resolve(document, relief.file, "/reliefs/" + asked.relief + "/file");
    call.note_input(path);
    const io::HeightPicture picture = picture_for(call, relief);
    NamedMap read{asked.relief, document.files.at(relief.file).path, io::read_height_map(path, picture)};
    relief::remember(relief, read.map, picture);
    return read;
  }
  call.note_input(asked.file);
  const io::HeightPicture picture = picture_asked(call);
  NamedMap read{{}, asked.file.string(), io::read_height_map(asked.file, picture)};
  read.name = relief::enter_map(document, asked.file, read.map, picture);
  return read;
}

}  // namespace gonio::cli
