#include "explain/images/images_problem.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "base/error.h"
#include "explain/images/conditions.h"
#include "explain/images/derivatives.h"
#include "explain/images/misplaced.h"
#include "explain/images/misread.h"
#include "inference/explanation.h"
#include "manifest/document.h"
#include "relighting/repeats.h"
#include "relighting/sampled_pixels.h"
#include "relighting/shifted_views.h"
#include "relighting/textures.h"
#include "relighting/uses.h"
#include "scene/mechanisms.h"
#include "scene/scene.h"

namespace gonio::explain::images {
namespace {

constexpr std::size_t most_lamps_with_shadows = 12;  // that follow them: more are surroundings, or light stages
// Of the places where a texture changes: they tell where things are seen, and little of light.
constexpr double uneven_share = 0.25;
constexpr double place_error_px = 0.1;  // of what is seen, between two renderers or a fitted pose and the true one

std::size_t at(const io::Image& picture, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x);
}

}  // namespace

ImagesProblem::ImagesProblem(const manifest::Document& document, const Options& options)
    : document_(std::make_unique<manifest::Document>(document)),
      recordings_(read_recordings(document)),
      cache_options_(options.cache) {
  if (recordings_.images.empty())
    throw Error(Exit::data, manifest::place(document, "/images"), "holds no recording",
                "give at least one image with a weight");
  measure_noise(options.repeats, document, recordings_);
  scene_ = std::make_unique<scene::Scene>(scene::build_scene(document));
  const scene::Scene& scene = *scene_;
  caster_ = std::make_unique<render::RayCaster>(scene.instances);
  std::vector<std::string> surfaces;
  for (const scene::Surface& surface : scene.appearance.surfaces) surfaces.push_back(surface.id);
  layout_ = read_scene(document, recordings_, surfaces, scene.centre_m);
  settle_textures(scene, layout_);
  monomials_ = std::make_unique<render::Monomials>(surfaces.size(), degree_for(surfaces.size()));
  const Tints tints(scene);
  std::vector<ViewCache> caches;
  cache_options_.shadows = layout_.lights.size() <= most_lamps_with_shadows;
  for (std::size_t v = 0; v < recordings_.views.size(); ++v) {
    caches.push_back(build_cache(*caster_, recordings_.views[v], layout_.lights, *monomials_,
                                 in_cells(v, pixels_of(v, options.pixels)), cache_options_));
    tints.apply(*caster_, recordings_.views[v], caches.back());
  }
  model_ = std::make_unique<ImageModel>(recordings_, layout_, *monomials_, std::move(caches));
  bind(document);
  fill_rows();
  numbers_act_on_cells();
  misplaced_ = misplaced_files(recordings_, *model_, picked_);
  if (misplaced_.files.empty()) misplaced_ = misread(*scene_, *model_);
  if (!misplaced_.files.empty()) candidates_.clear();  // no physics is fitted to pictures of something else
}

void ImagesProblem::bind(const manifest::Document& document) {
  const Setting setting{document, *scene_, *caster_, recordings_, layout_, *model_, nullptr, &shared_};
  const auto prepared = [&](std::vector<Use> uses) {
    for (Use& use : uses)
      if (use.term->prepare) use.prepared = use.term->prepare(setting, use);
    return uses;
  };
  model_->add_uses(prepared(given_uses(setting)), true);
  const std::size_t given = model_->uses().size();
  std::vector<Use> asked = candidate_uses(setting);
  // What the fast model can do to a surface and a scene cannot would end the run where it wins.
  std::erase_if(asked, [&](const Use& use) {
    if (use.mechanism->target != mechanism::Target::surface || scene::beyond_rendering(*use.mechanism)) return false;
    const std::vector<std::string> able = scene::mechanism_targets(scene_->appearance, *use.mechanism);
    return !std::ranges::all_of(use.on, [&](const std::string& name) { return std::ranges::count(able, name) > 0; });
  });
  model_->add_uses(prepared(std::move(asked)), false);
  layout_.start = model_->layout().start;
  bindings_ = bind_parameters(document, recordings_, layout_, model_->uses(), given);
  parameters_ = bindings_.parameters;
  base_ = bindings_.base;
  candidates_ = bindings_.candidates;
  find_exclusions();
}

