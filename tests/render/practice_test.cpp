// The renderer against an independent one: recordings/practice-1 was path traced by Blender's Cycles from a scene that
// the manifest describes in full, but for the two albedos and the lamps' intensity. Those are fitted here; then the
// means of 8 x 8 blocks must agree.
//
// Blocks count that lie, with a margin of one pixel, on one surface and wholly in light or wholly in shadow of the
// lamp. The albedo of a surface, per colour, is fitted to its lit blocks. In shadow only light from the other surface
// arrives, in proportion to the product of both albedos: with the lit blocks held in place, it falls as the intensity
// rises, which tells intensity and albedo apart.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "data.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "render/path_tracer.h"
#include "render/sensor_chain.h"
#include "scene/scene.h"

namespace gonio::tests {
namespace {

constexpr int side = 8, margin = 1;

struct Block {
  std::size_t surface = 0;
  bool lit = false;
  std::array<double, 3> recorded{}, rendered{}, variance{};  // means over the block; variance of their difference
};

class Practice {
 public:
  explicit Practice(const char* manifest)
      : document_(manifest::read_document(data(manifest))),
        scene_(scene::build_scene(document_)),
        caster_(scene_.instances) {
    for (std::size_t v = 0; v < scene_.views.size(); ++v)
      recorded_.push_back(io::read_picture(manifest::picture_path(document_, v)));
  }

  std::vector<Block> blocks(const std::vector<std::size_t>& views, int spp, std::uint64_t seed) const {
    std::vector<Block> all;
    for (const std::size_t v : views) {
      const io::Image picture =
          render::render(scene_, v, caster_, {.spp = spp, .seed = seed, .transport = {.max_bounces = 9}});
      const int visibility = picture.channel("visibility." + scene_.appearance.lights[scene_.views[v].lights.at(0)].id),
                id = picture.channel("id");
      for (int y = 0; y + side <= picture.height; y += side)
        for (int x = 0; x + side <= picture.width; x += side)
          if (uniform(picture, x, y, id) && uniform(picture, x, y, visibility)) {
            const double seen = picture.at(x, y, visibility);
            const int instance = static_cast<int>(picture.at(x, y, id)) - 1;
            if (instance < 0 || (seen != 0 && seen != 1)) continue;
            all.push_back(means(v, picture, x, y));
            all.back().surface = scene_.instances[instance].surface;
            all.back().lit = seen == 1;
          }
    }
    return all;
  }

  // One step of the fit described above.
  void fit(const std::vector<Block>& blocks) {
    std::array<double, 3> shadow{1, 1, 1};
    for (int c = 0; c < 3; ++c) shadow[c] = ratio(blocks, c, [](const Block& b) { return !b.lit; });
    const double step = 3 / (shadow[0] + shadow[1] + shadow[2]);
    for (std::size_t s = 0; s < scene_.appearance.surfaces.size(); ++s) {
      scene::Surface& surface = scene_.appearance.surfaces[s];
      Rgb albedo = surface.values.rgb(0);
      const auto update = [&](double& value, int c) {
        value =
            std::min(0.99, value * ratio(blocks, c, [s](const Block& b) { return b.lit && b.surface == s; }) / step);
      };
      update(albedo.x, 0);
      update(albedo.y, 1);
      update(albedo.z, 2);
      surface.parameters["albedo"] = std::vector<double>{albedo.x, albedo.y, albedo.z};
      scene::refresh(surface, "surfaces");
    }
    for (scene::Light& light : scene_.appearance.lights) {
      light.parameters["watt_per_sr"] = light.parameters.at("watt_per_sr").scalar() * step;
      scene::refresh(light, "lights");
    }
  }

 private:
  static bool uniform(const io::Image& picture, int x0, int y0, int channel) {
    for (int y = std::max(0, y0 - margin); y < std::min(picture.height, y0 + side + margin); ++y)
      for (int x = std::max(0, x0 - margin); x < std::min(picture.width, x0 + side + margin); ++x)
        if (picture.at(x, y, channel) != picture.at(x0, y0, channel)) return false;
    return true;
  }

