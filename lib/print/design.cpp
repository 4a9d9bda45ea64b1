// See design.h.
#include "print/design.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "manifest/document.h"
#include "relief/lobe.h"
#include "relief/measured.h"
#include "relief/microstructure_use.h"

namespace gonio::print {
namespace {

constexpr int patch_px = 112, border_px = 8, slab = 2, steps = 8, halvings = 9;
constexpr double close_enough = 0.05, aperture_rad = 3 * pi / 180;
constexpr double facet_alpha = 0.1;  // roughness of the resin below what a print controls

struct Range {
  std::string parameter;
  double low = 0, high = 0;
  bool logarithmic = false;
};
Range range_of(const manifest::MicrostructureUse& use, WishedFigure figure, double layer_m, const std::string& place) {
  if (figure == WishedFigure::anisotropy && use.model == "sinusoid") {
    const double other = use.parameters.at("wave_v_m").scalar();
    return {"wave_u_m", other, 20 * other, true};
  }
  if (use.model == "noise") return {"amplitude", 0.02, 60, true};
  if (use.model == "sinusoid") return {"share", 0, 1, false};
  if (use.model == "ridges") {
    const double pitch = use.parameters.at("pitch_m").scalar();
    // pitch sin t cos t is at most a layer
    const double steepest = 2 * layer_m >= pitch ? pi / 4 : std::asin(2 * layer_m / pitch) / 2;
    return {"ridge_rad", 0.005, steepest, false};
  }
  throw Error(Exit::data, place, "\"" + use.model + "\" has no number to move", "begin with noise, sinusoid or ridges");
}

// In the order in which they are tried; of noise, finer first.
std::vector<manifest::MicrostructureUse> forms_of(const Printer& printer, WishedFigure figure) {
  manifest::MicrostructureUse use;
  if (figure == WishedFigure::anisotropy) {
    use.model = "sinusoid";
    use.parameters["wave_u_m"] = use.parameters["wave_v_m"] = 6 * std::max(printer.pixel_m.x, printer.pixel_m.y);
  } else if (figure == WishedFigure::contrast) {
    use.model = "ridges";
    use.parameters["pitch_m"] = 10 * std::max(printer.pixel_m.x, printer.pixel_m.y), use.parameters["ridge_rad"] = 0.1;
  } else {
    use.model = "noise";
    std::vector<manifest::MicrostructureUse> noises;
    for (const double frequency : {32.0, 16.0, 8.0, 4.0}) {
      use.parameters["frequency"] = frequency;
      noises.push_back(use);
    }
    return noises;
  }
  return {use};
}

struct Seen {
  double value = 0, sigma = 0;
};

Seen slopes_of(const relief::Measured& m, bool ratio) {
  const auto beckmann = std::ranges::find(m.normals.fits, "beckmann", &relief::SlopeFit::distribution);
  const double u = beckmann->alpha_u, v = beckmann->alpha_v, su = beckmann->sigma_alpha_u, sv = beckmann->sigma_alpha_v;
  if (ratio) return {u / v, u / v * std::hypot(su / u, sv / v)};
  const double mean = std::sqrt((u * u + v * v) / 2);
  return {mean, std::hypot(u * su, v * sv) / (2 * mean)};
}

Seen contrast_of(const io::HeightMap& map, const Wish& wish, std::uint64_t seed) {
  const relief::Relief patch = relief::relief_of(map, relief::Tiling::mirrored, "patch");
  const auto along = [](double theta, double azimuth) {
    return Vec3{std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth), std::cos(theta)};
  };
  // Facets tilt towards v (y up): light from there. A patch that is turned sees the same light from u.
  const auto sent = [&](double azimuth) {
    return relief::lobe(patch, relief::facets_of_index(wish.eta, facet_alpha), along(wish.view_rad, azimuth + pi),
                        along(wish.incidence_rad, azimuth), {aperture_rad, aperture_rad},
                        {.paths = 1 << 15, .seed = seed});
  };
  const relief::Estimate a = sent(pi / 2), b = sent(0);
  const double sum = a.value.y + b.value.y;
  if (!(sum > 0)) return {};
  return {(a.value.y - b.value.y) / sum, 2 * std::hypot(a.value.y * b.sigma.y, b.value.y * a.sigma.y) / (sum * sum)};
}

Seen figure_of(const io::HeightMap& map, const Wish& wish, std::uint64_t seed) {
  if (wish.figure == WishedFigure::contrast) return contrast_of(map, wish, seed);
  const relief::Measured m = relief::measured(map, {}, "patch");
  if (wish.figure == WishedFigure::alpha || wish.figure == WishedFigure::anisotropy)
    return slopes_of(m, wish.figure == WishedFigure::anisotropy);
  const relief::Figure& figure = m.roughness[wish.figure == WishedFigure::sq ? "Sq" : "Sa"];
  return {figure.value, figure.sigma.value_or(0)};
}

class Search {
 public:
  Search(const Printer& printer, const Wish& wish, const std::optional<GroundAt>& ground,
         manifest::MicrostructureUse use, int points, std::uint64_t seed, const std::string& place)
      : printer_(printer),
        wish_(wish),
        ground_(ground),
        use_(std::move(use)),
        points_(points),
        seed_(seed),
        place_(place),
        range_(range_of(use_, wish.figure, printer.layer_m, place)) {}

