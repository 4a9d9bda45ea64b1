// See stack_pictures.h.
#include "explain/stacks/stack_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/parallel.h"
#include "explain/stacks/grid_regions.h"
#include "io/picture.h"
#include "manifest/document.h"

namespace gonio::explain::stacks {
namespace {

constexpr std::size_t most_pictures = 3, most_boxes = 4, least_box = 12;
constexpr float beyond = 3;  // standard deviations

const char* colour_of(const Stack& stack, int channel) {
  static const char* const colours[] = {"#c55a00", "#00805e", "#0067a5"};
  return stack.channels.size() == 1 ? "#444" : colours[channel];
}

struct Frame {
  double left, right, bottom, top;  // log10
  double x(double v) const { return 40 + 540 * (v - left) / (right - left); }
  double y(double v) const { return 360 - 340 * (v - bottom) / (top - bottom); }
};

std::string printed_path(const char* format, double a, double b) {
  char text[64];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

// Powers of ten on both axes.
std::string axes(const Frame& f) {
  std::string svg;
  char text[200];
  for (double v = std::ceil(f.left); v <= f.right; ++v) {
    std::snprintf(text, sizeof text,
                  "<line x1=\"%.1f\" y1=\"20\" x2=\"%.1f\" y2=\"360\" stroke=\"#ddd\"/><text x=\"%.1f\" y=\"376\" "
                  "font-size=\"12\" text-anchor=\"middle\">%g</text>",
                  f.x(v), f.x(v), f.x(v), std::pow(10, v));
    svg += text;
  }
  for (double v = std::ceil(f.bottom); v <= f.top; ++v) {
    std::snprintf(text, sizeof text,
                  "<line x1=\"40\" y1=\"%.1f\" x2=\"580\" y2=\"%.1f\" stroke=\"#ddd\"/><text x=\"36\" y=\"%.1f\" "
                  "font-size=\"12\" text-anchor=\"end\">%g</text>",
                  f.y(v), f.y(v), f.y(v) + 4, std::pow(10, v));
    svg += text;
  }
  return svg;
}

// The radiance that fits the readings of one pixel best under `chain`: Gauss-Newton in its logarithm, damped.
double fitted_log_radiance(const ReadingChain& chain, const Site& site, const std::vector<Taken>& taken,
                           const std::vector<double>& y, const std::vector<double>& sigma, double at) {
  const auto cost = [&](double l) {
    double sum = 0;
    for (std::size_t k = 0; k < y.size(); ++k) {
      const double z = (y[k] - chain(std::exp(l), site.channel, taken[site.seen[k]])) / sigma[k];
      sum += z * z;
    }
    return sum;
  };
  double now = cost(at);
  for (int i = 0; i < 12; ++i) {
    double top = 0, bottom = 0;
    for (std::size_t k = 0; k < y.size(); ++k) {
      const Taken& t = taken[site.seen[k]];
      const double f = chain(std::exp(at), site.channel, t);
      const double slope = (chain(std::exp(at + 1e-4), site.channel, t) - f) / 1e-4;
      top += slope * (y[k] - f) / (sigma[k] * sigma[k]);
      bottom += slope * slope / (sigma[k] * sigma[k]);
    }
    if (!(bottom > 0)) break;
    double step = std::clamp(top / bottom, -2.0, 2.0), then = cost(at + step);
    for (int halvings = 0; then > now && halvings < 8; ++halvings) then = cost(at + (step /= 2));
    if (!(then < now)) break;
    at += step;
    now = then;
    if (std::abs(step) < 1e-6) break;
  }
  return at;
}

std::vector<Box> boxes_of(const std::vector<std::uint8_t>& counts, const Effects& effects, const std::string& group) {
  const std::vector<GridRegion> found = grid_regions(counts, effects.width, effects.height, least_box);
  std::vector<Box> boxes;
  for (std::size_t k = 0; k < std::min(most_boxes, found.size()); ++k) {
    const GridRegion& r = found[k];
    const int s = effects.stride;
    boxes.push_back({group, r.left * s, r.top * s, (r.right - r.left + 1) * s, (r.bottom - r.top + 1) * s});
  }
  return boxes;
}

io::Image effect_picture(const Stack& stack, const Effects& effects, std::size_t image) {
  io::Image picture(stack.width(), stack.height(), {"Y"});
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const float e =
          effects.effect[image][static_cast<std::size_t>(y / effects.stride * effects.width + x / effects.stride)];
      picture.at(x, y, 0) = e / (e + beyond);
    }
  return picture;
}

}  // namespace

std::string curve_drawing(const Stack& stack, const ReadingChain& chain, const std::vector<CurveDot>& dots) {
  Frame f{1e300, -1e300, 1e300, -1e300};
  for (const CurveDot& d : dots) {
    if (!(d.light > 0) || !(d.reading > 0)) continue;
    f.left = std::min(f.left, std::log10(d.light)), f.right = std::max(f.right, std::log10(d.light));
    f.bottom = std::min(f.bottom, std::log10(d.reading)), f.top = std::max(f.top, std::log10(d.reading));
  }
  f.left -= 0.1, f.right += 0.1, f.bottom -= 0.1, f.top += 0.1;
  std::string svg =
      "<svg viewBox=\"0 0 600 390\" role=\"img\" style=\"background:#fff;min-width:min(27rem,85vw)\">" + axes(f);
  for (const CurveDot& d : dots)
    if (d.light > 0 && d.reading > 0)
      svg += "<circle r=\"1.3\" fill-opacity=\"0.35\" fill=\"" + std::string(colour_of(stack, d.channel)) +
             printed_path("\" cx=\"%.1f\" cy=\"%.1f\"/>", f.x(std::log10(d.light)), f.y(std::log10(d.reading)));
  for (std::size_t c = 0; c <= stack.channels.size(); ++c) {
    const bool linear = c == stack.channels.size();
    std::string path;
    for (int i = 0; i <= 100; ++i) {
      const double x = f.left + (f.right - f.left) * i / 100, light = std::pow(10, x);
      const double v = linear ? stack.reading(0, light) : chain.reading(light, static_cast<int>(c));
      if (!(v > 0)) continue;
      const double y = std::log10(v);
      if (y < f.bottom || y > f.top) continue;
      path += printed_path(path.empty() ? "M%.1f %.1f" : "L%.1f %.1f", f.x(x), f.y(y));
    }
    svg += "<path fill=\"none\" d=\"" + path + "\" stroke=\"" +
           (linear ? std::string("#000\" stroke-dasharray=\"5 4\"")
                   : colour_of(stack, static_cast<int>(c)) + std::string("\"")) +
           " stroke-width=\"1.5\"/>";
  }
  return svg + "</svg>";
}

Effects empty_effects(const Stack& stack, double most_pixels) {
  Effects effects;
  const double pixels = static_cast<double>(stack.width()) * stack.height();
  effects.stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / most_pixels))));
  if (stack.step > 1) effects.stride = stack.step * ((effects.stride + stack.step - 1) / stack.step);
  effects.width = (stack.width() + effects.stride - 1) / effects.stride;
  effects.height = (stack.height() + effects.stride - 1) / effects.stride;
  const auto size = static_cast<std::size_t>(effects.width) * static_cast<std::size_t>(effects.height);
  effects.effect.assign(stack.images.size(), std::vector<float>(size));
  effects.share = effects.effect;
  return effects;
}