  Block means(std::size_t view, const io::Image& picture, int x0, int y0) const {
    const manifest::Noise noise = render::sensor_of(document_, view).noise;
    Block block;
    constexpr double n = side * side;
    for (int c = 0; c < 3; ++c) {
      for (int y = y0; y < y0 + side; ++y)
        for (int x = x0; x < x0 + side; ++x) {
          const double value = picture.at(x, y, c), own = picture.at(x, y, picture.channel("variance.R") + c);
          block.recorded[c] += recorded_[view].at(x, y, c) / n;
          block.rendered[c] += value / n;
          block.variance[c] += (value / noise.gain + noise.read * noise.read + own) / (n * n);
        }
    }
    return block;
  }

  // Least squares, recorded = ratio * rendered.
  template <class Which>
  static double ratio(const std::vector<Block>& blocks, int c, const Which& which) {
    double across = 0, square = 0;
    for (const Block& b : blocks)
      if (which(b)) {
        across += b.recorded[c] * b.rendered[c] / b.variance[c];
        square += b.rendered[c] * b.rendered[c] / b.variance[c];
      }
    return across / square;
  }

  manifest::Document document_;
  scene::Scene scene_;
  render::RayCaster caster_;
  std::vector<io::Image> recorded_;
};

struct Difference {
  double rms = 0, noise = 0;  // relative to the rendering
  std::size_t count = 0;
  double beyond_noise() const { return std::sqrt(std::max(0.0, rms * rms - noise * noise)); }
};
template <class Which>
Difference difference(const std::vector<Block>& blocks, const Which& which) {
  Difference d;
  for (const Block& b : blocks)
    for (int c = 0; c < 3 && which(b); ++c, ++d.count) {
      d.rms += std::pow(b.recorded[c] / b.rendered[c] - 1, 2);
      d.noise += b.variance[c] / (b.rendered[c] * b.rendered[c]);
    }
  d.rms = std::sqrt(d.rms / static_cast<double>(d.count));
  d.noise = std::sqrt(d.noise / static_cast<double>(d.count));
  return d;
}

TEST(IndependentRenderer, BlockMeansAgreeWithinHalfAPercent) {
  GONIO_NEEDS_DATA("recordings/practice-1.json");
  Practice practice("recordings/practice-1.json");
  for (std::uint64_t step = 1; step <= 4; ++step) practice.fit(practice.blocks({0, 4, 8}, 16, step));
  const auto blocks = practice.blocks({0, 1, 2, 3, 4, 5, 6, 7, 8}, 32, 99);
  const auto lit = difference(blocks, [](const Block& b) { return b.lit; });
  RecordProperty("blocks", std::to_string(lit.count / 3));
  RecordProperty("relative_rms", std::to_string(lit.rms));
  RecordProperty("relative_noise", std::to_string(lit.noise));
  EXPECT_GT(lit.count, 6000u);
  EXPECT_LT(lit.beyond_noise(), 0.005);
  for (const std::size_t s : {0u, 1u}) {
    const auto one = difference(blocks, [s](const Block& b) { return b.lit && b.surface == s; });
    EXPECT_GT(one.count, 100u);
    EXPECT_LT(one.beyond_noise(), 0.005) << "surface " << s << ": rms " << one.rms << ", noise " << one.noise;
  }
  // In shadow light comes by rare paths, whose noise has long tails: the median.
  std::vector<double> ratios;
  for (const Block& b : blocks)
    if (!b.lit)
      ratios.push_back(mean({b.recorded[0], b.recorded[1], b.recorded[2]}) /
                       mean({b.rendered[0], b.rendered[1], b.rendered[2]}));
  ASSERT_GT(ratios.size(), 20u);
  std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
  EXPECT_NEAR(ratios[ratios.size() / 2], 1, 0.05);
}

}  // namespace
}  // namespace gonio::tests
