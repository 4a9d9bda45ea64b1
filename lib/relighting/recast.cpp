#include "relighting/recast.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>

#include "scene/placement.h"

namespace gonio::relighting {
namespace {

constexpr double step_px = 1.25;
constexpr double spacing = 0.5;       // of places, in steps
constexpr std::size_t most_kept = 8;  // places: each holds two scenes for every number
constexpr double most_steps = 12;     // 15 pixels: what stands further away is another scene
constexpr CacheOptions coarse{.samples = 4, .paths = 0, .patches = 1, .penumbrae = false};

using Facets = std::map<std::uint32_t, std::size_t>;  // surface -> facet seen last

struct Node {
  std::vector<ViewCache> views;
  std::vector<std::vector<float>> sums;            // [view]: facet_sums()
  std::vector<std::vector<std::uint8_t>> differs;  // [view][pixel]: 1 where anything is not that of the unmoved scene
};

bool same(const Patch& a, const Patch& b) {
  const auto equal = [](Vec3 p, Vec3 q) { return p.x == q.x && p.y == q.y && p.z == q.z; };
  return a.weight == b.weight && equal(a.position_m, b.position_m) && equal(a.normal, b.normal) && equal(a.wo, b.wo);
}

// Sub-samples are drawn pixel by pixel: where nothing has moved, on the object or in its shadow, all is the same to the
// last bit.
bool same_pixel(const Node& a, const Node& b, std::size_t view, std::size_t pixel) {
  const ViewCache &u = a.views[view], &w = b.views[view];
  const Pixel &p = u.pixels[pixel], &q = w.pixels[pixel];
  if (p.facets != q.facets || p.sky != q.sky) return false;
  const std::size_t numbers = a.sums[view].size() / std::max<std::size_t>(1, u.facets.size());
  for (std::size_t k = 0; k < p.facets; ++k) {
    const std::size_t i = p.first_facet + k, j = q.first_facet + k;
    const Facet &f = u.facets[i], &g = w.facets[j];
    if (f.surface != g.surface || f.weight != g.weight || f.patches != g.patches) return false;
    for (std::size_t n = 0; n < f.patches; ++n)
      if (!same(u.patches[f.first_patch + n], w.patches[g.first_patch + n])) return false;
    const auto lit = a.sums[view].begin() + static_cast<std::ptrdiff_t>(i * numbers);
    if (!std::equal(lit, lit + static_cast<std::ptrdiff_t>(numbers),
                    b.sums[view].begin() + static_cast<std::ptrdiff_t>(j * numbers)))
      return false;
  }
  return true;
}

void mark_differences(const Node& unmoved, Node& node) {
  for (std::size_t v = 0; v < node.views.size(); ++v) {
    node.differs.emplace_back();
    for (std::size_t p = 0; p < node.views[v].pixels.size(); ++p)
      node.differs.back().push_back(!same_pixel(unmoved, node, v, p));
  }
}

struct Extent {
  double metres_per_pixel = 1e-3, radius_m = 0.1, reach_m = 0.1;  // reach: from the frame's origin
};
// How far apart two neighbouring pixels look, at a distance.
double pitch_m(const camera::CameraModel& camera, double distance_m) {
  const Vec2 centre = camera.principal_point_px();
  const camera::Ray a = camera.ray(centre), b = camera.ray({centre.x + 1, centre.y});
  return norm(a.origin_m - b.origin_m + (a.direction - b.direction) * distance_m);
}

// Of an object, from what the sampled pixels show of it.
Extent extent_of(const Setting& s, const scene::Instance& instance) {
  Extent e;
  Vec3 sum;
  std::vector<Vec3> places;
  double pitch = 0;
  for (std::size_t v = 0; v < s.model.views(); ++v) {
    const auto& pose = s.recordings.views[v].world_from_camera;
    for (const Facet& f : s.model.cache(v).facets) {
      if (f.surface != instance.surface) continue;
      const Vec3 p = s.model.cache(v).patches[f.first_patch].position_m;
      places.push_back(p);
      sum += p;
      pitch += pitch_m(s.recordings.views[v].model, norm(p - pose.translation_m));
    }
  }
  if (places.empty()) return e;
  const double n = static_cast<double>(places.size());
  e.metres_per_pixel = pitch / n;
  double square = 0, reach = 0;
  for (const Vec3& p : places) {
    square += dot(p - sum / n, p - sum / n);
    reach += dot(p - instance.world_from_object.translation_m, p - instance.world_from_object.translation_m);
  }
  e.radius_m = std::max(1e-6, std::sqrt(square / n));
  e.reach_m = std::max(1e-6, std::sqrt(reach / n));
  return e;
}

double step_of(const mechanism::Parameter& p, const Extent& e) {
  const double step_m = step_px * e.metres_per_pixel;
  if (p.unit == "m") return step_m;
  return step_m / (p.unit == "rad" ? e.radius_m : e.reach_m);
}

class Recasts final : public Prepared {
 public:
  struct About {  // a place of the lattice; empty: the middle of the unmoved scene, nodes of numbers that are not free
    Node middle;
    std::vector<Node> minus, plus;
  };

