// See photometric_problem.h.
#include "explain/stacks/photometric_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "stats/intervals.h"

namespace gonio::explain::stacks {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t fewest_shown = 5;  // lamps that must shine on a site
constexpr int alternations = 12;
constexpr double indirect = 0.03;      // share of a patch's brightest reading that its surroundings may reflect onto it
constexpr double least_cosine = 0.15;  // of the eye above a site

// The mean over the channels, where all of them count: what sites are chosen by.
Stack grey(const Stack& stack) {
  const std::size_t channels = stack.channels.size();
  Stack result = stack;
  if (channels == 1) return result;
  for (StackImage& image : result.images) {
    io::Image mean(image.picture.width, image.picture.height, {"Y"});
    std::vector<std::uint8_t> counts(mean.pixels(), 1);
    for (std::size_t i = 0; i < image.counts.size(); ++i) {
      mean.data[i / channels] += image.picture.data[i] / static_cast<float>(channels);
      counts[i / channels] = counts[i / channels] && image.counts[i];
    }
    image.picture = std::move(mean);
    image.counts = std::move(counts);
  }
  result.channels = {"Y"};
  return result;
}

PatchLight lamp(const manifest::Document& document, const StackImage& image) {
  const manifest::Light& light = document.lights.at(image.light);
  const Rgb watt = light.parameters.at("watt_per_m2").rgb();
  return {normalized(light.parameters.at("towards").vector()), mean(watt) / pi * image.gain * image.exposure_s};
}

double angle(double cosine) {
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

Vec3 direction_to_eye(const StackImage& image, const std::vector<PatchLight>& lamps) {
  if (const auto& pose = image.world_from_camera) return pose->rotate({0, 0, -1});
  // Without a pose, lamps with z > 0 speak of axes whose z points at the camera, as is the habit of photometric stereo.
  double z = 0;
  for (const PatchLight& lamp : lamps) z += lamp.towards.z;
  return {0, 0, z > 0 ? 1.0 : -1.0};
}

}  // namespace

PhotometricProblem::PhotometricProblem(const manifest::Document& document, Stack stack, std::size_t sites)
    : stack_(std::move(stack)), noise_(stack_) {
  const std::string place = manifest::place(document, "/images/" + std::to_string(stack_.images[0].entry));
  for (const StackImage& image : stack_.images) {
    lamps_.push_back(lamp(document, image));
    stated_.push_back(lamps_.back().white);
    free_.push_back(document.lights.at(image.light).parameters.at("watt_per_m2").free);
    if (!(lamps_.back().white > 0))
      throw Error(Exit::data, manifest::place(document, "/lights/" + image.light), "gives no light",
                  "state watt_per_m2 above zero");
  }
  eye_ = direction_to_eye(stack_.images[0], lamps_);
  right_ = {1, 0, 0}, down_ = {0, -eye_.z, 0};
  if (const auto& pose = stack_.images[0].world_from_camera)
    right_ = pose->rotate({1, 0, 0}), down_ = pose->rotate({0, 1, 0});
  const Stack mean = grey(stack_);
  sites_ = choose_sites(mean, ReadingNoise(mean), {.sites = sites, .fewest = fewest_shown}, place);
  keep_shown_sites(place);
  if (std::any_of(free_.begin(), free_.end(), [](char f) { return f != 0; })) start_strengths();
  add_patches();
  add_rows();
  add_lamps();
  add_mechanisms(document);
  add_conditions();
  beside_ = beside();
}

PatchReadings PhotometricProblem::readings(int x, int y, std::span<const PatchLight> lights, double noise_factor,
                                           const std::vector<std::size_t>* seen) const {
  PatchReadings r;
  r.channels = stack_.channels.size();
  r.lights.assign(lights.begin(), lights.end());
  r.radius = radius(x, y);
  for (std::size_t g = 0; g < stack_.images.size(); ++g) {
    const StackImage& image = stack_.images[g];
    const bool out = seen != nullptr && !std::binary_search(seen->begin(), seen->end(), g);
    for (std::size_t c = 0; c < r.channels; ++c) {
      const std::size_t i = image.picture.index(x, y, static_cast<int>(c));
      r.y.push_back(image.picture.data[i]);
      r.weight.push_back(out || !image.counts[i] ? 0 : 1);
    }
  }
  std::vector<double> brightest(r.channels);
  for (std::size_t k = 0; k < r.y.size(); ++k)
    if (r.weight[k] > 0) brightest[k % r.channels] = std::max(brightest[k % r.channels], r.y[k]);
  for (std::size_t k = 0; k < r.y.size(); ++k)
    if (r.weight[k] > 0) r.weight[k] = 1 / (noise_factor * sigma(k / r.channels, r.y[k], brightest[k % r.channels]));
  return r;
}

double PhotometricProblem::sigma(std::size_t image, double reading, double brightest) const {
  const double noise = noise_.sigma(image, reading);
  return noise_.stated() ? noise : std::hypot(noise, evenness * reading, indirect * brightest);
}

void PhotometricProblem::keep_shown_sites(const std::string& place) {
  std::vector<Site> kept;
  for (Site& site : sites_) {
    const PatchReadings r = readings(site.x, site.y, lamps_, 1);
    std::vector<char> dark;
    const Patch p = matte_patch(r, dark);
    std::vector<std::size_t> seen;
    std::size_t lit = 0;
    for (const std::size_t g : site.seen) {
      if (dark[g]) continue;
      seen.push_back(g);
      lit += dot(p.b, lamps_[g].towards) > 0;
    }
    if (lit < fewest_shown || !(dot(p.b, eye_) > least_cosine * norm(p.b)) || !(norm(p.b) > 0)) continue;
    hidden_ += site.seen.size() - seen.size();
    site.seen = std::move(seen);
    start_.push_back(fitted_patch(PatchModel{.eye = eye_}, readings(site.x, site.y, lamps_, 1, &site.seen), p));
    kept.push_back(std::move(site));
  }
  sites_ = std::move(kept);
  if (sites_.size() < 24)
    throw Error(Exit::data, place, "shows only " + std::to_string(sites_.size()) + " places that five lamps reach",
                "add lamps, or a mask of the object");
}

// Patches and the strengths of free lamps in turn, so that conditions are stated along what the base model's fit reads.
void PhotometricProblem::start_strengths() {
  const PatchModel matte{.eye = eye_};
  const std::size_t channels = stack_.channels.size();
  for (int i = 0; i < alternations; ++i) {
    std::vector<double> top(lamps_.size()), bottom(lamps_.size());
    for (std::size_t s = 0; s < sites_.size(); ++s) {
      const PatchReadings r = readings(sites_[s].x, sites_[s].y, lamps_, 1, &sites_[s].seen);
      start_[s] = fitted_patch(matte, r, start_[s]);
      for (std::size_t k = 0; k < r.y.size(); ++k) {
        const std::size_t g = k / channels;
        const double f = matte(start_[s].b, start_[s].tint[k % channels], lamps_[g], 0) * r.weight[k];
        top[g] += f * r.y[k] * r.weight[k];
        bottom[g] += f * f;
      }
    }
    double common = 0, count = 0;  // belongs to the albedo
    for (std::size_t g = 0; g < lamps_.size(); ++g)
      if (free_[g] && top[g] > 0 && bottom[g] > 0) common += std::log(top[g] / bottom[g]), count += 1;
    for (std::size_t g = 0; g < lamps_.size(); ++g)
      if (free_[g] && top[g] > 0 && bottom[g] > 0)
        lamps_[g].white *= top[g] / bottom[g] / std::exp(common / std::max(1.0, count));
  }
}

void PhotometricProblem::add_patches() {
  for (std::size_t s = 0; s < sites_.size(); ++s)
    for (std::size_t c = 0; c < unknowns(); ++c) {
      const Patch& patch = start_[s];
      Parameter p;
      p.name = (c < 3 ? "patch/" : "tint/") + std::to_string(sites_[s].x) + "," + std::to_string(sites_[s].y) + "." +
               "xyzRG"[c];
      p.unit = "1";
      p.size = c < 3 ? 0.1 * norm(patch.b) : 0.1;
      const double start[] = {patch.b.x, patch.b.y, patch.b.z, patch.tint[0], patch.tint[1]};
      p.start = p.neutral = start[c];
      p.groups = sites_[s].seen;
      base_.push_back(parameters_.size());
      parameters_.push_back(std::move(p));
    }
}

void PhotometricProblem::add_rows() {
  Observations& o = observations_;
  rows_.resize(stack_.images.size());
  o.first.push_back(0);
  std::vector<PatchReadings> shown;
  for (const Site& site : sites_) shown.push_back(readings(site.x, site.y, lamps_, 1, &site.seen));
  for (std::size_t g = 0; g < rows_.size(); ++g) {
    for (std::size_t s = 0; s < sites_.size(); ++s) {
      if (!std::binary_search(sites_[s].seen.begin(), sites_[s].seen.end(), g)) continue;
      rows_[g].push_back(s);
      for (std::size_t c = 0; c < stack_.channels.size(); ++c) {
        const std::size_t k = g * stack_.channels.size() + c;
        o.value.push_back(shown[s].y[k]);
        o.norm.push_back(shown[s].y[k] * shown[s].y[k]);
        o.block.push_back(static_cast<std::uint32_t>(g * sites_.size() + s));
        o.sigma.push_back(1 / shown[s].weight[k]);
      }
    }
    o.first.push_back(o.value.size());
    o.group.push_back(stack_.images[g].light);
  }
}

// The channel is none of them: with a tint free at every site nothing can follow it.
void PhotometricProblem::add_conditions() {
  const std::size_t channels = stack_.channels.size();
  const PatchModel base{.eye = eye_};
  std::vector<double> matte;  // what the base model's fit reads
  for (std::size_t g = 0; g < rows_.size(); ++g)
    for (const std::size_t s : rows_[g])
      for (std::size_t c = 0; c < channels; ++c) matte.push_back(base(start_[s].b, start_[s].tint[c], lamps_[g], 0));
  std::vector<Condition> all = {{"image.radiance", "1", "sensor", matte, {}, "1"},
                                {"surface.half-angle", "rad", "surface", {}, {}, "1"},
                                {"surface.incidence-angle", "rad", "surface", {}, matte, "1"},
                                {"surface.exitance-angle", "rad", "surface", {}, matte, "1"},
                                {"surface.phase-angle", "rad", "surface", {}, matte, "1"},
                                {"light.identity", "1", "light", {}, matte, "1"},
                                {"camera.image-radius", "half width", "optics", {}, matte, "1"},
                                {"camera.image-y", "px", "sensor", {}, matte, "1"},
                                {"light.distance", "half width", "light", {}, matte, "1"}};
  for (std::size_t g = 0; g < rows_.size(); ++g)
    for (const std::size_t s : rows_[g]) {
      const Vec3 n = normalized(start_[s].b), l = lamps_[g].towards;
      const double ci = dot(n, l);
      for (std::size_t c = 0; c < channels; ++c) {
        const double values[] = {ci > 0 ? angle(dot(n, normalized(l + eye_))) : none,
                                 angle(ci),
                                 angle(dot(n, eye_)),
                                 angle(dot(l, eye_)),
                                 static_cast<double>(g),
                                 radius(sites_[s].x, sites_[s].y),
                                 static_cast<double>(sites_[s].y),
                                 -dot(l, position(sites_[s].x, sites_[s].y))};  // beyond the scene's centre
        for (std::size_t k = 1; k < all.size(); ++k) all[k].values.push_back(values[k - 1]);
      }
    }
  std::erase_if(all, [](const Condition& condition) {
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;
    for (const double v : condition.values)
      if (!std::isnan(v)) lower = std::min(lower, v), upper = std::max(upper, v);
    return !(upper > lower);
  });
  observations_.conditions = std::move(all);
}

double PhotometricProblem::radius(int x, int y) const {
  const double half = 0.5 * stack_.width();
  return std::hypot(x - half + 0.5, y - 0.5 * stack_.height() + 0.5) / half;
}

Patch PhotometricProblem::patch(std::span<const double> values, std::size_t site) const {
  const double* v = &values[first_of(site)];
  Patch p{{v[0], v[1], v[2]}, {1, 1, 1}};
  if (stack_.channels.size() > 1) p.tint = {v[3], v[4], 3 - v[3] - v[4]};
  return p;
}

PatchModel PhotometricProblem::model(std::span<const double> values) const {
  PatchModel m;
  for (const Bound& bound : bound_)
    if (bound.binding->set != nullptr) bound.binding->set(bound.of(values), stack_, m);
  m.eye = eye_;
  return m;
}

Vec3 PhotometricProblem::position(int x, int y) const {
  const double half = 0.5 * stack_.width();
  return right_ * ((x - half + 0.5) / half) + down_ * ((y - 0.5 * stack_.height() + 0.5) / half);
}

PatchLight PhotometricProblem::light(std::span<const double> values, std::size_t group, Vec3 at) const {
  PatchLight lamp = lamps_[group];
  const double strength =
      values[strength_[group]] + values[slope_[group][0]] * dot(at, right_) + values[slope_[group][1]] * dot(at, down_);
  if (strength != 0) lamp.white *= std::exp(strength);
  for (const Bound& bound : bound_)
    if (bound.binding->aim != nullptr) bound.binding->aim(bound.of(values), group, at, lamp);
  return lamp;
}

std::vector<PatchLight> PhotometricProblem::lights(std::span<const double> values, int x, int y) const {
  std::vector<PatchLight> all;
  for (std::size_t g = 0; g < lamps_.size(); ++g) all.push_back(light(values, g, position(x, y)));
  return all;
}

void PhotometricProblem::predict(std::span<const double> values, std::size_t group,
                                 std::span<double> prediction) const {
  const PatchModel now = model(values);
  const std::size_t channels = stack_.channels.size();
  for (std::size_t i = 0; i < rows_[group].size(); ++i) {
    const Site& site = sites_[rows_[group][i]];
    const Patch p = patch(values, rows_[group][i]);
    const PatchLight lamp = light(values, group, position(site.x, site.y));
    for (std::size_t c = 0; c < channels; ++c)
      prediction[channels * i + c] = now(p.b, p.tint[c], lamp, radius(site.x, site.y));
  }
}

void PhotometricProblem::jacobian(std::span<const double> values, std::size_t group,
                                  std::span<const std::size_t> columns, std::span<double> derivatives) const {
  const std::size_t channels = stack_.channels.size(), rows = channels * rows_[group].size();
  const std::size_t patches = first_of(sites_.size());
  std::vector<std::size_t> shared, places, column_of(patches, columns.size());
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (columns[k] < patches)  // patches come first
      column_of[columns[k]] = k;
    else
      shared.push_back(columns[k]), places.push_back(k);
  }
  std::vector<double> own(shared.size() * rows);
  Problem::jacobian(values, group, shared, own);
  std::fill(derivatives.begin(), derivatives.end(), 0.0);
  for (std::size_t k = 0; k < places.size(); ++k)
    std::copy_n(own.begin() + static_cast<std::ptrdiff_t>(k * rows), rows,
                derivatives.begin() + static_cast<std::ptrdiff_t>(places[k] * rows));
  const PatchModel now = model(values);
  std::vector<double> moved(values.begin(), values.end());
  for (std::size_t i = 0; i < rows_[group].size(); ++i) {
    const std::size_t s = rows_[group][i];
    const double r = radius(sites_[s].x, sites_[s].y);
    const PatchLight lamp = light(values, group, position(sites_[s].x, sites_[s].y));
    for (std::size_t u = 0; u < unknowns(); ++u) {
      const std::size_t p = first_of(s) + u;
      if (column_of[p] == columns.size()) continue;
      const double step = 1e-3 * parameters_[p].size;
      moved[p] = values[p] + step;
      const Patch above = patch(moved, s);
      moved[p] = values[p] - step;
      const Patch below = patch(moved, s);
      moved[p] = values[p];
      for (std::size_t c = 0; c < channels; ++c)
        derivatives[column_of[p] * rows + channels * i + c] =
            (now(above.b, above.tint[c], lamp, r) - now(below.b, below.tint[c], lamp, r)) / (2 * step);
    }
  }
}

