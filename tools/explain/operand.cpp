// See operand.h.
#include "tools/explain/operand.h"

#include <filesystem>

#include "cli/height_maps.h"
#include "explain/tables/quick_table.h"
#include "goniometry/tables/sample_table.h"

namespace gonio::tools::explain {

using namespace gonio::explain;

void read_operand(cli::Invocation& call) {
  const std::vector<std::string>& operands = call.texts("FILE");
  if (operands.empty() && !call.given("table")) {
    for (const char* name : {"step", "step-y", "unit", "channel"})
      if (call.given(name))
        throw Error(Exit::usage, std::string("--") + name, "says something about a height map, and none is given",
                    "name it: explain map.tif --step 1.6um --unit um; in a manifest reliefs say it");
    for (const char* name : {"model", "observed", "sigma", "group", "block", "units", "free"})
      if (call.given(name))
        throw Error(Exit::usage, std::string("--") + name, "says something about a table, and none is given",
                    "name it: explain data.csv --model 'a*cos(theta)+b' --observed f --free a=1,b=0");
    return;
  }
  if (call.has_document || operands.size() + call.given("table") > 1)
    throw Error(Exit::usage, "explain", "has more than one thing to explain", "give one manifest, or one table");
  tables::QuickTable quick;
  quick.file = operands.empty() ? call.text("table") : operands[0];
  if (!std::filesystem::exists(quick.file))
    throw Error(Exit::no_input, quick.file.string(), "does not exist", "name a table, a height map or a manifest");
  call.note_input(quick.file);
  call.has_document = true;
  using tables::HeightMapKind;
  const HeightMapKind heights = tables::height_map_kind(quick.file);
  for (const cli::Option& option : cli::picture_options())
    if (call.given(option.name) && heights != HeightMapKind::picture)
      throw Error(Exit::usage, "--" + option.name,
                  "says what the numbers of an OpenEXR or TIFF mean, and " + quick.file.string() + " is none",
                  "leave it out");
  if (heights != HeightMapKind::none) {
    call.document = tables::height_map_document(quick.file, cli::picture_asked(call));
    return;
  }
  const bool reflectance = goniometry::describes_itself(quick.file);
  for (const char* needed : {"model", "observed"})
    if (!reflectance && !call.given(needed))
      throw Error(Exit::usage, quick.file.string(), std::string("is a table without --") + needed,
                  "explain data.csv --model 'a*cos(theta)+b' --observed f --free a=1,b=0");
  quick.model = call.given("model") ? call.text("model") : "surface";
  quick.observed = call.given("observed") ? call.texts("observed") : std::vector<std::string>{"f"};
  quick.sigma = call.texts("sigma");
  if (call.given("group")) quick.group = call.text("group");
  if (call.given("block")) quick.block = call.text("block");
  if (call.given("units")) quick.units = tables::parse_pairs(call.text("units"), "--units");
  if (call.given("free")) quick.free = tables::parse_numbers(call.text("free"), "--free");
  call.document = tables::quick_document(quick);
}

void check_out(const cli::Invocation& call) {
  if (call.out.empty() || call.force || !std::filesystem::is_directory(call.out)) return;
  for (const auto& entry : std::filesystem::directory_iterator(call.out)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("effect-") || name.starts_with("evidence-"))
      throw Error(Exit::cannot_create, entry.path().string(), "exists", "--force replaces it");
  }
}

}  // namespace gonio::tools::explain