  Recasts(const Setting& s, const Use& use)
      : scene_(s.scene),
        recordings_(s.recordings),
        lights_(s.layout.lights),
        model_(s.model),
        mechanism_(*use.mechanism),
        instance_(use.targets[0]),
        unmoved_(cast(s.scene.instances)) {
    if (s.fitted) {
      const std::span<const double> amounts = use.amounts(*s.fitted);
      fitted_ = std::make_unique<Node>(moved({amounts.begin(), amounts.end()}));
      return;
    }
    const Extent e = extent_of(s, s.scene.instances[instance_]);
    for (std::size_t k = 0; k < use.numbers.size(); ++k) {
      step_.push_back(step_of(mechanism_.parameters[k], e));
      free_.push_back(use.numbers[k].free);
    }
  }

  const Node& unmoved() const { return unmoved_; }
  // The scene at the very amounts of a state that is settled; null: any may be asked for.
  const Node* fitted() const { return fitted_.get(); }
  double step(std::size_t k) const { return step_[k]; }
  std::vector<int> place_of(std::span<const double> amounts) const {
    std::vector<int> place;
    for (std::size_t k = 0; k < amounts.size(); ++k)
      place.push_back(static_cast<int>(std::lround(amounts[k] / (spacing * step_[k]))));
    return place;
  }
  std::shared_ptr<const About> about(const std::vector<int>& place) const {  // from any thread
    const std::lock_guard lock(mutex_);
    auto found = std::ranges::find(made_, place, &Made::first);
    if (found == made_.end()) {
      if (made_.size() == most_kept) made_.pop_back();
      found = made_.insert(made_.end(), {place, std::make_shared<const About>(cast_about(place))});
    }
    std::rotate(made_.begin(), found, found + 1);
    return made_.front().second;
  }

 private:
  using Made = std::pair<std::vector<int>, std::shared_ptr<const About>>;
  Node cast(const std::vector<scene::Instance>& instances) const {
    const render::RayCaster caster(instances);
    Node node;
    for (std::size_t v = 0; v < model_.views(); ++v) {
      std::vector<std::array<int, 2>> chosen;
      for (const Pixel& p : model_.cache(v).pixels) chosen.push_back({p.x, p.y});
      node.views.push_back(build_cache(caster, recordings_.views[v], lights_, model_.monomials(), chosen, coarse));
      lend_indirect(model_.cache(v), node.views.back());
      node.sums.push_back(facet_sums(node.views.back()));
    }
    return node;
  }
  Node moved(const std::vector<double>& amounts) const {
    std::vector<scene::Instance> instances = scene_.instances;
    instances[instance_] = scene::moved(instances[instance_], mechanism_, amounts);
    Node node = cast(instances);
    mark_differences(unmoved_, node);
    return node;
  }
  About cast_about(const std::vector<int>& place) const {
    About about;
    std::vector<double> amounts;
    for (std::size_t k = 0; k < place.size(); ++k) amounts.push_back(spacing * place[k] * step_[k]);
    if (std::ranges::any_of(place, [](int k) { return k != 0; })) about.middle = moved(amounts);
    about.minus.resize(place.size());
    about.plus.resize(place.size());
    for (std::size_t k = 0; k < place.size(); ++k) {
      if (!free_[k]) continue;
      const double middle = amounts[k];
      amounts[k] = middle - step_[k];
      about.minus[k] = moved(amounts);
      amounts[k] = middle + step_[k];
      about.plus[k] = moved(amounts);
      amounts[k] = middle;
    }
    return about;
  }