// Residuals of a site and of the pixel beside it, both fitted alone: smooth misfits cancel in the difference.
double PhotometricProblem::beside() const {
  std::vector<double> differences;
  const PatchModel matte{.eye = eye_};
  const std::size_t channels = stack_.channels.size();
  for (std::size_t s = 0; s < sites_.size(); ++s) {
    const Site& site = sites_[s];
    const PatchReadings here = readings(site.x, site.y, lamps_, 1, &site.seen);
    const PatchReadings there = readings(site.x + stack_.step, site.y, lamps_, 1, &site.seen);
    const Patch a = start_[s], b = fitted_patch(matte, there, a);
    const auto n = static_cast<double>(channels * site.seen.size());
    for (std::size_t i = 0; i < here.y.size(); ++i) {
      if (!(here.weight[i] > 0) || !(there.weight[i] > 0)) continue;
      const PatchLight& light = here.lights[i / channels];
      const double of_here = here.y[i] - matte(a.b, a.tint[i % channels], light, 0);
      const double of_there = there.y[i] - matte(b.b, b.tint[i % channels], light, 0);
      differences.push_back(std::abs(of_here - of_there) * here.weight[i] *
                            std::sqrt(n / (n - static_cast<double>(unknowns()))));
    }
  }
  if (differences.size() < 32) return 1;
  return std::max(0.2, stats::median(differences) / 0.6745 / std::sqrt(2.0));
}

std::optional<double> PhotometricProblem::noise_factor(std::span<const double>) const {
  if (noise_.stated()) return std::nullopt;
  return beside_;
}

std::vector<std::unique_ptr<Problem>> photometric_problems(const manifest::Document& document) {
  std::vector<std::unique_ptr<Problem>> problems;
  for (const std::vector<std::size_t>& entries : stacks_of(document, Kind::lights))
    problems.push_back(std::make_unique<PhotometricProblem>(document, read_stack(document, entries, Kind::lights)));
  return problems;
}

}  // namespace gonio::explain::stacks
