// See heights_problem.h: from the manifest to maps.
#include <algorithm>

#include "base/error.h"
#include "explain/heights/heights_problem.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/relief.h"
#include "manifest/sections/table.h"
#include "mechanism/mechanism.h"
#include "relief/document.h"

namespace gonio::mechanism {
const Mechanism& surface_anisotropy();
const Mechanism& surface_micro_ridges();
}  // namespace gonio::mechanism

namespace gonio::explain {
namespace {

bool is_heights(const manifest::Table& table) {
  return table.model == "heights";
}

const manifest::MechanismUse* use_of(const manifest::Document& document, const std::string& id,
                                     const std::string& surface) {
  const auto found = document.mechanisms.find(id);
  if (found == document.mechanisms.end()) return nullptr;
  const std::vector<std::string>& on = found->second.on;
  return on.empty() || std::find(on.begin(), on.end(), surface) != on.end() ? &found->second : nullptr;
}

// "reliefs" says what the numbers of a picture mean.
io::HeightPicture picture_of_file(const manifest::Document& document, const std::string& file) {
  for (const auto& [name, relief] : document.reliefs)
    if (relief.file == file) return relief::picture_of(relief);
  return {};
}

}  // namespace

bool has_heights(const manifest::Document& document) {
  return std::any_of(document.tables.begin(), document.tables.end(),
                     [](const auto& t) { return is_heights(t.second); });
}

std::vector<HeightsInput> heights_inputs(const manifest::Document& document) {
  std::vector<HeightsInput> inputs;
  for (const auto& [name, table] : document.tables) {
    if (!is_heights(table)) continue;
    HeightsInput input;
    input.table = name, input.surface = table.surface;
    input.place = manifest::place(document, "/tables/" + name);
    if (table.file.empty())
      throw Error(Exit::data, input.place, "names no file",
                  "give the height map: \"file\": id of a .sur, .opd, .nms, .x3p, .plu, OpenEXR or TIFF");
    input.map = io::read_height_map(manifest::resolve(document, table.file, "/tables/" + name + "/file"),
                                    picture_of_file(document, table.file));
    if (const manifest::MechanismUse* use = use_of(document, mechanism::surface_micro_ridges().id, table.surface))
      input.ridges = use->parameters, input.has_ridges = use->parameters.contains("ridge_period_m");
    if (const manifest::MechanismUse* use = use_of(document, mechanism::surface_anisotropy().id, table.surface))
      input.lay = use->parameters, input.has_lay = true;
    inputs.push_back(std::move(input));
  }
  return inputs;
}

}  // namespace gonio::explain
