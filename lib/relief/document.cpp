// See document.h.
#include "relief/document.h"

#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "manifest/fields.h"
#include "manifest/sections/file.h"
#include "manifest/sections/ground_noise.h"
#include "manifest/sections/relief.h"
#include "relief/map_options.h"

namespace gonio::relief {
namespace {

namespace fs = std::filesystem;

// The relief of a file, or a name of its own: "plate", "plate-2".
std::string name_of(const manifest::Document& document, const std::string& file, const std::string& stem) {
  for (const auto& [name, relief] : document.reliefs)
    if (relief.file == file) return name;
  std::string name = stem;
  for (int n = 2; document.reliefs.contains(name); ++n) name = stem + "-" + std::to_string(n);
  return name;
}

io::HeightPicture picture_for(const cli::Invocation& call, const manifest::ReliefMap& relief) {
  io::HeightPicture picture = picture_of(relief);
  const io::HeightPicture said = picture_asked(call);
  if (said.step_x_m > 0) picture.step_x_m = picture.step_y_m = said.step_x_m;
  if (said.step_y_m > 0) picture.step_y_m = said.step_y_m;
  if (said.unit_m > 0) picture.unit_m = said.unit_m;
  if (!said.channel.empty()) picture.channel = said.channel;
  return picture;
}

void remember(manifest::ReliefMap& relief, const io::HeightMap& map, const io::HeightPicture& picture) {
  relief.width = static_cast<std::int64_t>(map.width), relief.height = static_cast<std::int64_t>(map.height);
  relief.step_m = {map.step_x_m, map.step_y_m};
  if (picture.unit_m > 0) relief.unit_m = picture.unit_m;
  relief.channel = picture.channel;
}

}  // namespace

cli::Option relief_option() {
  return {.name = "relief",
          .type = cli::Type::text,
          .help = "Relief of the manifest to work on; may be repeated. Default: all.",
          .metavar = "NAME",
          .repeat = true};
}

cli::Option map_operand() {
  return {.name = "MAP",
          .type = cli::Type::input_file,
          .help =
              "Height maps: .sur, .opd, .nms, .x3p, .plu, OpenEXR or TIFF; or one manifest that ends in .json. Without "
              "any: the reliefs of the manifest.",
          .repeat = true};
}

std::vector<AskedMap> maps_asked(const cli::Invocation& call) {
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

void check_maps(const cli::Invocation& call) {
  picture_asked(call);
  maps_asked(call);
}

io::HeightPicture picture_of(const manifest::ReliefMap& relief) {
  io::HeightPicture picture;
  if (relief.step_m.size() == 2) picture.step_x_m = relief.step_m[0], picture.step_y_m = relief.step_m[1];
  picture.unit_m = relief.unit_m.value_or(0);
  picture.channel = relief.channel;
  return picture;
}

NamedMap read_map(cli::Invocation& call, const AskedMap& asked) {
  manifest::Document& document = call.document;
  if (!asked.relief.empty()) {
    manifest::ReliefMap& relief = document.reliefs.at(asked.relief);
    const fs::path path = manifest::resolve(document, relief.file, "/reliefs/" + asked.relief + "/file");
    call.note_input(path);
    const io::HeightPicture picture = picture_for(call, relief);
    NamedMap read{asked.relief, document.files.at(relief.file).path, io::read_height_map(path, picture)};
    remember(relief, read.map, picture);
    return read;
  }
  call.note_input(asked.file);
  const io::HeightPicture picture = picture_asked(call);
  NamedMap read{{}, asked.file.string(), io::read_height_map(asked.file, picture)};
  read.name = enter_map(document, asked.file, read.map, picture);
  return read;
}

std::string enter_map(manifest::Document& document, const fs::path& path, const io::HeightMap& map,
                      const io::HeightPicture& picture) {
  const auto before = document.files;
  const std::string stem = file_stem(path.stem().string());
  const std::string id = manifest::add_file(document, path, stem), name = name_of(document, id, stem);
  const auto known = before.find(id);
  manifest::ReliefMap& relief = document.reliefs[name];
  if (known != before.end() && known->second.sha256 != document.files.at(id).sha256) relief = {};
  relief.file = id;
  remember(relief, map, picture);
  return name;
}

Treatment treatment_for(const cli::Invocation& call, const manifest::ReliefMap& relief) {
  Treatment treatment = treatment_asked(call);
  if (!relief.treatment) return treatment;
  const manifest::ReliefTreatment& known = *relief.treatment;
  const auto at = std::ranges::find(levelling_names(), known.levelling) - levelling_names().begin();
  if (!call.given("levelling")) treatment.levelling = static_cast<Levelling>(at);
  if (!call.given("s-filter")) treatment.s_filter_m = known.s_filter_m.value_or(0);
  if (!call.given("l-filter")) treatment.l_filter_m = known.l_filter_m.value_or(0);
  return treatment;
}

manifest::ReliefTreatment treatment_entry(const Treatment& t, const Treated& surface) {
  manifest::ReliefTreatment entry;
  entry.levelling = levelling_names()[static_cast<std::size_t>(t.levelling)];
  if (t.levelling != Levelling::none) entry.tilt = {surface.tilt_x, surface.tilt_y};
  if (t.s_filter_m > 0) entry.s_filter_m = t.s_filter_m;
  if (t.l_filter_m > 0) entry.l_filter_m = t.l_filter_m;
  return entry;
}

void enter_roughness(manifest::ReliefMap& relief, const Measured& m) {
  relief.missing = static_cast<std::int64_t>(m.surface.missing);
  relief.treatment = treatment_entry(m.treatment, m.surface);
  relief.parameters.clear(), relief.normals.clear();
  for (const Figure& f : m.roughness.figures) relief.parameters[f.name] = {f.value, f.unit, f.sigma};
  relief.independent_areas = m.roughness.independent_areas, relief.long_waves = m.roughness.long_waves;
  for (const SlopeFit& f : m.normals.fits) {
    manifest::NormalsFit entry{f.distribution, f.alpha_u, f.alpha_v, f.azimuth_rad, {}, {}};
    entry.sigma = {
        {"alpha_u", {f.sigma_alpha_u}}, {"alpha_v", {f.sigma_alpha_v}}, {"azimuth_rad", {f.sigma_azimuth_rad}}};
    if (std::isfinite(f.log_likelihood)) entry.log_likelihood = f.log_likelihood;
    relief.normals.push_back(std::move(entry));
  }
}

manifest::GroundNoiseFit ground_entry(const GroundNoise& ground, double layer_m) {
  manifest::GroundNoiseFit entry;
  for (const GroundPart& p : ground.parts) {
    manifest::GroundNoisePart part{p.sq_m, p.cell_m, {{"sq_m", {p.sigma_sq_m}}, {"cell_m", {p.sigma_cell_m}}}, {}};
    if (layer_m > 0) part.weight = p.weight(layer_m);
    entry.parts.push_back(std::move(part));
  }
  entry.white_m = ground.white_m, entry.sigma["white_m"] = {ground.sigma_white_m};
  if (layer_m > 0) entry.layer_m = layer_m;
  entry.misfit = ground.misfit, entry.log_rms = ground.log_rms, entry.criterion = ground.criterion;
  entry.tiles = static_cast<std::int64_t>(ground.tiles);
  return entry;
}

}  // namespace gonio::relief