Effects exposure_effects(const Stack& stack, const ReadingNoise& noise, const std::vector<Taken>& taken,
                         const ReadingChain& before, const ReadingChain& after, bool named) {
  Effects effects = empty_effects(stack);
  std::vector<double> rms(stack.images.size());
  for (std::size_t g = 0; g < rms.size(); ++g) {
    double sum = 1e-30;
    for (const float v : stack.images[g].picture.data) sum += double{v} * v;
    rms[g] = std::sqrt(sum / static_cast<double>(stack.images[g].picture.data.size()));
  }
  parallel_for(0, static_cast<std::size_t>(effects.height), [&](std::size_t row) {
    std::vector<double> y, sigma;
    std::vector<Taken> there = taken;
    for (int column = 0; column < effects.width; ++column)
      for (int c = 0; c < static_cast<int>(stack.channels.size()); ++c) {
        Site site{column * effects.stride, static_cast<int>(row) * effects.stride, c, 0, 0, {}};
        y.clear(), sigma.clear();
        double sum = 0, time = 0;
        for (std::size_t g = 0; g < stack.images.size(); ++g) {
          const std::size_t i = stack.images[g].picture.index(site.x, site.y, c);
          if (!stack.images[g].counts[i]) continue;
          site.seen.push_back(g);
          y.push_back(stack.images[g].picture.data[i]);
          sigma.push_back(noise.sigma(g, y.back()));
          sum += stack.linear(c, y.back()), time += taken[g].exposure_s * taken[g].gain;
        }
        if (y.size() < 2) continue;
        const double start = std::log(std::max(1e-9, sum / time));
        for (Taken& t : there) t = t.at(stack, site.x, site.y);
        const double b = fitted_log_radiance(before, site, there, y, sigma, start);
        const double a = named ? fitted_log_radiance(after, site, there, y, sigma, b) : b;
        for (std::size_t k = 0; k < y.size(); ++k) {
          const std::size_t g = site.seen[k];
          const double f = before(std::exp(b), c, there[g]);
          const double change = std::abs((named ? after(std::exp(a), c, there[g]) : y[k]) - f);
          const std::size_t place = row * static_cast<std::size_t>(effects.width) + static_cast<std::size_t>(column);
          effects.effect[g][place] = std::max(effects.effect[g][place], static_cast<float>(change / sigma[k]));
          effects.share[g][place] = std::max(effects.share[g][place], static_cast<float>(change / rms[g]));
        }
      }
  });
  return effects;
}

void add_effects(const Stack& stack, const Effects& effects, const Explanation& e, const std::filesystem::path& out,
                 manifest::Document& document, Illustration& result) {
  if (e.verdict == Verdict::null) return;
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t g = 0; g < stack.images.size(); ++g) {
    double sum = 0;
    for (const float v : effects.share[g]) sum += double{v} * v;
    order.push_back({-sum, g});
    std::vector<std::uint8_t> counts(effects.effect[g].size());
    for (std::size_t i = 0; i < counts.size(); ++i)
      counts[i] = effects.effect[g][i] > beyond && effects.share[g][i] > e.smallest_effect;
    for (Box& box : boxes_of(counts, effects, stack.images[g].id)) result.boxes.push_back(box);
    if (out.empty()) continue;
    const io::Image picture = effect_picture(stack, effects, g);
    const std::string name = "effect-" + stack.images[g].id;
    io::write_picture(out / (name + ".exr"), picture);
    io::write_picture(out / (name + ".png"), picture);
    result.masks.push_back(manifest::add_file(document, out / (name + ".exr"), name));
  }
  std::sort(order.begin(), order.end());
  for (std::size_t k = 0; k < std::min(most_pictures, order.size()); ++k) {
    const std::size_t g = order[k].second;
    const std::string what = e.named.empty() ? ": residual of the base model over its noise"
                                             : ": what the named physics changes, over the noise";
    result.pictures.push_back({stack.images[g].id + what + ", half bright at three standard deviations",
                               io::encode_png(effect_picture(stack, effects, g)), ""});
  }
}

}  // namespace gonio::explain::stacks
