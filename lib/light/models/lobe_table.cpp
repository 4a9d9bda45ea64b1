// A point lamp that is the same all round its axis, its intensity measured over the emission angle:
//   I(theta) = watt_per_sr relative(theta), linear between the rows of the table, zero beyond them.
// The table is CSV: a head "emission_rad,relative" or "emission_deg,relative", then rows of ascending angles from the
// axis, 0 to pi; lines that begin with # do not count.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "light/number_file.h"
#include "light/spherical_table.h"

namespace gonio::light {
namespace {

enum : std::size_t { position_index, direction_index, intensity_index };

std::string without_blanks(const std::string& text) {
  std::string result;
  for (const char c : text)
    if (c != ' ' && c != '\t' && c != '"') result += c;
  return result;
}

SphericalGrid table_of(const std::filesystem::path& path, const std::string& place) {
  const auto lines = lines_of(text_of(path, place));
  SphericalGrid grid;
  grid.longitude_rad = {0};
  double unit = 0;  // rad; 0 before the head
  for (std::size_t n = 0; n < lines.size(); ++n) {
    const std::string line = without_blanks(lines[n]), here = path.string() + ", line " + std::to_string(n + 1);
    if (line.empty() || line[0] == '#') continue;
    if (unit == 0) {
      unit = line == "emission_rad,relative" ? 1 : line == "emission_deg,relative" ? pi / 180 : 0;
      if (unit == 0)
        throw Error(Exit::data, here, "\"" + line + "\" is not the head", "begin with emission_rad,relative");
      continue;
    }
    const std::size_t comma = line.find(',');
    const auto angle = number_of(line.substr(0, comma));
    const auto value = comma == std::string::npos ? std::nullopt : number_of(line.substr(comma + 1));
    if (!angle || !value || *value < 0)
      throw Error(Exit::data, here, "\"" + line + "\" is not an angle and an intensity", "two numbers, none negative");
    const double rad = *angle * unit;
    const bool ascends = grid.colatitude_rad.empty() ? rad >= 0 : rad > grid.colatitude_rad.back();
    if (!ascends || rad > pi + 1e-9)
      throw Error(Exit::data, here,
                  "emission angle " + shortest_text(*angle) + " is out of order or beyond 180 degrees",
                  "ascending angles from the axis");
    grid.colatitude_rad.push_back(std::min(rad, pi));
    grid.value.push_back(*value);
  }
  if (grid.value.size() < 2) throw Error(Exit::data, path.string(), "has fewer than two rows", "tabulate the lobe");
  return grid;
}

class LobeTableModel final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::light,
        .id = "lobe-table",
        .sentence = "A small lamp whose intensity was measured over the angle from its axis.",
        .source = "linear interpolation of the table",
        .parameters = {position_info("where the lamp is, in the world frame"), direction_info(),
                       intensity_info("radiant intensity where the table says 1, of linear red, green and blue")},
        .attachment = manifest::Attachment::table,
        .attachment_meaning = "CSV: emission_rad (or emission_deg) and relative, ascending",
    };
    return info;
  }
  std::unique_ptr<Emitter> prepare(const manifest::Parameters& parameters, const Attachment& file,
                                   const std::string& place) const override {
    const auto v = manifest::values_of(info(), parameters, place);
    return aimed_lamp(v[position_index], lamp_frame(v[direction_index], {}, place), v[intensity_index], 0,
                      tabulated_lobe(table_of(file.path, place)));
  }
};

}  // namespace

const Model& lobe_table() {
  static const LobeTableModel model;
  return model;
}

}  // namespace gonio::light