  const scene::Scene& scene_;
  const Recordings& recordings_;
  const std::span<const LightSource> lights_;
  const ImageModel& model_;
  const mechanism::Mechanism& mechanism_;
  const std::size_t instance_;
  const Node unmoved_;
  std::unique_ptr<const Node> fitted_;
  std::vector<double> step_;  // one per parameter
  std::vector<bool> free_;
  mutable std::mutex mutex_;
  mutable std::vector<Made> made_;  // the last ones asked for first
};

// Adds weight * (P(node) - P(unmoved)) for one image, where the two differ.
class Change {
 public:
  Change(const Recasts& recasts, const Frame& frame, std::span<double> radiance)
      : recasts_(recasts), frame_(frame), out_(radiance) {}
  void add(const Node& node, double weight) {
    if (weight == 0 || node.views.empty()) return;
    std::vector<std::uint32_t> picked;
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < frame_.picked.size(); ++i)
      if (node.differs[frame_.image.view][frame_.picked[i]]) picked.push_back(frame_.picked[i]), rows.push_back(3 * i);
    std::vector<double> there(3 * picked.size()), unmoved(3 * picked.size());
    predict(node, picked, there);
    predict(recasts_.unmoved(), picked, unmoved);
    for (std::size_t i = 0; i < there.size(); ++i) out_[rows[i / 3] + i % 3] += weight * (there[i] - unmoved[i]);
  }

 private:
  void predict(const Node& node, std::span<const std::uint32_t> picked, std::span<double> out) const {
    const std::size_t v = frame_.image.view;
    frame_.model.predict_from(node.views[v], node.sums[v], frame_.state, frame_.number, picked, out);
  }
  const Recasts& recasts_;
  const Frame& frame_;
  std::span<double> out_;
};

}  // namespace

void lend_indirect(const ViewCache& from, ViewCache& to) {
  const auto lend = [](const std::vector<float>& source, std::vector<float>& target, std::size_t facets_from,
                       std::size_t facets_to, std::size_t a, std::size_t b) {
    const std::size_t stride = source.size() / std::max<std::size_t>(1, facets_from);
    target.resize(stride * facets_to);
    for (std::size_t k = 0; k < stride; ++k) target[b * stride + k] = source[a * stride + k];
  };
  to.indirect.clear(), to.mirrored.clear(), to.lit.clear(), to.indirect_sigma.clear();
  Facets last;
  for (std::size_t f = 0; f < from.facets.size(); ++f) last.try_emplace(from.facets[f].surface, f);
  for (std::size_t p = 0; p < to.pixels.size(); ++p) {
    for (std::size_t k = 0; k < from.pixels[p].facets; ++k)
      last[from.facets[from.pixels[p].first_facet + k].surface] = from.pixels[p].first_facet + k;
    for (std::size_t k = 0; k < to.pixels[p].facets; ++k) {
      const std::size_t f = to.pixels[p].first_facet + k;
      const auto found = last.find(to.facets[f].surface);
      if (found == last.end()) continue;
      to.facets[f].tint = from.facets[found->second].tint;
      lend(from.indirect, to.indirect, from.facets.size(), to.facets.size(), found->second, f);
      lend(from.mirrored, to.mirrored, from.facets.size(), to.facets.size(), found->second, f);
      lend(from.lit, to.lit, from.facets.size(), to.facets.size(), found->second, f);
      lend(from.indirect_sigma, to.indirect_sigma, from.facets.size(), to.facets.size(), found->second, f);
    }
  }
}

