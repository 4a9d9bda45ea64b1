// Tables and entries of `contrast measure` (contrast/measure/measure_tables.h).
#include "contrast/measure/measure_tables.h"

#include <cmath>

#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/contrast.h"
#include "manifest/sections/pattern.h"

namespace gonio::contrast {
namespace {

std::string number(double value) {
  return std::isfinite(value) ? shortest_text(value) : "";
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string joined(const std::vector<std::string>& fields) {
  std::string line;
  for (const std::string& field : fields) line += (line.empty() ? "" : ",") + field;
  return line + "\n";
}

std::optional<double> known(double value) {
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

std::string views_csv(const Measured& m) {
  std::string text =
      "image,placement,partner,tilt_rad,azimuth_rad,along_rad,s1,s1_sigma,s2,s2_sigma,difference,difference_sigma,"
      "michelson,michelson_sigma,degrees,right,cells,place_px,shift_x_px,shift_y_px\n";
  for (const MeasuredView& v : m.views) {
    std::size_t cells = 0;
    for (const double mean : v.means.mean) cells += std::isfinite(mean);
    text += joined({quoted(v.image),
                    quoted(m.placement[static_cast<std::size_t>(v.placement)]),
                    v.partner ? quoted(m.views[*v.partner].image) : "",
                    number(v.tilt_rad),
                    number(v.azimuth_rad),
                    number(v.along_rad),
                    number(v.bright.value),
                    number(v.bright.sigma),
                    number(v.dark.value),
                    number(v.dark.sigma),
                    number(v.difference.value),
                    number(v.difference.sigma),
                    number(v.michelson.value),
                    number(v.michelson.sigma),
                    number(v.degrees),
                    number(v.right),
                    std::to_string(cells),
                    number(v.place_px),
                    number(v.shift_px.x),
                    number(v.shift_px.y)});
  }
  return text;
}

std::string cells_csv(const Measured& m) {
  std::string text = "row,column,bit,turn,turn_sigma,distance,p,defect\n";
  const auto wide = static_cast<std::size_t>(m.pattern.columns);
  for (std::size_t cell = 0; cell < m.pattern.cells(); ++cell)
    text += joined({std::to_string(cell / wide), std::to_string(cell % wide), std::to_string(m.pattern.bits[cell]),
                    number(m.cell_turn[cell].value), number(m.cell_turn[cell].sigma), number(m.defects.distance[cell]),
                    number(m.defects.p[cell]), m.defects.p[cell] <= m.defects.alarm_rate ? "1" : "0"});
  return text;
}

std::string series_csv(const Measured& m) {
  std::string text = "image,row,column,mean,sigma,pixels,ratio\n";
  const auto wide = static_cast<std::size_t>(m.pattern.columns);
  for (const MeasuredView& v : m.views)
    for (std::size_t cell = 0; cell < m.pattern.cells(); ++cell)
      text +=
          joined({quoted(v.image), std::to_string(cell / wide), std::to_string(cell % wide), number(v.means.mean[cell]),
                  number(v.means.sigma[cell]), std::to_string(v.means.pixels[cell]), number(v.ratio[cell])});
  return text;
}

void enter(manifest::Document& document, const Measured& m) {
  std::erase_if(document.contrasts,
                [&](const manifest::Contrast& c) { return c.action == "measure" && c.pattern == m.pattern_name; });
  for (const MeasuredView& v : m.views) {
    manifest::Contrast c;
    c.action = "measure";
    c.pattern = m.pattern_name;
    c.placement = m.placement[static_cast<std::size_t>(v.placement)];
    c.image = v.image;
    if (v.partner) c.partner = m.views[*v.partner].image;
    c.tilt_rad = known(v.tilt_rad);
    c.signals = {v.bright.value, v.dark.value};
    c.difference = v.difference.value;
    c.michelson = known(v.michelson.value);
    c.sigma["signals"] = {v.bright.sigma, v.dark.sigma};
    c.sigma["difference"] = {v.difference.sigma};
    if (c.michelson) c.sigma["michelson"] = {v.michelson.sigma};
    c.right = v.right;
    std::int64_t cells = 0;
    for (const double mean : v.means.mean) cells += std::isfinite(mean);
    c.cells = cells;
    document.contrasts.push_back(std::move(c));
  }
  manifest::Pattern& pattern = document.patterns.at(m.pattern_name);
  pattern.defects.clear();
  const auto wide = static_cast<std::size_t>(m.pattern.columns);
  for (const CellDefect& d : m.defects.found)
    pattern.defects.push_back({static_cast<int>(d.cell / wide), static_cast<int>(d.cell % wide), d.distance, d.p});
  if (m.code && pattern.text.empty() && pattern.file.empty()) pattern.text = m.code->text;
  for (std::size_t k = 0; k < 2; ++k) {
    if (!m.pose[k] || m.pose[k]->stated) continue;
    auto& pose = pattern.placements[k].world_from_pattern.emplace();
    static_cast<Rigid<frame::World, frame::Object>&>(pose) = m.pose[k]->world_from_pattern;
    const auto sigma = [&](std::size_t i) { return std::sqrt(m.pose[k]->covariance[7 * i]); };
    pose.sigma = manifest::PoseSigma{{sigma(0), sigma(1), sigma(2)}, {sigma(3), sigma(4), sigma(5)}};
  }
}

}  // namespace gonio::contrast
