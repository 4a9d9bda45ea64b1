#include "relighting/image_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "relighting/uses.h"
#include "scene/scene.h"

namespace gonio::relighting {
namespace {

constexpr std::size_t radius_count = radii_m.size();

// Polynomials in the albedos of a state, colour by colour.
class Transport {
 public:
  Transport(const SceneState& state, const render::Monomials& monomials)
      : strength_(state.indirect), terms_(monomials.size()) {
    const Vec3 oblique{std::sqrt(0.5), 0, std::sqrt(0.5)};
    std::vector<Rgb> albedos;
    for (const SurfaceState& s : state.surfaces)  // what lets light through does not spread it
      albedos.push_back(s.model->transmits() ? Rgb{} : s.model->albedo(s.values, oblique));
    std::array<std::vector<double>, 3> values;
    for (int k = 0; k < 3; ++k) {
      std::vector<double> albedo;
      for (const Rgb& a : albedos) albedo.push_back(a[k]);
      values[static_cast<std::size_t>(k)] = monomials.evaluate(albedo);
    }
    for (std::size_t m = 0; m < terms_; ++m) values_.push_back({values[0][m], values[1][m], values[2][m]});
  }
  std::size_t terms() const { return terms_; }
  // The constant term is what an ambient source sends straight: no light between surfaces.
  Rgb operator()(const float* coefficient) const {
    Rgb sum;
    for (std::size_t m = 1; m < terms_; ++m) sum += values_[m] * double{coefficient[m]};
    return sum * strength_ + Rgb{coefficient[0], coefficient[0], coefficient[0]};
  }

 private:
  double strength_;
  std::size_t terms_;
  std::vector<Rgb> values_;
};

Rgb albedo_of(const SurfaceState& surface) {
  return has_parameter(*surface.model, "albedo") ? surface.values.rgb(parameter_index(*surface.model, "albedo"))
                                                 : Rgb{};
}

std::vector<Rgb> albedos_of(const SceneState& state) {
  std::vector<Rgb> albedos;
  for (const SurfaceState& s : state.surfaces) albedos.push_back(albedo_of(s));
  return albedos;
}

// What a facet sends on of the light that reaches it by way of others, over its share of the pixel.
class Indirect {
 public:
  Indirect(const ViewCache& cache, const SceneState& state, const render::Monomials& monomials, const Recording& image,
           std::size_t lights)
      : cache_(cache),
        state_(state),
        image_(image),
        lights_(lights),
        transport_(state, monomials),
        ambient_(max_component(state.ambient) > 0) {}
  // `onward`: Shading's, of all facets that are asked for; `slot`: the facet's place there.
  Rgb operator()(std::size_t facet, Rgb albedo, const Scattered& sent_on, std::span<const double> onward,
                 std::size_t slot) const {
    const bool glossy = max_component(sent_on.gloss) > 0;
    Rgb irradiance, mirrored;
    const auto add_source = [&](std::size_t source, Rgb emission) {
      const std::size_t first = (facet * (lights_ + 1) + source) * transport_.terms();
      irradiance += transport_(&cache_.indirect[first]) * emission;
      if (glossy) mirrored += transport_(&cache_.mirrored[first]) * emission;
    };
    for (std::size_t j = 0; j < image_.lights.size(); ++j)
      add_source(image_.lights[j], state_.lights[image_.lights[j]].intensity *
                                       (onward.empty() ? 1 : onward[slot * image_.lights.size() + j]));
    if (ambient_) add_source(lights_, state_.ambient);
    return (albedo * irradiance * sent_on.base + sent_on.gloss * mirrored) / pi;
  }

