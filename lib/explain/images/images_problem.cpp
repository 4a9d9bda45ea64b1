#include "explain/images/images_problem.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/random.h"
#include "explain/explanation.h"
#include "explain/images/conditions.h"
#include "scene/scene.h"

namespace gonio::explain::images {
namespace {

constexpr int tile_px = 8;
constexpr std::uint64_t pixel_seed = 20;

std::size_t at(const io::Image& picture, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x);
}

// Highest degree of the polynomials of light between surfaces: six, or fewer where many surfaces would make too many
// terms.
int degree_for(std::size_t surfaces) {
  constexpr std::size_t most_terms = 40;
  int degree = 6;
  while (degree > 1 && render::Monomials(surfaces, degree).size() > most_terms) --degree;
  return degree;
}

// Mean of the counted pixels of a 5 x 5 window: a brightness that the pixel's own noise hardly moves.
Rgb local_mean(const Recording& image, int x, int y) {
  Rgb sum;
  double n = 0;
  for (int v = std::max(0, y - 2); v <= std::min(image.picture.height - 1, y + 2); ++v)
    for (int u = std::max(0, x - 2); u <= std::min(image.picture.width - 1, x + 2); ++u) {
      if (!image.counts[at(image.picture, u, v)]) continue;
      sum += Rgb{image.picture.at(u, v, 0), image.picture.at(u, v, 1), image.picture.at(u, v, 2)};
      n += 1;
    }
  return n > 0 ? sum / n : sum;
}

}  // namespace

ImagesProblem::ImagesProblem(const manifest::Document& document, const Options& options)
    : recordings_(read_recordings(document)), cache_options_(options.cache) {
  if (recordings_.images.empty())
    throw Error(Exit::data, manifest::place(document, "/images"), "holds no recording",
                "give at least one image with a weight");
  const scene::Scene scene = scene::build_scene(document);
  caster_ = std::make_unique<render::RayCaster>(scene.instances);
  std::vector<std::string> surfaces;
  for (const scene::Surface& surface : scene.appearance.surfaces) surfaces.push_back(surface.id);
  layout_ = read_scene(document, recordings_, surfaces, scene.centre_m);
  monomials_ = std::make_unique<render::Monomials>(surfaces.size(), degree_for(surfaces.size()));
  bindings_ = bind_parameters(document, recordings_, layout_);
  parameters_ = bindings_.parameters;
  base_ = bindings_.base;
  candidates_ = bindings_.candidates;
  std::vector<std::vector<std::array<int, 2>>> chosen(recordings_.views.size());
  choose_pixels(options.pixels, chosen);
  std::vector<ViewCache> caches;
  for (std::size_t v = 0; v < chosen.size(); ++v)
    caches.push_back(
        build_cache(*caster_, recordings_.views[v], layout_.lights, *monomials_, chosen[v], cache_options_));
  model_ = std::make_unique<ImageModel>(recordings_, layout_, *monomials_, std::move(caches));
  fill_rows();
}

ImagesProblem::~ImagesProblem() = default;

