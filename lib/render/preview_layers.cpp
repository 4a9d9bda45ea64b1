// What the layers of a rendering look like: which channels, which colours, which scale.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "geom/vector.h"
#include "render/preview.h"
#include "report/colour_map.h"

namespace gonio::render {
namespace {

constexpr double percentile = 0.99;

class Layers {
 public:
  explicit Layers(const io::Image& rendering) : from_(rendering) {}

  bool holds(const std::string& channel) const { return from_.channel(channel) >= 0; }
  std::vector<double> mean_of_colours(const std::string& layer) const {
    const auto r = values(layer + ".R"), g = values(layer + ".G"), b = values(layer + ".B");
    std::vector<double> mean(from_.pixels());
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = (r[i] + g[i] + b[i]) / 3;
    return mean;
  }
  std::vector<double> values(const std::string& channel) const {
    const auto c = static_cast<std::size_t>(from_.channel(channel));
    std::vector<double> out(from_.pixels());
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = static_cast<double>(from_.data[i * from_.channels.size() + c]);
    return out;
  }
  template <class ColourOf>
  LayerPreview paint(const std::string& layer, const ColourOf& colour_of) const {
    LayerPreview out{layer, io::Image(from_.width, from_.height, {"R", "G", "B"})};
    for (std::size_t i = 0; i < from_.pixels(); ++i) {
      const report::Colour colour = colour_of(i);
      std::ranges::copy(colour, out.picture.data.begin() + static_cast<std::ptrdiff_t>(3 * i));
    }
    return out;
  }

 private:
  const io::Image& from_;
};

void add_stokes(const Layers& layers, std::vector<LayerPreview>& out) {
  const std::array<std::string, 3> names{"s1", "s2", "s3"};
  if (!layers.holds("s1.R")) return;
  std::array<std::vector<double>, 3> planes;
  std::vector<double> sizes;
  for (std::size_t k = 0; k < 3; ++k) {
    planes[k] = layers.mean_of_colours(names[k]);
    for (const double v : planes[k])
      if (std::isfinite(v)) sizes.push_back(std::abs(v));
  }
  double most = 0;
  if (!sizes.empty()) {
    const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(percentile * static_cast<double>(sizes.size() - 1));
    std::nth_element(sizes.begin(), at, sizes.end());
    most = *at;
  }
  for (std::size_t k = 0; k < 3; ++k)
    out.push_back(layers.paint(
        names[k], [&](std::size_t i) { return report::signed_colour(most > 0 ? planes[k][i] / most : 0); }));
}

void add_depth(const Layers& layers, std::vector<LayerPreview>& out) {
  if (!layers.holds("depth.Z")) return;
  const auto depth = layers.values("depth.Z");
  const auto met = [&](std::size_t i) { return std::isfinite(depth[i]) && depth[i] > 0; };
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (met(i)) {
      nearest = std::min(nearest, depth[i]);
      farthest = std::max(farthest, depth[i]);
    }
  const double range = farthest > nearest ? farthest - nearest : 1;
  out.push_back(layers.paint("depth", [&](std::size_t i) {
    return met(i) ? report::magnitude_colour((depth[i] - nearest) / range) : report::Colour{};
  }));
}

void add_normals(const Layers& layers, const std::string& channel, const std::string& name,
                 std::vector<LayerPreview>& out) {
  if (!layers.holds(channel + ".X")) return;
  const auto x = layers.values(channel + ".X"), y = layers.values(channel + ".Y"), z = layers.values(channel + ".Z");
  out.push_back(layers.paint(name, [&](std::size_t i) {
    const Vec3 n{x[i], y[i], z[i]};
    if (!(norm(n) > 0)) return report::Colour{};
    const auto code = [](double v) { return static_cast<float>(std::clamp(0.5 + 0.5 * v, 0.0, 1.0)); };
    return report::Colour{code(n.x), code(n.y), code(n.z)};
  }));
}

}  // namespace

std::vector<LayerPreview> layer_previews(const io::Image& rendering) {
  const Layers layers(rendering);
  std::vector<LayerPreview> out;
  add_stokes(layers, out);
  add_depth(layers, out);
  add_normals(layers, "normal", "normal", out);
  add_normals(layers, "back_normal", "back-normal", out);
  return out;
}

}  // namespace gonio::render