 private:
  const ViewCache& cache_;
  const SceneState& state_;
  const Recording& image_;
  std::size_t lights_;
  Transport transport_;
  bool ambient_;
};

}  // namespace

ImageModel::ImageModel(const Recordings& recordings, const SceneLayout& layout, const render::Monomials& monomials,
                       std::vector<ViewCache> views)
    : recordings_(recordings),
      layout_(layout),
      monomials_(monomials),
      views_(std::move(views)),
      memo_(std::make_unique<ShadingMemo>(recordings.images.size())),
      scattered_(std::make_unique<ScatteredMemo>()) {
  for (const ViewCache& cache : views_) sums_.push_back(facet_sums(cache));
}

Shader ImageModel::shader(std::size_t image) const {
  const Recording& recording = recordings_.images[image];
  return Shader(layout_, recording, views_[recording.view], sums_[recording.view], *scattered_);
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
  memo_ = std::make_unique<ShadingMemo>(recordings_.images.size());  // terms may be others now
  std::stable_sort(ordered_.begin(), ordered_.end(),
                   [&](std::size_t a, std::size_t b) { return uses_[a].term->order < uses_[b].term->order; });
}

void ImageModel::take_uses(const ImageModel& other, std::vector<Use> uses) {
  uses_ = std::move(uses);
  ordered_ = other.ordered_;
  layout_.start = other.layout_.start;
  memo_ = std::make_unique<ShadingMemo>(recordings_.images.size());
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
                           std::span<double> radiance, Additions* noted) const {
  run_hooks(edited, image, picked, [&](const Use& use, const Frame& frame) {
    if (!use.term->add) return;
    Addition* note = noted && !use.term->anew ? &(*noted)[use.place] : nullptr;
    if (note) note->before.assign(radiance.begin(), radiance.end());
    use.term->add(use, frame, radiance);
    if (note) note->after.assign(radiance.begin(), radiance.end());
  });
}

void ImageModel::add_terms_again(const SceneState& edited, std::size_t image, std::span<const std::uint32_t> picked,
                                 const Additions& noted, std::span<double> radiance) const {
  run_hooks(edited, image, picked, [&](const Use& use, const Frame& frame) {
    if (!use.term->add) return;
    const auto note = noted.find(use.place);
    if (note == noted.end()) return use.term->add(use, frame, radiance);
    const auto& [before, after] = note->second;
    for (std::size_t i = 0; i < radiance.size(); ++i)
      radiance[i] = before[i] > 0 ? radiance[i] * (after[i] / before[i]) : radiance[i] + (after[i] - before[i]);
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
  if (auto known = memo_->find(image, key, picked)) return known;
  auto shaded = std::make_shared<Shaded>(Shaded{shade(now, image, picked), {}});
  const auto shades = [&](const Use& use) { return use.term->shade != nullptr && !use.neutral(now); };
  if (std::ranges::any_of(uses_, shades)) {
    shaded->changed = shaded->plain;
    shade_terms(now, image, picked, *shaded->changed);
  }
  memo_->keep(image, std::move(key), picked, shaded);
  return shaded;
}

void ImageModel::predict_from(const ViewCache& cache, std::span<const float> sums, const SceneState& edited,
                              std::size_t image, std::span<const std::uint32_t> picked,
                              std::span<double> radiance) const {
  const Shading shading = Shader(layout_, recordings_.images[image], cache, sums, *scattered_)(edited, picked);
  compose_from(cache, edited, image, picked, shading, radiance);
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
  compose_from(views_[recordings_.images[number].view], state, number, picked, shading, radiance);
}

void ImageModel::compose_from(const ViewCache& cache, const SceneState& state, std::size_t number,
                              std::span<const std::uint32_t> picked, const Shading& shading,
                              std::span<double> radiance) const {
  const Recording& image = recordings_.images[number];
  const Indirect indirect(cache, state, monomials_, image, layout_.lights.size());
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
      sum += indirect(f, albedo, shading.indirect[slot], shading.onward, slot) * facet.weight;
    }
    sum *= exposure_of(state, image, number, pixel);
    for (int c = 0; c < 3; ++c) radiance[3 * i + static_cast<std::size_t>(c)] = sum[c];
  }
}

std::vector<Rgb> ImageModel::direct_from(const ViewCache& cache, std::span<const float> sums, const SceneState& state,
                                         std::size_t number, std::span<const std::uint32_t> picked) const {
  const Recording& image = recordings_.images[number];
  const Shading shading = Shader(layout_, image, cache, sums, *scattered_).direct_alone(state, picked);
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
  Indirect indirect;
  Shader shader;
  std::vector<double> onward;  // of all facets
  std::vector<Rgb> albedos;
};

Onward::Onward(const ImageModel& model, const SceneState& state, std::size_t number) {
  const Recording& image = model.recordings().images[number];
  const ViewCache& cache = model.cache(image.view);
  const Shader shader(model.layout(), image, cache, {}, model.scattered());
  std::vector<std::uint32_t> all(cache.pixels.size());
  std::iota(all.begin(), all.end(), 0u);
  impl_ = std::unique_ptr<const Impl>(
      new Impl{cache, state, Indirect(cache, state, model.monomials(), image, model.layout().lights.size()), shader,
               shader.onward(state, all), albedos_of(state)});
}
Onward::~Onward() = default;

Rgb Onward::operator()(std::size_t f) const {
  const Facet& facet = impl_->cache.facets[f];
  return impl_->indirect(f, impl_->albedos[facet.surface] * facet.tint,
                         impl_->shader.scattered(impl_->state.surfaces[facet.surface], facet), impl_->onward, f);
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
