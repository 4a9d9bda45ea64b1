// Which cameras and views are asked whether they see things where the scene says; see shifted_views.h.
#include <algorithm>
#include <cmath>
#include <functional>

#include "manifest/document.h"
#include "relighting/shifted_views.h"
#include "scene/mechanisms.h"

namespace gonio::relighting {
namespace {

constexpr double first_px = 0.5;    // by which the search begins
constexpr double farthest_px = 15;  // at which it ends
constexpr double least_px = 0.02;   // that a number must be able to move things by
constexpr double wide_field = 0.8;  // tangent of the angle from the axis beyond which high orders are asked
constexpr std::size_t most_views = 12;
constexpr std::size_t thinned = 5;  // every so many of the sampled pixels tells how far things move

// By how many pixels at most `amounts` move what the sampled pixels of a view show.
double most_moved(const Setting& s, const mechanism::Mechanism& m, std::size_t v, const std::vector<double>& amounts) {
  const View& view = s.recordings.views[v];
  scene::View moved{.camera = view.model, .world_from_camera = view.world_from_camera, .camera_name = view.camera};
  scene::apply_amounts(moved, m, amounts);
  const auto camera_from_world = inverse(moved.world_from_camera);
  double most = 0;
  const ViewCache& cache = s.model.cache(v);
  for (std::size_t f = 0; f < cache.facets.size(); f += thinned) {
    const Vec3 point = cache.patches[cache.facets[f].first_patch].position_m;
    const auto before = view.model.project(inverse(view.world_from_camera) * point);
    const auto after = moved.camera.project(camera_from_world * point);
    if (before && after) most = std::max(most, norm(*after - *before));
  }
  return most;
}

bool high_order(const std::string& name) {
  for (const char* one : {"k3", "k6", "s2", "s4"})
    if (name == one) return true;
  return false;
}

// Tangent of the largest angle from the axis.
double field_of(const camera::CameraModel& camera) {
  double most = 0;
  for (const double x : {0.0, camera.width_px() - 1.0})
    for (const double y : {0.0, camera.height_px() - 1.0}) {
      const Vec3 d = camera.ray({x, y}).direction;
      most = std::max(most, d.z > 0 ? std::hypot(d.x, d.y) / d.z : 1e9);
    }
  return most;
}

// The numbers of a use for these views; false where it cannot move anything.
bool settle(const Setting& s, const std::vector<std::size_t>& views, Use& use) {
  const mechanism::Mechanism& m = *use.mechanism;
  const camera::CameraModel& camera = s.recordings.views[views[0]].model;
  const bool lens = m.stage == "lens";
  std::vector<double> neutral;
  for (std::size_t k = 0; k < m.parameters.size(); ++k) {
    neutral.push_back(m.parameters[k].neutral);
    if (lens) neutral.back() = camera.intrinsics().distortion[camera::distortion_index(m.parameters[k].name, m.id)];
  }
  bool any = false;
  for (std::size_t i = 0; i < use.numbers.size(); ++i) {
    const std::size_t k = i % m.parameters.size();
    Number& n = use.numbers[i];
    const double small = 1e-3 * (n.upper - n.lower);
    std::vector<double> there = neutral;
    there[k] += small;
    double px = 0;
    for (const std::size_t v : views) px = std::max(px, most_moved(s, m, v, there));
    const double per_px = px > 0 ? small / px : 0;
    n.neutral = neutral[k];
    n.free = px > 0 && px * 1e3 > least_px && (!high_order(m.parameters[k].name) || field_of(camera) > wide_field);
    n.start = n.neutral;
    if (!n.free) continue;
    any = true;
    n.lower = std::max(n.lower, n.neutral - farthest_px * per_px);
    n.upper = std::min(n.upper, n.neutral + farthest_px * per_px);
    n.start = std::min(n.neutral + first_px * per_px, 0.5 * (n.neutral + n.upper));
  }
  return any;
}

std::vector<std::size_t> images_where(const Setting& s, const std::function<bool(const Recording&)>& holds) {
  std::vector<std::size_t> images;
  for (std::size_t i = 0; i < s.recordings.images.size(); ++i)
    if (holds(s.recordings.images[i])) images.push_back(i);
  return images;
}

void limit_to(const std::vector<std::size_t>& images, std::size_t all, Use& use) {
  if (images.size() < all)
    for (Number& n : use.numbers) n.groups = images;
}

bool asked(const Setting& s, const mechanism::Mechanism& m, const View& view) {
  return !view.model.orthographic() && !switched_on(s.document, m.id, view.camera);
}

}  // namespace

std::vector<Use> shifted_uses(const Setting& s, const mechanism::Mechanism& m) {
  std::vector<Use> uses;
  std::vector<bool> done(s.recordings.views.size());
  for (std::size_t v = 0; v < done.size(); ++v) {
    const camera::CameraModel& camera = s.recordings.views[v].model;
    if (done[v] || !asked(s, m, s.recordings.views[v])) continue;
    std::vector<std::string> on;
    std::vector<std::size_t> views;
    for (std::size_t w = v; w < done.size(); ++w) {
      const View& other = s.recordings.views[w];
      if (!(other.model == camera) || !asked(s, m, other)) continue;
      done[w] = true;
      views.push_back(w);
      if (std::ranges::find(on, other.camera) == on.end()) on.push_back(other.camera);
    }
    Use use = target_use(m, on, views, true);
    if (!settle(s, views, use)) continue;
    const auto seen = [&](const Recording& image) { return std::ranges::find(views, image.view) != views.end(); };
    limit_to(images_where(s, seen), s.recordings.images.size(), use);
    uses.push_back(std::move(use));
  }
  return uses;
}

std::vector<Use> shifted_views(const Setting& s, const mechanism::Mechanism& m) {
  std::vector<Use> uses;
  const std::vector<View>& all = s.recordings.views;
  const auto offer = [&](const std::vector<std::string>& on, const std::vector<std::size_t>& views) {
    Use use = target_use(m, on, views, true);
    if (!settle(s, views, use)) return;
    const auto seen = [&](const Recording& image) { return std::ranges::find(views, image.view) != views.end(); };
    limit_to(images_where(s, seen), s.recordings.images.size(), use);
    uses.push_back(std::move(use));
  };
  for (std::size_t v = 0; v < all.size(); ++v) {
    if (!asked(s, m, all[v])) continue;
    std::vector<std::size_t> of_camera;
    for (std::size_t w = 0; w < all.size(); ++w)
      if (all[w].camera == all[v].camera) of_camera.push_back(w);
    if (of_camera.size() > 1 && of_camera[0] == v) offer({all[v].camera}, of_camera);
    std::vector<std::string> pictures;
    for (const Recording& image : s.recordings.images)
      if (image.view == v && !switched_on(s.document, m.id, image.id)) pictures.push_back(image.id);
    if (all.size() <= most_views && !pictures.empty())
      offer(of_camera.size() > 1 ? pictures : std::vector<std::string>{all[v].camera}, {v});
  }
  return uses;
}

}  // namespace gonio::relighting