void ImagesProblem::choose_pixels(std::size_t pixels, std::vector<std::vector<std::array<int, 2>>>& chosen) const {
  const std::size_t per_image = std::max<std::size_t>(200, pixels / recordings_.images.size());
  for (std::size_t v = 0; v < chosen.size(); ++v) {
    const int width = recordings_.views[v].model.width_px(), height = recordings_.views[v].model.height_px();
    std::vector<std::uint8_t> any(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (const Recording& image : recordings_.images)
      if (image.view == v)
        for (std::size_t i = 0; i < any.size(); ++i) any[i] = any[i] | image.counts[i];
    const auto counted = static_cast<double>(std::count(any.begin(), any.end(), 1));
    const double share = std::min(1.0, static_cast<double>(per_image) / std::max(1.0, counted));
    for (int top = 0; top < height; top += tile_px)
      for (int left = 0; left < width; left += tile_px) {
        std::vector<std::array<int, 2>> tile;
        for (int y = top; y < std::min(height, top + tile_px); ++y)
          for (int x = left; x < std::min(width, left + tile_px); ++x)
            if (any[static_cast<std::size_t>(y * width + x)]) tile.push_back({x, y});
        Random random(pixel_seed, static_cast<std::uint64_t>(v) << 40 | static_cast<std::uint64_t>(top) << 20 |
                                      static_cast<std::uint64_t>(left));
        // share of the tile, rounded up or down at random so that the mean is exact
        const auto take = static_cast<std::size_t>(share * static_cast<double>(tile.size()) + random.uniform());
        for (std::size_t k = 0; k < std::min(take, tile.size()); ++k) {
          const std::size_t other = k + random.below(static_cast<std::uint32_t>(tile.size() - k));
          std::swap(tile[k], tile[other]);
          chosen[v].push_back(tile[k]);
        }
      }
  }
}

void ImagesProblem::fill_rows() {
  Observations& o = observations_;
  o.first.push_back(0);
  std::uint32_t blocks = 0;
  std::vector<double> prediction;
  for (std::size_t g = 0; g < recordings_.images.size(); ++g) {
    const Recording& image = recordings_.images[g];
    const ViewCache& cache = model_->cache(image.view);
    std::map<std::pair<int, int>, std::uint32_t> tiles;
    std::vector<std::uint32_t> mine;
    for (std::uint32_t p = 0; p < cache.pixels.size(); ++p)
      if (image.counts[at(image.picture, cache.pixels[p].x, cache.pixels[p].y)]) mine.push_back(p);
    std::vector<double> start(3 * mine.size()), own(3 * mine.size());
    model_->predict(layout_.start, g, mine, start);
    model_->variance(layout_.start, g, mine, own);
    double yf[3] = {0, 0, 0}, ff[3] = {0, 0, 0};  // the recording's brightness over the start's, per channel
    for (std::size_t i = 0; i < mine.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const Pixel& pixel = cache.pixels[mine[i]];
        yf[k] += image.picture.at(pixel.x, pixel.y, static_cast<int>(k)) * start[3 * i + k];
        ff[k] += start[3 * i + k] * start[3 * i + k];
      }
    for (std::size_t i = 0; i < mine.size(); ++i) {
      const Pixel& pixel = cache.pixels[mine[i]];
      const auto [tile, fresh] = tiles.try_emplace({pixel.x / tile_px, pixel.y / tile_px}, blocks);
      if (fresh) ++blocks;
      const Rgb mean = local_mean(image, pixel.x, pixel.y);
      for (std::size_t k = 0; k < 3; ++k) {
        const double y = image.picture.at(pixel.x, pixel.y, static_cast<int>(k));
        const double scale = ff[k] > 0 ? yf[k] / ff[k] : 1, noise = noise_sigma(image, mean[static_cast<int>(k)]);
        o.value.push_back(y);
        o.sigma.push_back(std::sqrt(noise * noise + scale * scale * own[3 * i + k]));
        o.norm.push_back(y * y);
        o.block.push_back(tile->second);
        prediction.push_back(scale * start[3 * i + k]);
      }
    }
    o.first.push_back(o.value.size());
    o.group.push_back(image.id);
    picked_.push_back(std::move(mine));
  }
  o.conditions = image_conditions(recordings_, *model_, picked_, prediction);
}

SceneState ImagesProblem::state(std::span<const double> values) const {
  SceneState s = layout_.start;
  bindings_.set(s, values);
  return s;
}

void ImagesProblem::predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const {
  model_->predict(state(values), group, picked_[group], prediction);
}

namespace {

// What of an image's direct light depends on a parameter.
struct Reach {
  bool all = false;
  std::vector<std::uint32_t> surfaces;
};
Reach reach_of(const std::vector<Place>& places, const SceneState& state) {
  Reach reach;
  for (const Place& p : places) {
    if (p.kind == Place::Kind::radius || p.kind == Place::Kind::tilt_x || p.kind == Place::Kind::tilt_y)
      reach.all = true;
    if (p.kind != Place::Kind::surface) continue;
    const surface::Model& model = *state.surfaces[p.target].model;
    if (!has_parameter(model, "albedo") || p.parameter != parameter_index(model, "albedo"))
      reach.surfaces.push_back(static_cast<std::uint32_t>(p.target));
  }
  return reach;
}

}  // namespace

void ImagesProblem::jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                             std::span<double> derivatives) const {
  const std::vector<std::uint32_t>& picked = picked_[group];
  const std::size_t rows = 3 * picked.size();
  const SceneState centre = state(values);
  const Shading shading = model_->shade(centre, group, picked);
  std::vector<double> above(rows), below(rows);
  const auto moved = [&](std::size_t column, const Reach& reach, double value, std::vector<double>& out) {
    SceneState there = centre;
    for (const Place& place : bindings_.places[column]) set_value(there, place, value);
    if (reach.all) return model_->predict(there, group, picked, out);
    if (reach.surfaces.empty()) return model_->compose(there, group, picked, shading, out);
    Shading changed = shading;
    for (const std::uint32_t s : reach.surfaces) model_->shade_again(there, group, picked, s, changed);
    model_->compose(there, group, picked, changed, out);
  };
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Parameter& p = parameters_[columns[k]];
    const Reach reach = reach_of(bindings_.places[columns[k]], centre);
    const double value = values[columns[k]], step = 1e-4 * p.size;
    const double upper = std::min(value + step, std::max(p.upper, value));
    const double lower = std::max(value - step, std::min(p.lower, value));
    moved(columns[k], reach, upper, above);
    moved(columns[k], reach, lower, below);
    const double scale = upper > lower ? 1 / (upper - lower) : 0;
    for (std::size_t i = 0; i < rows; ++i) derivatives[k * rows + i] = (above[i] - below[i]) * scale;
  }
}

void ImagesProblem::apply(const Explanation& explanation, manifest::Document& document) const {
  write_back(bindings_, explanation, document);
}

}  // namespace gonio::explain::images
