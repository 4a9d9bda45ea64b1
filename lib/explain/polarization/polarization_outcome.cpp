// See polarization_outcome.h.
#include "explain/polarization/polarization_outcome.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "report/colour_map.h"

namespace gonio::explain::polarization {
namespace {

constexpr std::size_t most_drawn = 4;

std::string squares_svg(const MosaicLight& light, const std::vector<Row>& rows, std::size_t image,
                        const std::vector<double>& value, double scale) {
  const auto& picture = light.recordings().images[image].picture;
  std::string svg = format(
      "<svg viewBox=\"0 0 %d %d\" role=\"img\" shape-rendering=\"crispEdges\" "
      "style=\"background:#ddd;min-width:min(22rem,85vw)\">",
      picture.width, picture.height);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (light.tiles()[rows[i].tile].image != image) continue;
    const Site& site = light.site(rows[i].tile, rows[i].place);
    const std::string colour = report::hex(report::signed_colour(std::clamp(value[i] / scale, -1.0, 1.0)));
    svg += format("<rect x=\"%d\" y=\"%d\" width=\"1\" height=\"1\" fill=\"%s\"/>", site.x, site.y, colour.c_str());
  }
  return svg + "</svg>";
}

}  // namespace

void upgrade(const Setup& setup, const Use& use, const inference::Explanation& e, manifest::Document& document) {
  const std::size_t count = use.neutral.size();
  bool active = false;
  for (std::size_t k = 0; k < count; ++k)
    active = active || std::ranges::find(e.active, use.first + k) != e.active.end();
  if (!active) return;
  const std::span<const double> p = std::span(e.values).subspan(use.first, count),
                                sigma = std::span(e.sigma).subspan(use.first, count);
  if (use.term->write != nullptr) {
    use.term->write(document, setup, use.form, p, sigma);
    return;
  }
  const mechanism::Mechanism& m = use.term->mechanism();
  manifest::MechanismUse& entry = document.mechanisms[m.id];
  if (std::ranges::find(entry.on, setup.camera) == entry.on.end()) entry.on.push_back(setup.camera);
  const auto place = static_cast<std::size_t>(std::ranges::find(entry.on, setup.camera) - entry.on.begin());
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double>&value = entry.parameters[m.parameters[k].name].value,
    &sigmas = entry.sigma[m.parameters[k].name];
    value.resize(entry.on.size()), sigmas.resize(entry.on.size());
    value[place] = p[k], sigmas[place] = sigma[k];
  }
}

inference::Illustration illustrate_mosaics(const MosaicLight& light, const std::vector<Row>& rows,
                                           const inference::Observations& observations,
                                           const inference::Explanation& e) {
  inference::Illustration result;
  if (e.residual_before.size() != rows.size()) return result;
  double squares = 0;
  for (const double y : observations.value) squares += y * y;
  const double scale = 0.1 * std::sqrt(squares / static_cast<double>(rows.size()));
  std::vector<std::pair<double, std::size_t>> worst;
  for (std::size_t g = 0; g < light.recordings().images.size(); ++g) worst.emplace_back(0, g);
  for (std::size_t i = 0; i < rows.size(); ++i)
    worst[light.tiles()[rows[i].tile].image].first += std::pow(e.residual_before[i] / observations.sigma[i], 2);
  std::sort(worst.rbegin(), worst.rend());
  for (std::size_t k = 0; k < std::min(most_drawn, worst.size()); ++k) {
    const std::size_t image = worst[k].second;
    const std::string& id = light.recordings().images[image].id;
    result.pictures.push_back({id + format(": samples less simulation; red: brighter, full colour at %.3g", scale), "",
                               squares_svg(light, rows, image, e.residual_before, scale)});
    if (!e.named.empty())
      result.pictures.push_back(
          {id + ": the same with the named physics", "", squares_svg(light, rows, image, e.residual_after, scale)});
  }
  return result;
}

}  // namespace gonio::explain::polarization
