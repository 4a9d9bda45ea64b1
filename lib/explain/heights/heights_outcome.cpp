// See heights_outcome.h.
#include "explain/heights/heights_outcome.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "mechanism/mechanism.h"
#include "report/colour_map.h"
#include "report/number_text.h"

namespace gonio::mechanism {
const Mechanism& surface_anisotropy();
const Mechanism& surface_micro_ridges();
}  // namespace gonio::mechanism

namespace gonio::explain {
namespace {

using namespace heights;

const Estimate* estimate_of(const Problem& problem, const Explanation& e, const std::string& name) {
  for (const Estimate& estimate : e.estimates)
    if (problem.parameters()[estimate.parameter].name == name) return &estimate;
  return nullptr;
}

double shortest_per_m(const TileSpectra& spectra) {
  double highest = 0;
  for (const Ordinate& o : spectra.ordinates) highest = std::max(highest, std::hypot(o.fx, o.fy));
  return highest;
}

std::string length_text(double metres, double sigma) {
  const double micro = 1e-6;
  return report::with_sigma(metres / micro, sigma / micro) + " um";
}

// One square per ordinate, the half plane and its mirror image.
std::string spectrum_svg(const TileSpectra& spectra, const std::vector<double>& value, double low, double high,
                         bool is_signed) {
  int reach = 1;
  for (const Ordinate& o : spectra.ordinates) reach = std::max({reach, o.kx, std::abs(o.ky)});
  const int side = 2 * reach + 1;
  char text[200];
  std::snprintf(text, sizeof text,
                "<svg viewBox=\"0 0 %d %d\" role=\"img\" shape-rendering=\"crispEdges\" "
                "style=\"background:#fff;min-width:min(22rem,85vw)\">",
                side, side);
  std::string svg = text;
  for (std::size_t i = 0; i < spectra.ordinates.size(); ++i) {
    const Ordinate& o = spectra.ordinates[i];
    const double t = (value[i] - low) / (high - low);
    const std::string colour = report::hex(is_signed ? report::signed_colour(2 * t - 1) : report::magnitude_colour(t));
    for (const int sign : {1, -1}) {
      std::snprintf(text, sizeof text, "<rect x=\"%d\" y=\"%d\" width=\"1\" height=\"1\" fill=\"%s\"/>",
                    reach + sign * o.kx, reach + sign * o.ky, colour.c_str());
      svg += text;
    }
  }
  return svg + "</svg>";
}

std::vector<double> over_tiles(const TileSpectra& spectra, const std::vector<double>& rows) {
  const std::size_t n = spectra.ordinates.size();
  std::vector<double> mean(n, 0.0);
  for (std::size_t i = 0; i < rows.size(); ++i)
    mean[i % n] += rows[i] * static_cast<double>(n) / static_cast<double>(rows.size());
  return mean;
}

}  // namespace

std::string heights_remarks(const HeightsInput& input, const TileSpectra& spectra, const Problem& problem,
                            const Explanation& e) {
  std::string text;
  const std::string ridges = mechanism::surface_micro_ridges().id + ".", lay = mechanism::surface_anisotropy().id + ".";
  if (const Estimate* period = estimate_of(problem, e, ridges + "ridge_period_m")) {
    const Estimate *azimuth = estimate_of(problem, e, ridges + "ridge_azimuth_rad"),
                   *amplitude = estimate_of(problem, e, ridges + "ridge_amplitude_m");
    text += "Ridges repeat every " + length_text(period->value, period->sigma) + " across the direction at " +
            report::with_sigma(azimuth->value / degree, azimuth->sigma / degree) +
            " degrees from the rows (towards the columns' end), their first harmonic " +
            length_text(2 * amplitude->value, 2 * amplitude->sigma) + " from crest to trough.";
  }
  if (const Estimate* a0 = estimate_of(problem, e, lay + "anisotropy_0")) {
    const Estimate* a45 = estimate_of(problem, e, lay + "anisotropy_45");
    const double r = std::hypot(a0->value, a45->value), along = 0.5 * std::atan2(a45->value, a0->value);
    char lengths[160];
    std::snprintf(lengths, sizeof lengths,
                  "%sThe lay: features are %.2f times as long across %.0f degrees as along it.",
                  text.empty() ? "" : " ", std::exp(2 * r), along / degree);
    text += lengths;
  }
  char seen[200];
  std::snprintf(seen, sizeof seen,
                "%s%zu tiles of %zu x %zu points (%zu more served the search, %zu had gaps); periods from %.3g to %.3g "
                "um were looked at.",
                text.empty() ? "" : " ", spectra.judged.size(), spectra.n, spectra.n, spectra.searched.size(),
                spectra.left_out, 1e6 / shortest_per_m(spectra),
                1e6 * static_cast<double>(spectra.n) * std::min(input.map.step_x_m, input.map.step_y_m) / 2);
  return text + seen;
}

void upgrade_heights(const HeightsInput& input, std::span<const double> harmonic, const Problem& problem,
                     const Explanation& e, manifest::Document& document) {
  for (std::size_t p = 0; p < problem.parameters().size(); ++p) {
    const std::string& name = problem.parameters()[p].name;
    const std::size_t dot = name.rfind('.');
    if (!name.starts_with("surface.") || dot == std::string::npos) continue;
    if (std::find(e.active.begin(), e.active.end(), p) == e.active.end()) continue;
    manifest::MechanismUse& use = document.mechanisms[name.substr(0, dot)];
    if (!input.surface.empty() && std::find(use.on.begin(), use.on.end(), input.surface) == use.on.end())
      use.on.push_back(input.surface);
    use.parameters[name.substr(dot + 1)] = manifest::Parameter(e.values[p]);
    use.sigma[name.substr(dot + 1)] = {e.sigma[p]};
    if (name.ends_with("ridge_period_m"))
      for (std::size_t k = 0; k < harmonic.size(); ++k)
        use.parameters["ridge_harmonic_" + std::to_string(k + 2)] = manifest::Parameter(harmonic[k]);
  }
}

Illustration illustrate_heights(const TileSpectra& spectra, const Problem& problem, const Explanation& e) {
  Illustration result;
  const std::vector<double> power = over_tiles(spectra, problem.observations().value);
  const auto [low, high] = std::minmax_element(power.begin(), power.end());
  result.pictures.push_back({"Power spectrum, logarithmic, mean of the tiles; zero frequency in the middle", "",
                             spectrum_svg(spectra, power, *low, *high, false)});
  // Means of as many tiles: six standard errors fill the scale.
  const double scale = 6 * log_sigma / std::sqrt(static_cast<double>(spectra.judged.size()));
  result.pictures.push_back({"What the isotropic surface leaves of it (white: nothing)", "",
                             spectrum_svg(spectra, over_tiles(spectra, e.residual_before), -scale, scale, true)});
  if (!e.named.empty())
    result.pictures.push_back({"The same with the named physics", "",
                               spectrum_svg(spectra, over_tiles(spectra, e.residual_after), -scale, scale, true)});
  return result;
}

}  // namespace gonio::explain