  // Do the ends of the range and its middle leave the wished value between them?
  bool may_reach() {
    Design ends;
    for (const double s : {0.0, 0.5, 1.0}) look(s, ends);
    const auto [least, most] = std::ranges::minmax(ends.tried, {}, &DesignStep::figure);
    return least.figure <= wish_.value && wish_.value <= most.figure;
  }

  Design found() {
    Design out;
    out.moved = range_.parameter;
    double low = 0, high = 0;
    bool crossed = false;
    for (int k = 0; k <= steps; ++k) {
      const double s = static_cast<double>(k) / steps;
      look(s, out);
      const std::size_t n = out.tried.size();
      if (!crossed && n > 1 && (out.tried[n - 2].figure - wish_.value) * (out.tried[n - 1].figure - wish_.value) <= 0)
        crossed = true, low = s - 1.0 / steps, high = s;
    }
    const auto [least, most] = std::ranges::minmax_element(out.tried, {}, &DesignStep::figure);
    out.least = least->figure, out.most = most->figure;
    double best = nearest(out);
    if (crossed) {
      const bool rising = out.tried[static_cast<std::size_t>(std::lround(high * steps))].figure >= wish_.value;
      for (int k = 0; k < halvings; ++k) {
        const double middle = (low + high) / 2;
        (look(middle, out).value < wish_.value) == rising ? low = middle : high = middle;
      }
      best = nearest(out);
    }
    use_.parameters[range_.parameter] = best;
    out.use = use_;
    out.map = patch(best);
    const Seen seen = figure_of(out.map, wish_, seed_);
    out.reached = seen.value, out.sigma = seen.sigma;
    out.met = std::abs(out.reached - wish_.value) <=
              std::max(close_enough * std::abs(wish_.value), crossed ? 2 * out.sigma : 0);
    return out;
  }

 private:
  double strength(double s) const {
    return range_.logarithmic ? range_.low * std::pow(range_.high / range_.low, s)
                              : range_.low + s * (range_.high - range_.low);
  }
  io::HeightMap patch(double value) {
    use_.parameters[range_.parameter] = value;
    const manifest::Document none;
    return printed_patch(printer_, relief::structure_of(none, use_, printer_.layer_m, place_), ground_, patch_px,
                         points_);
  }
  Seen look(double s, Design& out) {
    const double value = strength(s);
    const Seen seen = figure_of(patch(value), wish_, seed_);
    out.tried.push_back({value, seen.value});
    return seen;
  }
  double nearest(const Design& out) const {
    return std::ranges::min_element(out.tried, {},
                                    [&](const DesignStep& d) { return std::abs(d.figure - wish_.value); })
        ->strength;
  }

  const Printer& printer_;
  const Wish& wish_;
  const std::optional<GroundAt>& ground_;
  manifest::MicrostructureUse use_;
  int points_;
  std::uint64_t seed_;
  const std::string& place_;
  Range range_;
};

}  // namespace

const std::vector<std::string>& wished_figures() {
  static const std::vector<std::string> names{"sq", "sa", "alpha", "anisotropy", "contrast"};
  return names;
}

io::HeightMap printed_patch(const Printer& printer, const relief::ShareAt& structure,
                            const std::optional<GroundAt>& ground, int side_px, int points) {
  const int side = side_px + 2 * border_px;
  Printer small = printer;
  small.width_px = small.height_px = side;
  const PixelGrid grid = small.grid();
  const double layer_m = printer.layer_m;
  constexpr int samples = 4;
  std::vector<std::vector<float>> layers(slab + 1, std::vector<float>(grid.pixels(), 1.0f));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      double sum = 0;
      for (int k = 0; k < samples * samples; ++k) {
        const Vec2 at{grid.corner_m.x + (x + (k % samples + 0.5) / samples) * grid.pixel_m.x,
                      grid.corner_m.y + (y + (k / samples + 0.5) / samples) * grid.pixel_m.y};
        sum += structure({at, {at.x, at.y, (slab + 1) * layer_m}});
      }
      const double grey = printer.growth.grey_of_share(sum / (samples * samples), layer_m);
      layers[slab][static_cast<std::size_t>(y * side + x)] = static_cast<float>(std::round(255 * grey) / 255);
    }
  small.layers_m.clear();
  CuredSurface surface = cured(small, {0, 0, side, side}, layers, 0, points);
  if (ground) add_ground(surface, *ground);
  const io::HeightMap whole = height_map_of(surface);
  const auto cut = static_cast<std::size_t>(border_px * points);
  io::HeightMap inner{.width = whole.width - 2 * cut,
                      .height = whole.height - 2 * cut,
                      .step_x_m = whole.step_x_m,
                      .step_y_m = whole.step_y_m,
                      .z_m = {}};
  for (std::size_t y = 0; y < inner.height; ++y)
    for (std::size_t x = 0; x < inner.width; ++x) inner.z_m.push_back(whole.at(x + cut, y + cut));
  return inner;
}

Design design(const Printer& printer, const Wish& wish, const std::optional<GroundAt>& ground,
              const std::optional<manifest::MicrostructureUse>& form, int points, std::uint64_t seed,
              const std::string& place) {
  const std::vector<manifest::MicrostructureUse> forms =
      form ? std::vector<manifest::MicrostructureUse>{*form} : forms_of(printer, wish.figure);
  for (std::size_t k = 0; k + 1 < forms.size(); ++k)
    if (Search search(printer, wish, ground, forms[k], points, seed, place); search.may_reach()) return search.found();
  return Search(printer, wish, ground, forms.back(), points, seed, place).found();
}

}  // namespace gonio::print
