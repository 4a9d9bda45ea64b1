#include "relighting/image_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "relighting/image_memo.h"
#include "relighting/relayed.h"
#include "relighting/uses.h"
#include "scene/scene.h"

namespace gonio::relighting {
namespace {

constexpr std::size_t radius_count = radii_m.size();

Rgb albedo_of(const SurfaceState& surface) {
  return has_parameter(*surface.model, "albedo") ? surface.values.rgb(parameter_index(*surface.model, "albedo"))
                                                 : Rgb{};
}

std::vector<Rgb> albedos_of(const SceneState& state) {
  std::vector<Rgb> albedos;
  for (const SurfaceState& s : state.surfaces) albedos.push_back(albedo_of(s));
  return albedos;
}

// What a facet sends on of the light that reaches it by way of others, over its share of the pixel. `onward`: what is
// left of each lamp's; empty: all.
Rgb sent_on(const Relayed& light, std::size_t slot, std::span<const Rgb> emission, std::span<const double> onward,
            Rgb albedo, const Scattered& scattered) {
  const std::size_t first = slot * light.sources;
  const bool glossy = max_component(scattered.gloss) > 0;
  Rgb irradiance, mirrored;
  for (std::size_t j = 0; j < light.sources; ++j) {
    const Rgb sent = j < onward.size() ? emission[j] * onward[j] : emission[j];
    irradiance += light.irradiance[first + j] * sent;
    if (glossy) mirrored += light.mirrored[first + j] * sent;
  }
  return (albedo * irradiance * scattered.base + scattered.gloss * mirrored) / pi;
}

std::span<const double> onward_at(const std::vector<double>& onward, std::size_t slot, std::size_t lights) {
  return onward.empty() ? std::span<const double>{} : std::span(onward).subspan(slot * lights, lights);
}

bool any_gloss(const Shading& shading) {
  return std::ranges::any_of(shading.indirect, [](const Scattered& s) { return max_component(s.gloss) > 0; });
}

}  // namespace

// Fits change what does not reach the shading (albedos, intensities, gains, the camera's chain) far more often than
// what does, and albedos in the columns of a few numbers alone.
struct ImageModel::Memos {
  explicit Memos(std::size_t images) : shaded(images), relayed(images) {}
  ImageMemo<Shaded> shaded;
  ImageMemo<Relayed> relayed;
};

ImageModel::ImageModel(const Recordings& recordings, const SceneLayout& layout, const render::Monomials& monomials,
                       std::vector<ViewCache> views)
    : recordings_(recordings),
      layout_(layout),
      monomials_(monomials),
      views_(std::move(views)),
      memos_(std::make_unique<Memos>(recordings.images.size())) {
  for (const ViewCache& cache : views_) sums_.push_back(facet_sums(cache));
}

ImageModel::~ImageModel() = default;

Shader ImageModel::shader(std::size_t image) const {
  const Recording& recording = recordings_.images[image];
  return Shader(layout_, recording, views_[recording.view], sums_[recording.view]);
}

void ImageModel::add_uses(std::vector<Use> uses, bool in_play) {
  for (Use& use : uses) {
    use.place = uses_.size();
    use.in_play = in_play;
    std::vector<double> amounts;
    for (const Number& n : use.numbers) amounts.push_back(in_play || !n.free ? n.start : n.neutral);
    layout_.start.amounts.push_back(std::move(amounts));
    ordered_.push_back(use.place);
    uses_.push_back(std::move(use));
  }
  memos_ = std::make_unique<Memos>(recordings_.images.size());  // terms may be others now
  std::stable_sort(ordered_.begin(), ordered_.end(),
                   [&](std::size_t a, std::size_t b) { return uses_[a].term->order < uses_[b].term->order; });
}

void ImageModel::take_uses(const ImageModel& other, std::vector<Use> uses) {
  uses_ = std::move(uses);
  ordered_ = other.ordered_;
  layout_.start = other.layout_.start;
  memos_ = std::make_unique<Memos>(recordings_.images.size());
}

SceneState ImageModel::edited(const SceneState& state, std::size_t image) const {
  SceneState result = state;
  for (const Use& use : uses_)
    if (use.term->edit && !use.neutral(state)) use.term->edit(use, image, layout_, recordings_, result);
  return result;
}

template <class Hook>
void ImageModel::run_hooks(const SceneState& edited, std::size_t number, std::span<const std::uint32_t> picked,
                           const Hook& hook) const {
  const Recording& image = recordings_.images[number];
  const Frame frame{number, image, views_[image.view], picked, edited, *this};
  for (const std::size_t u : ordered_)
    if (!uses_[u].neutral(edited)) hook(uses_[u], frame);
}

void ImageModel::shade_terms(const SceneState& edited, std::size_t image, std::span<const std::uint32_t> picked,
                             Shading& shading) const {
  run_hooks(edited, image, picked, [&](const Use& use, const Frame& frame) {
    if (use.term->shade) use.term->shade(use, frame, shading);
  });
}

void ImageModel::add_terms(const SceneState& edited, std::size_t image, std::span<const std::uint32_t> picked,
                           std::span<double> radiance) const {
  run_hooks(edited, image, picked, [&](const Use& use, const Frame& frame) {
    if (use.term->add) use.term->add(use, frame, radiance);
  });
}

void ImageModel::record_terms(const SceneState& edited, std::size_t image, std::span<const std::uint32_t> picked,
                              std::span<double> values) const {
  run_hooks(edited, image, picked, [&](const Use& use, const Frame& frame) {
    if (use.term->record) use.term->record(use, frame, values);
  });
}

void ImageModel::predict(const SceneState& state, std::size_t image, std::span<const std::uint32_t> picked,
                         std::span<double> radiance) const {
  const SceneState now = edited(state, image);
  compose(now, image, picked, shaded(now, image, picked)->whole(), radiance);
  add_terms(now, image, picked, radiance);
  record_terms(now, image, picked, radiance);
}

std::shared_ptr<const Shaded> ImageModel::shaded(const SceneState& now, std::size_t image,
                                                 std::span<const std::uint32_t> picked) const {
  std::vector<double> key = shading_key(now, uses_);
  if (auto known = memos_->shaded.find(image, key, picked)) return known;
  auto shaded = std::make_shared<Shaded>(Shaded{shade(now, image, picked), {}});
  const auto shades = [&](const Use& use) { return use.term->shade != nullptr && !use.neutral(now); };
  if (std::ranges::any_of(uses_, shades)) {
    shaded->changed = shaded->plain;
    shade_terms(now, image, picked, *shaded->changed);
  }
  memos_->shaded.keep(image, std::move(key), picked, shaded);
  return shaded;
}

void ImageModel::predict_from(const ViewCache& cache, std::span<const float> sums, const SceneState& edited,
                              std::size_t image, std::span<const std::uint32_t> picked,
                              std::span<double> radiance) const {
  const Recording& recording = recordings_.images[image];
  const Shading shading = Shader(layout_, recording, cache, sums)(edited, picked);
  const Relayed light = relayed(cache, Transport(edited, monomials_), sources_of(edited, recording),
                                layout_.lights.size(), any_gloss(shading), picked);
  compose_from(cache, light, edited, image, picked, shading, radiance);
}

Shading ImageModel::shade(const SceneState& state, std::size_t image, std::span<const std::uint32_t> picked) const {
  return shader(image)(state, picked);
}

void ImageModel::shade_again(const SceneState& state, std::size_t image, std::span<const std::uint32_t> picked,
                             std::uint32_t surface, Shading& shading) const {
  shader(image).again(state, picked, surface, shading);
}

void ImageModel::compose(const SceneState& state, std::size_t number, std::span<const std::uint32_t> picked,
                         const Shading& shading, std::span<double> radiance) const {
  const std::size_t view = recordings_.images[number].view;
  compose_from(views_[view], *light_at(state, number, picked, any_gloss(shading)), state, number, picked, shading,
               radiance);
}

std::shared_ptr<const Relayed> ImageModel::light_at(const SceneState& state, std::size_t number,
                                                    std::span<const std::uint32_t> picked, bool mirrored) const {
  const Recording& image = recordings_.images[number];
  const Transport transport(state, monomials_);
  const std::vector<std::size_t> sources = sources_of(state, image);
  std::vector<double> key = transport.key();
  key.insert(key.end(), {static_cast<double>(sources.size()), mirrored ? 1.0 : 0.0});
  if (auto known = memos_->relayed.find(number, key, picked)) return known;
  auto light = std::make_shared<const Relayed>(
      relayed(views_[image.view], transport, sources, layout_.lights.size(), mirrored, picked));
  memos_->relayed.keep(number, std::move(key), picked, light);
  return light;
}

void ImageModel::compose_from(const ViewCache& cache, const Relayed& light, const SceneState& state, std::size_t number,
                              std::span<const std::uint32_t> picked, const Shading& shading,
                              std::span<double> radiance) const {
  const Recording& image = recordings_.images[number];
  const std::vector<Rgb> emission = emission_of(state, image);
  const std::vector<Rgb> albedos = albedos_of(state);
  std::size_t slot = 0;
  for (std::size_t i = 0; i < picked.size(); ++i) {
    const Pixel& pixel = cache.pixels[picked[i]];
    Rgb sum = state.ambient * pixel.sky;
    for (std::size_t k = 0; k < pixel.facets; ++k, ++slot) {
      const std::size_t f = pixel.first_facet + k;
      const Facet& facet = cache.facets[f];
      const Rgb albedo = albedos[facet.surface] * facet.tint;
      for (std::size_t j = 0; j < shading.lights; ++j) {
        const Scattered& direct = shading.direct[slot * shading.lights + j];
        sum += (albedo * direct.base + direct.gloss) * state.lights[image.lights[j]].intensity;
      }
      sum += sent_on(light, slot, emission, onward_at(shading.onward, slot, shading.lights), albedo,
                     shading.indirect[slot]) *
             facet.weight;
    }
    sum *= exposure_of(state, image, number, pixel);
    for (int c = 0; c < 3; ++c) radiance[3 * i + static_cast<std::size_t>(c)] = sum[c];
  }
}

std::vector<Rgb> ImageModel::direct_from(const ViewCache& cache, std::span<const float> sums, const SceneState& state,
                                         std::size_t number, std::span<const std::uint32_t> picked) const {
  const Recording& image = recordings_.images[number];
  const Shading shading = Shader(layout_, image, cache, sums).direct_alone(state, picked);
  const std::vector<Rgb> albedos = albedos_of(state);
  std::vector<Rgb> radiance;
  std::size_t slot = 0;
  for (const std::uint32_t p : picked)
    for (std::size_t k = 0; k < cache.pixels[p].facets; ++k, ++slot) {
      const Facet& facet = cache.facets[cache.pixels[p].first_facet + k];
      Rgb sum;
      for (std::size_t j = 0; j < shading.lights; ++j) {
        const Scattered& direct = shading.direct[slot * shading.lights + j];
        sum += (albedos[facet.surface] * facet.tint * direct.base + direct.gloss) *
               state.lights[image.lights[j]].intensity;
      }
      radiance.push_back(sum);
    }
  return radiance;
}

struct Onward::Impl {
  const ViewCache& cache;
  const SceneState& state;
  std::size_t lights;
  Transport transport;
  std::vector<std::size_t> sources;
  std::size_t on;  // lamps of the image
  std::vector<Rgb> emission;
  Shader shader;
  std::vector<double> onward;  // of all facets
  std::vector<Rgb> albedos;
};

Onward::Onward(const ImageModel& model, const SceneState& state, std::size_t number) {
  const Recording& image = model.recordings().images[number];
  const ViewCache& cache = model.cache(image.view);
  impl_ = std::unique_ptr<Impl>(new Impl{cache,
                                         state,
                                         model.layout().lights.size(),
                                         Transport(state, model.monomials()),
                                         sources_of(state, image),
                                         image.lights.size(),
                                         emission_of(state, image),
                                         Shader(model.layout(), image, cache, {}),
                                         {},
                                         albedos_of(state)});
  std::vector<std::uint32_t> all(cache.pixels.size());
  std::iota(all.begin(), all.end(), 0u);
  impl_->onward = impl_->shader.onward(state, all);
}
Onward::~Onward() = default;

Rgb Onward::operator()(std::size_t f) const {
  const Facet& facet = impl_->cache.facets[f];
  const Scattered scattered = impl_->shader.scattered(impl_->state.surfaces[facet.surface], facet);
  Relayed light{impl_->sources.size(), {}, {}};
  add_relayed(impl_->cache, impl_->transport, impl_->sources, impl_->lights, max_component(scattered.gloss) > 0, f,
              light);
  const std::span<const double> onward = onward_at(impl_->onward, f, impl_->on);
  return sent_on(light, 0, impl_->emission, onward, impl_->albedos[facet.surface] * facet.tint, scattered);
}

void ImageModel::variance(const SceneState& state, std::size_t number, std::span<const std::uint32_t> picked,
                          std::span<double> variance) const {
  const Recording& image = recordings_.images[number];
  const ViewCache& cache = views_[image.view];
  const std::size_t lights = layout_.lights.size();
  for (std::size_t i = 0; i < picked.size(); ++i) {
    const Pixel& pixel = cache.pixels[picked[i]];
    Rgb sum, first,
        second;  // of the facets' radiances, weighted by their share of the pixel: the contrast between them
    for (std::size_t k = 0; k < pixel.facets; ++k) {
      const std::size_t f = pixel.first_facet + k;
      const Facet& facet = cache.facets[f];
      const SurfaceState& surface = state.surfaces[facet.surface];
      const Rgb albedo = surface.model->albedo(surface.values, {0, 0, 1}) * facet.tint;
      Rgb level;
      for (const std::size_t l : image.lights) {
        const Rgb unit = albedo * state.lights[l].intensity * (1 / pi);
        const double direct = facet.weight * cache.direct_sigma[f * lights + l];
        const Rgb indirect = albedo * (2 * facet.weight * cache.indirect_sigma[f * (lights + 1) + l]);
        sum += unit * unit * (Rgb{direct, direct, direct} * Rgb{direct, direct, direct} + indirect * indirect);
        level += unit * (sums_[image.view][(f * lights + l) * radius_count] / std::max(1e-6f, facet.weight));
      }
      const Rgb printed = level * (facet.weight * facet.tint_sigma / std::max(1e-3, max_component(facet.tint)));
      sum += printed * printed;
      first += level * facet.weight;
      second += level * level * facet.weight;
    }
    // Coverage of edges by n = 64 jittered sub-samples: the spread over n^(3/4) (Mitchell 1996).
    sum += (second - first * first) * std::pow(64.0, -1.5);
    const Rgb gain2 = state.gain[number] * state.gain[number];
    for (int k = 0; k < 3; ++k) variance[3 * i + static_cast<std::size_t>(k)] = std::max(0.0, (sum * gain2)[k]);
  }
}

Rgb exposure_of(const SceneState& state, const Recording& image, std::size_t number, const Pixel& pixel) {
  const Vec2 place{static_cast<double>(pixel.x), static_cast<double>(pixel.y)};
  return state.gain[number] * scene::vignetting(state.falloff, image.picture.width, image.picture.height, place);
}

double image_radius(const io::Image& picture, int x, int y) {
  return std::hypot(x - 0.5 * (picture.width - 1), y - 0.5 * (picture.height - 1)) / (0.5 * picture.width);
}

}  // namespace gonio::relighting