std::vector<Use> object_uses(const Setting& s, const mechanism::Mechanism& mechanism) {
  std::vector<Use> uses;
  for (std::size_t i = 0; i < s.scene.instances.size(); ++i) {
    const scene::Instance& instance = s.scene.instances[i];
    if (std::holds_alternative<scene::Plane>(instance.shape) || switched_on(s.document, mechanism.id, instance.id))
      continue;
    Use use = target_use(mechanism, {instance.id}, {i}, false);
    const Extent e = extent_of(s, instance);
    for (std::size_t k = 0; k < use.numbers.size(); ++k) {
      const double most = most_steps * step_of(mechanism.parameters[k], e);
      Number& n = use.numbers[k];
      n.lower = std::max(n.lower, -most);
      n.upper = std::min(n.upper, most);
      n.start = std::min(n.start, most / most_steps);
      // A ball that turns about its centre is the same ball.
      if (std::holds_alternative<scene::Sphere>(instance.shape) && mechanism.parameters[k].unit == "rad")
        n.free = false, n.start = n.neutral;
    }
    uses.push_back(use);
  }
  return uses;
}

std::shared_ptr<const Prepared> prepare_recasts(const Setting& s, const Use& use) {
  return std::make_shared<Recasts>(s, use);
}

void add_recasts(const Use& use, const Frame& frame, std::span<double> radiance) {
  const auto& recasts = static_cast<const Recasts&>(*use.prepared);
  Change change(recasts, frame, radiance);
  if (recasts.fitted()) return change.add(*recasts.fitted(), 1);
  const std::span<const double> amounts = use.amounts(frame.state);
  const std::vector<int> place = recasts.place_of(amounts);
  const std::shared_ptr<const Recasts::About> about = recasts.about(place);
  double middle = 1;
  for (std::size_t k = 0; k < amounts.size(); ++k) {
    const double t = amounts[k] / recasts.step(k) - spacing * place[k];
    if (t == 0) continue;
    change.add(about->plus[k], 0.5 * (t + t * t));
    change.add(about->minus[k], -0.5 * (t - t * t));
    middle -= t * t;
  }
  change.add(about->middle, middle);
}

void recast_slopes(const Use& use, const Frame& frame, std::span<const std::size_t> numbers,
                   std::span<double> columns) {
  const auto& recasts = static_cast<const Recasts&>(*use.prepared);
  const std::span<const double> amounts = use.amounts(frame.state);
  const std::vector<int> place = recasts.place_of(amounts);
  const std::shared_ptr<const Recasts::About> about = recasts.about(place);
  const std::size_t rows = 3 * frame.picked.size();
  std::fill(columns.begin(), columns.end(), 0.0);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t k = numbers[i];
    const double step = recasts.step(k), t = amounts[k] / step - spacing * place[k];
    Change change(recasts, frame, columns.subspan(i * rows, rows));
    change.add(about->plus[k], (0.5 + t) / step);
    change.add(about->minus[k], -(0.5 - t) / step);
    change.add(about->middle, -2 * t / step);
  }
}

Term recast_term(const mechanism::Mechanism& (*mechanism)(), std::vector<Use> (*candidates)(const Setting&)) {
  return {.mechanism = mechanism,
          .reach = Reach::add,
          .order = -20,
          .candidates = candidates,
          .prepare = prepare_recasts,
          .add = add_recasts,
          .slopes = recast_slopes};
}

}  // namespace gonio::relighting