void ImagesProblem::find_exclusions() {
  const auto of_surfaces = [](const Candidate& c) { return c.mechanism->target == mechanism::Target::surface; };
  std::map<std::tuple<std::size_t, std::string, std::string>, bool> known;  // surface, two mechanisms
  for (std::size_t a = 0; a < candidates_.size(); ++a)
    for (std::size_t b = a + 1; b < candidates_.size(); ++b) {
      const Candidate &one = candidates_[a], &other = candidates_[b];
      if (!of_surfaces(one) || !of_surfaces(other) || one.id() == other.id()) continue;
      for (std::size_t s = 0; s < scene_->appearance.surfaces.size(); ++s) {
        const scene::Surface& surface = scene_->appearance.surfaces[s];
        const auto on_it = [&](const Candidate& c) { return std::ranges::count(c.on, surface.id) > 0; };
        if (!on_it(one) || !on_it(other)) continue;
        const auto [place, fresh] = known.try_emplace({s, one.id(), other.id()});
        if (fresh) place->second = scene::go_together(surface, *one.mechanism, *other.mechanism);
        if (!place->second) exclusions_.insert({a, b});
      }
    }
}

bool ImagesProblem::excludes(std::size_t candidate, std::size_t other) const {
  return exclusions_.contains({std::min(candidate, other), std::max(candidate, other)});
}

ImagesProblem::~ImagesProblem() = default;

std::vector<std::array<int, 2>> ImagesProblem::pixels_of(std::size_t view, std::size_t pixels) const {
  const auto per_image = static_cast<double>(std::max<std::size_t>(200, pixels / recordings_.images.size()));
  return choose_pixels(
      recordings_, view, counted_pixels(recordings_, view), per_image, [&](std::array<int, 2> at, Random& random) {
        return is_even(*scene_, *caster_, recordings_.views[view], at[0], at[1]) || random.uniform() < uneven_share;
      });
}

void ImagesProblem::fill_rows() {
  Observations& o = observations_;
  o.first.push_back(0);
  std::uint32_t blocks = 0;
  std::vector<double> prediction;
  std::array<std::vector<double>, 2> across;  // along x and y, for a pixel
  for (std::size_t g = 0; g < recordings_.images.size(); ++g) {
    const Recording& image = recordings_.images[g];
    const ViewCache& cache = model_->cache(image.view);
    std::map<std::array<int, 3>, std::uint32_t> tiles;  // of a cell
    std::vector<std::uint32_t>& mine = picked_.emplace_back();
    for (std::uint32_t p = 0; p < cache.pixels.size(); ++p)
      if (image.counts[at(image.picture, cache.pixels[p].x, cache.pixels[p].y)] &&
          !shows_glass(cache, cache.pixels[p], layout_.start))
        mine.push_back(p);
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
    const SceneState now = model_->edited(layout_.start, g);
    std::vector<double> slopes = shared_.places ? slopes_across(shared_, {g, image, cache, mine, now, *model_})
                                                : std::vector<double>(6 * mine.size(), 0.0);
    double scale[3];
    for (std::size_t k = 0; k < 3; ++k) scale[k] = ff[k] > 0 ? yf[k] / ff[k] : 1;
    for (std::size_t i = 0; i < slopes.size(); ++i) slopes[i] *= scale[i % 3];
    for (std::size_t i = 0; i < mine.size(); ++i) {
      const Pixel& pixel = cache.pixels[mine[i]];
      const int cell = cell_of_.empty() ? 0 : static_cast<int>(cell_of_[image.view][mine[i]]);
      const auto [tile, fresh] = tiles.try_emplace({pixel.x / tile_px, pixel.y / tile_px, cell}, blocks);
      if (fresh) ++blocks;
      const Rgb mean = local_mean(image, pixel.x, pixel.y);
      for (std::size_t k = 0; k < 3; ++k) {
        const double y = image.picture.at(pixel.x, pixel.y, static_cast<int>(k));
        const double grey = image.grey ? std::sqrt(3.0) : 1,
                     noise = grey *
                             noise_sigma(image, mean[static_cast<int>(k)], 3 * at(image.picture, pixel.x, pixel.y) + k);
        o.value.push_back(y);
        o.sigma.push_back(std::sqrt(noise * noise + scale[k] * scale[k] * own[3 * i + k]));
        o.norm.push_back(y * y);
        o.block.push_back(tile->second);
        prediction.push_back(scale[k] * start[3 * i + k]);
        for (std::size_t a = 0; a < 2; ++a) across[a].push_back(slopes[6 * i + 3 * a + k]);
        o.place_error.push_back(place_error_px * std::hypot(across[0].back(), across[1].back()));
      }
    }
    if (shared_.edges) shared_.edges->of_image[g] = std::move(slopes);
    open_groups(g);
  }
  o.conditions = image_conditions(*model_, picked_, prediction, across);
}

SceneState ImagesProblem::raw_state(std::span<const double> values) const {
  SceneState s = layout_.start;
  bindings_.set(s, values);
  return s;
}

