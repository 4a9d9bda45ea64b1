// See microstructure_use.h.
#include "relief/microstructure_use.h"

#include <memory>
#include <sstream>

#include "base/assignment.h"
#include "base/error.h"
#include "base/quantity.h"
#include "manifest/document.h"
#include "manifest/sections/print.h"

namespace gonio::relief {
namespace {

const Microstructure& known(const std::string& id, const std::string& place, Exit code) {
  if (const Microstructure* structure = find_microstructure(id)) return *structure;
  std::string names;
  for (const Microstructure* structure : all_microstructures())
    names += (names.empty() ? "" : ", ") + structure->info().id;
  throw Error(code, place, "there is no micro-structure \"" + id + "\"", "there are " + names);
}

}  // namespace

manifest::MicrostructureUse parse_microstructure(
    const std::string& text, const std::string& place,
    const std::function<bool(const std::string& name, const std::string& value)>& further) {
  const std::size_t colon = text.find(':');
  manifest::MicrostructureUse use;
  use.model = text.substr(0, colon);
  const manifest::ModelInfo& info = known(use.model, place, Exit::usage).info();
  const std::string rest = colon == std::string::npos ? "" : text.substr(colon + 1);
  if (info.takes_expression) {
    use.expression = rest;
    return use;
  }
  std::istringstream items(rest);
  for (std::string item; std::getline(items, item, ',');) {
    const auto [name, value] = parse_assignment(item, place, "type, say, " + use.model + ":NAME=VALUE");
    if (name == "file" && info.attachment != manifest::Attachment::none) {
      use.file = value;
      continue;
    }
    const manifest::ParameterInfo* found = nullptr;
    std::string names;
    for (const manifest::ParameterInfo& p : info.parameters) {
      if (p.name == name) found = &p;
      names += (names.empty() ? "" : ", ") + p.name;
    }
    if (found != nullptr)
      use.parameters[name] = parse_in_unit(value, found->unit == "1" ? "" : found->unit, place);
    else if (!further(name, value))
      throw Error(Exit::usage, place, use.model + " has no parameter \"" + name + "\"",
                  "it takes " + (names.empty() ? "none" : names));
  }
  return use;
}

ShareAt structure_of(const manifest::Document& document, const manifest::MicrostructureUse& use, double depth_m,
                     const std::string& place) {
  const Microstructure& structure = known(use.model, place + "/model", Exit::data);
  std::vector<double> amounts;
  for (const Vec3& value : manifest::values_of(structure.info(), use.parameters, place)) amounts.push_back(value.x);
  MicrostructureFiles files{.picture = nullptr, .expression = use.expression};
  if (use.file.empty()) return structure.made(amounts, depth_m, files, place);
  const auto picture =
      std::make_shared<const io::GreyImage>(io::read_grey(manifest::resolve(document, use.file, place + "/file")));
  files.picture = picture.get();
  return
      [picture, share = structure.made(amounts, depth_m, files, place)](const SurfacePlace& at) { return share(at); };
}

}  // namespace gonio::relief
