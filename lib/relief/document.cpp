// See document.h.
#include "relief/document.h"

#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/ground_noise.h"
#include "manifest/sections/relief.h"

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

}  // namespace

void remember(manifest::ReliefMap& relief, const io::HeightMap& map, const io::HeightPicture& picture) {
  relief.width = static_cast<std::int64_t>(map.width), relief.height = static_cast<std::int64_t>(map.height);
  relief.step_m = {map.step_x_m, map.step_y_m};
  if (picture.unit_m > 0) relief.unit_m = picture.unit_m;
  relief.channel = picture.channel;
}

io::HeightPicture picture_of(const manifest::ReliefMap& relief) {
  io::HeightPicture picture;
  if (relief.step_m.size() == 2) picture.step_x_m = relief.step_m[0], picture.step_y_m = relief.step_m[1];
  picture.unit_m = relief.unit_m.value_or(0);
  picture.channel = relief.channel;
  return picture;
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
