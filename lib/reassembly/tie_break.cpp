// See tie_break.h.
#include "reassembly/tie_break.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/text.h"
#include "geom/luminance.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/object.h"
#include "photograph/linear_picture.h"
#include "render/session.h"
#include "stats/intervals.h"

namespace gonio::reassembly {
namespace {

using manifest::Document;

// A picture as luminance, one value a pixel.
struct Grey {
  int width = 0, height = 0;
  std::vector<double> value;
};

Grey grey_of(const io::Image& image, int block) {
  const std::array<int, 3> c{image.channel("R"), image.channel("G"), image.channel("B")};
  Grey out{image.width / block, image.height / block, {}};
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      double sum = 0;
      for (int v = 0; v < block; ++v)
        for (int u = 0; u < block; ++u) {
          const int px = x * block + u, py = y * block + v;
          sum += c[0] < 0
                     ? image.at(px, py, 0)
                     : luminance_of<double>(image.at(px, py, c[0]), image.at(px, py, c[1]), image.at(px, py, c[2]));
        }
      out.value.push_back(sum / (block * block));
    }
  return out;
}

// The document with cameras of blocks of pixels, and only objects that stand somewhere.
Document reduced(const Document& document, int block) {
  Document small = document;
  for (auto& [name, camera] : small.cameras) {
    camera.width_px /= block, camera.height_px /= block;
    for (manifest::Parameter* focal : {&camera.fx_px, &camera.fy_px})
      if (focal->given()) focal->value[0] /= block;
    for (manifest::Parameter* middle : {&camera.cx_px, &camera.cy_px})
      if (middle->given()) middle->value[0] = (middle->value[0] + 0.5) / block - 0.5;
  }
  std::erase_if(small.objects, [](const manifest::Object& o) { return !o.world_from_object; });
  return small;
}

struct Shown {  // one view: the photograph and a rendering for each candidate
  Grey photograph;
  std::vector<Grey> rendering;
};

double exposure_of(const Shown& shown) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < shown.photograph.value.size(); ++i) {
    double mean = 0;
    for (const Grey& g : shown.rendering) mean += g.value[i] / static_cast<double>(shown.rendering.size());
    if (mean > 0 && shown.photograph.value[i] > 0) ratios.push_back(shown.photograph.value[i] / mean);
  }
  return ratios.empty() ? 1 : stats::median(ratios);
}

// For every tile that can tell: the error of each candidate.
void add_tiles(const Shown& shown, std::vector<std::vector<double>>& tiles) {
  constexpr int side = 4;
  constexpr double telling = 0.1;  // of log radiance between two renderings
  const double s = exposure_of(shown);
  double c = 0;
  for (const double v : shown.photograph.value) c += 0.05 * v / static_cast<double>(shown.photograph.value.size());
  if (!(c > 0)) return;
  const int width = shown.photograph.width;
  for (int y = 0; y + side <= shown.photograph.height; y += side)
    for (int x = 0; x + side <= width; x += side) {
      std::vector<double> error(shown.rendering.size(), 0);
      double spread = 0;
      for (int k = 0; k < side * side; ++k) {
        const auto i = static_cast<std::size_t>((y + k / side) * width + x + k % side);
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (std::size_t n = 0; n < error.size(); ++n) {
          const double f = std::log(s * std::max(0.0, shown.rendering[n].value[i]) + c);
          const double v = std::log(std::max(0.0, shown.photograph.value[i]) + c);
          error[n] += std::min(std::abs(v - f), 1.0) / (side * side);
          low = std::min(low, f), high = std::max(high, f);
        }
        spread += (high - low) / (side * side);
      }
      if (spread > telling) tiles.push_back(std::move(error));
    }
}

Tie judged(const std::vector<std::vector<double>>& tiles, std::size_t candidates, double sigmas) {
  constexpr std::size_t fewest = 8;
  if (tiles.size() < fewest)
    return {{}, format("photographs of the candidates would differ in %zu places only", tiles.size())};
  const auto n = static_cast<double>(tiles.size());
  std::vector<double> mean(candidates, 0);
  for (const auto& tile : tiles)
    for (std::size_t k = 0; k < candidates; ++k) mean[k] += tile[k] / n;
  const auto best = static_cast<std::size_t>(std::ranges::min_element(mean) - mean.begin());
  double least = HUGE_VAL;
  for (std::size_t k = 0; k < candidates; ++k) {
    if (k == best) continue;
    double squares = 0;
    for (const auto& tile : tiles) {
      const double d = tile[k] - tile[best] - (mean[k] - mean[best]);
      squares += d * d;
    }
    least = std::min(least, (mean[k] - mean[best]) / std::max(std::sqrt(squares / n / (n - 1)), 1e-12));
  }
  Tie tie{{},
          format("rendered, candidate %zu is nearest to the photographs: error %.3f, the next is %.1f standard errors "
                 "behind, over %zu tiles",
                 best + 1, mean[best], least, tiles.size())};
  if (least > sigmas)
    tie.meant = best;
  else
    tie.words += format(" (asked %.1f)", sigmas);
  return tie;
}

}  // namespace

Tie break_tie(const Document& document, const std::string& object, std::span<const Candidate> candidates,
              const TieWish& wish) {
  if (document.lights.empty()) return {{}, "the scene has no lights to render the candidates with"};
  int longest = 1;
  for (const auto& [name, camera] : document.cameras) longest = std::max({longest, camera.width_px, camera.height_px});
  const int block = std::max(1, longest / wish.longest_px);
  std::vector<std::vector<double>> tiles;
  std::vector<Shown> views(document.images.size());
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const manifest::ImageEntry& entry = document.images[i];
    const std::string at = manifest::place(document, "/images/" + std::to_string(i));
    views[i].photograph = grey_of(
        photograph::read_linear(manifest::picture_path(document, i), entry.response, at, entry.saturation).colour,
        block);
  }
  for (const Candidate& candidate : candidates) {
    Document posed = document;
    for (manifest::Object& o : posed.objects)
      if (o.id == object) {
        o.world_from_object.emplace();
        static_cast<Rigid<frame::World, frame::Object>&>(*o.world_from_object) = candidate.world_from_object;
      }
    posed = reduced(posed, block);
    render::SessionOptions options;
    options.seed = wish.seed, options.spp = wish.spp;
    options.geometry = false, options.allow_open = true, options.force = true;
    const render::Session session(posed, options, [](const std::filesystem::path&) {});
    for (std::size_t i = 0; i < views.size(); ++i) {
      const std::filesystem::path path = wish.folder / ("tie-" + file_stem(document.images[i].id) + ".exr");
      views[i].rendering.push_back(grey_of(session.render(i, path).picture, 1));
      render::Session::remove_checkpoint(path);
    }
  }
  for (const Shown& shown : views) add_tiles(shown, tiles);
  return judged(tiles, candidates.size(), wish.sigmas);
}

}  // namespace gonio::reassembly