SceneState ImagesProblem::state(std::span<const double> values, std::size_t image) const {
  return model_->edited(raw_state(values), image);
}

void ImagesProblem::predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const {
  const Group& g = groups_[group];
  if (g.whole) return model_->predict(raw_state(values), g.image, picked_[g.image], prediction);
  const auto all = whole_predictions_.of(values, {}, g.image, [&] {
    std::vector<double> made(3 * picked_[g.image].size());
    model_->predict(raw_state(values), g.image, picked_[g.image], made);
    return made;
  });
  std::copy_n(all->begin() + static_cast<std::ptrdiff_t>(g.first), g.end - g.first, prediction.begin());
}

namespace {

// The use that knows the slopes of what this number adds.
const Use* sloped(const std::vector<Place>& places, const std::vector<Use>& uses) {
  if (places.size() != 1 || places[0].kind != Place::Kind::amount) return nullptr;
  const Use& use = uses[places[0].target];
  return use.term->slopes ? &use : nullptr;
}

bool acts_on(const Parameter& p, std::size_t group) {
  return p.groups.empty() || std::binary_search(p.groups.begin(), p.groups.end(), group);
}

}  // namespace

void ImagesProblem::jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                             std::span<double> derivatives) const {
  const Group& g = groups_[group];
  if (g.whole) return slopes_of_image(values, group, columns, derivatives);
  const std::size_t all_rows = 3 * picked_[g.image].size(), rows = g.end - g.first;
  const auto all = whole_slopes_.of(values, columns, g.image, [&] {
    std::vector<double> made(all_rows * columns.size());
    slopes_of_image(values, group, columns, made);
    return made;
  });
  for (std::size_t k = 0; k < columns.size(); ++k)
    std::copy_n(all->begin() + static_cast<std::ptrdiff_t>(k * all_rows + g.first), rows,
                derivatives.begin() + static_cast<std::ptrdiff_t>(k * rows));
}

// Of all rows of the group's image.
void ImagesProblem::slopes_of_image(std::span<const double> values, std::size_t group,
                                    std::span<const std::size_t> columns, std::span<double> derivatives) const {
  const std::size_t image = groups_[group].image, rows = 3 * picked_[image].size();
  const Derivatives near(*model_, raw_state(values), image, picked_[image]);
  std::vector<double> above(rows), below(rows);
  std::size_t filled = 0;  // columns before this one
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (k < filled) continue;
    const Parameter& p = parameters_[columns[k]];
    const std::span<double> column = derivatives.subspan(k * rows, rows);
    if (!acts_on(p, group)) {
      std::fill(column.begin(), column.end(), 0.0);
      continue;
    }
    const std::vector<Place>& places = bindings_.places[columns[k]];
    if (const Use* use = sloped(places, model_->uses())) {
      std::vector<std::size_t> numbers;  // of this use, as long as they follow each other: one scene serves them all
      for (filled = k; filled < columns.size() && acts_on(parameters_[columns[filled]], group); ++filled) {
        const std::vector<Place>& next = bindings_.places[columns[filled]];
        if (sloped(next, model_->uses()) != use) break;
        numbers.push_back(next[0].parameter);
      }
      near.slopes(*use, numbers, derivatives.subspan(k * rows, numbers.size() * rows));
      continue;
    }
    const Touched touched = touched_by(places, near.centre(), model_->uses());
    const double value = values[columns[k]], step = 1e-4 * p.size;
    const double upper = std::min(value + step, std::max(p.upper, value));
    const double lower = std::max(value - step, std::min(p.lower, value));
    SceneState there = near.centre();
    for (const Place& place : places) set_value(there, place, upper);
    near.at(there, touched, above);
    for (const Place& place : places) set_value(there, place, lower);
    near.at(there, touched, below);
    const double scale = upper > lower ? 1 / (upper - lower) : 0;
    for (std::size_t i = 0; i < rows; ++i) column[i] = (above[i] - below[i]) * scale;
  }
}

void ImagesProblem::conclude(Explanation& explanation) const {
  if (misplaced_.files.empty()) return;
  explanation.misplaced = misplaced_;
  explanation.verdict = Verdict::unknown;
  explanation.important = true;
  explanation.stage = "recording";
  explanation.converged = true, explanation.outlier_blocks = 0;  // how well physics fits is not asked
  explanation.outside.reset();
  explanation.plan.clear();
}

// A fit to files in the wrong places says nothing about the scene: it stays as it was given.
void ImagesProblem::apply(const Explanation& explanation, manifest::Document& document) const {
  if (!misplaced_.files.empty()) return;
  write_back(bindings_, model_->uses(), explanation, document);
}

}  // namespace gonio::explain::images
