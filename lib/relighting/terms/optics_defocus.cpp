// optics.defocus on cached geometry: the mean of what lies around a pixel (relighting/rings.h) over discs of the
// diameter that every thing's own depth gives it, 2 aperture_radius_m f |1/z - 1/focus_m| pixels, so that a near thing
// out of focus spreads over a sharp one behind it and not the other way round. Surfaces are laid over each other from
// near to far (Potmesil & Chakravarty 1981; Kraus & Strengert 2007): the nearest covers the pixel by the share of its
// disc that it fills; those behind it fill the rest in proportion to what is seen of them. Discs end with the last
// ring.
#include <algorithm>
#include <cmath>

#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/rings.h"
#include "relighting/uses.h"

namespace gonio::mechanism {
const Mechanism& optics_defocus();
}

namespace gonio::relighting::terms {
namespace {

constexpr double first_guess_px = 1.5;  // radius of the discs where the search begins

struct Around final : Prepared {
  std::vector<Rings> rings;      // [view]
  std::vector<double> focal_px;  // [view]
};

// Pixels for a change of the slope x / z by one, at the picture's centre.
double focal_px(const camera::CameraModel& camera) {
  const Vec2 centre = camera.principal_point_px();
  const Vec3 a = camera.ray(centre).direction, b = camera.ray({centre.x + 1, centre.y}).direction;
  return 1 / std::hypot(b.x / b.z - a.x / a.z, b.y / b.z - a.y / a.z);
}

std::shared_ptr<const Prepared> prepare(const Setting& s, const Use&) {
  auto result = std::make_shared<Around>();
  result->rings = cast_rings(s);
  for (const View& view : s.recordings.views) result->focal_px.push_back(focal_px(view.model));
  return result;
}

struct Depths {
  double nearest_m = 1e30, furthest_m = 0;
};
Depths depths_of(const Setting& s, std::size_t view) {
  const auto camera_from_world = inverse(s.recordings.views[view].world_from_camera);
  Depths depths;
  for (const Patch& patch : s.model.cache(view).patches) {
    const double z = (camera_from_world * patch.position_m).z;
    depths.nearest_m = std::min(depths.nearest_m, z), depths.furthest_m = std::max(depths.furthest_m, z);
  }
  return depths;
}

// The search begins with a lens focused at a quarter behind the furthest thing.
std::vector<Use> candidates(const Setting& s) {
  std::vector<Use> uses = camera_uses(s, mechanism::optics_defocus());
  std::erase_if(uses, [&](Use& use) {
    Depths depths;
    double focal = 0;
    for (std::size_t v = 0; v < s.recordings.views.size(); ++v) {
      if (s.recordings.views[v].camera != use.on[0] || s.recordings.views[v].model.orthographic()) continue;
      const Depths here = depths_of(s, v);
      depths.nearest_m = std::min(depths.nearest_m, here.nearest_m);
      depths.furthest_m = std::max(depths.furthest_m, here.furthest_m);
      focal = focal_px(s.recordings.views[v].model);
    }
    if (!(focal > 0) || !(depths.nearest_m > 0) || !(depths.furthest_m >= depths.nearest_m)) return true;
    const double focus_m = 1.25 * depths.furthest_m, middle_m = 0.5 * (depths.nearest_m + depths.furthest_m);
    const double radius_m = first_guess_px / (focal * (1 / middle_m - 1 / focus_m));
    Number &radius = use.numbers[0], &focus = use.numbers[1];
    radius.start = std::min(radius_m, 0.5 * radius.upper);
    radius.upper = std::min(radius.upper, 20 * radius_m);
    focus = {focus_m, focus_m, 0.3 * depths.nearest_m, 20 * depths.furthest_m};  // no lens: no distance counts
    return false;
  });
  return uses;
}

// What one surface, or the empty sky, contributes to a pixel.
struct Layer {
  std::uint32_t surface = 0;
  Rgb sum, seen;  // weighted by its discs; by its share of the nearest ring that shows it
  double weight = 0, share = 0, depth_m = 0;
  void add(Rgb radiance, double part, double disc, double at_m) {
    sum += radiance * disc;
    weight += part * disc;
    if (share > 0) return;
    seen = radiance, share = part, depth_m = at_m;
  }
  Rgb mean() const { return weight > 1e-9 ? sum / weight : seen / share; }
};

class Layers {
 public:
  void clear() { count_ = 0; }
  Layer& of(std::uint32_t surface) {
    for (Layer& layer : std::span(layers_).first(static_cast<std::size_t>(count_)))
      if (layer.surface == surface) return layer;
    if (count_ == std::ssize(layers_)) return layers_.back();
    Layer& layer = layers_[static_cast<std::size_t>(count_++)];
    layer = {};
    layer.surface = surface;
    return layer;
  }
  Rgb laid() {
    const auto nearer = [](const Layer& a, const Layer& b) { return a.depth_m < b.depth_m; };
    std::swap(layers_[0], *std::min_element(layers_.begin(), layers_.begin() + count_, nearer));
    const Layer& nearest = layers_[0];
    if (count_ == 1) return nearest.mean();
    double behind = 0, seen = 0;
    Rgb sum, glimpse;
    for (std::ptrdiff_t i = 1; i < count_; ++i) {
      const Layer& layer = layers_[static_cast<std::size_t>(i)];
      behind += layer.weight, sum += layer.sum;
      seen += layer.share, glimpse += layer.seen;
    }
    const double through = std::max(0.0, 1 - nearest.weight);
    if (through == 0) return nearest.mean();
    return nearest.mean() * (1 - through) + (behind > 1e-9 ? sum / behind : glimpse / seen) * through;
  }

 private:
  std::array<Layer, 8> layers_;
  std::ptrdiff_t count_ = 0;
};

// The blurred picture for any lens, from what the rings show at one state of the scene.
class Blur {
 public:
  Blur(const Use& use, const Frame& frame)
      : around_(static_cast<const Around&>(*use.prepared)), frame_(frame), rings_(around_.rings[frame.image.view]) {
    radiance_[0] = radiance_of(rings_.own, frame);
    for (std::size_t k = 0; k < ring_count; ++k) radiance_[k + 1] = radiance_of(rings_.about[k], frame);
  }

  // Adds weight * (blurred - sharp).
  void add(double aperture_radius_m, double focus_m, double weight, std::span<double> out) const {
    const double f = around_.focal_px[frame_.image.view] * aperture_radius_m;
    const auto disc_px = [&](double depth_m) { return f * std::abs(1 / depth_m - 1 / focus_m); };
    std::array<std::size_t, ring_count + 1> next{};
    Layers layers;
    for (std::size_t i = 0; i < frame_.picked.size(); ++i) {
      const std::uint32_t p = frame_.picked[i];
      const Rgb sky =
          frame_.state.ambient * exposure_of(frame_.state, frame_.image, frame_.number, frame_.cache.pixels[p]);
      layers.clear();
      Rgb sharp;
      for (std::size_t k = 0; k < ring_count + 1; ++k) {
        const Ring& ring = k == 0 ? rings_.own : rings_.about[k - 1];
        const auto disc = [&](double r) { return k == 0 ? own_share(r) : ring_weight(k - 1, r); };
        for (std::uint32_t part = ring.first[p]; part < ring.first[p + 1]; ++part, ++next[k]) {
          const double* at = &radiance_[k][3 * next[k]];
          const Facet& facet = ring.parts.facets[ring.parts.pixels[part].first_facet];
          const double depth_m = ring.depth_m[part];
          layers.of(facet.surface).add({at[0], at[1], at[2]}, facet.weight, disc(disc_px(depth_m)), depth_m);
          if (k == 0) sharp += {at[0], at[1], at[2]};
        }
        if (ring.sky[p] > 0) layers.of(nothing).add(sky * ring.sky[p], ring.sky[p], disc(f / focus_m), 1e30);
        if (k == 0) sharp += sky * ring.sky[p];
      }
      const Rgb change = (layers.laid() - sharp) * weight;
      for (std::size_t c = 0; c < 3; ++c) out[3 * i + c] += change[static_cast<int>(c)];
    }
  }

 private:
  static constexpr std::uint32_t nothing = 0xffffffffu;
  const Around& around_;
  const Frame& frame_;
  const Rings& rings_;
  std::array<std::vector<double>, ring_count + 1> radiance_;
};

void add(const Use& use, const Frame& frame, std::span<double> radiance) {
  const std::span<const double> a = camera_amounts(use, frame);
  if (a[0] != 0) Blur(use, frame).add(a[0], a[1], 1, radiance);
}

void slopes(const Use& use, const Frame& frame, std::span<const std::size_t> numbers, std::span<double> columns) {
  std::fill(columns.begin(), columns.end(), 0.0);
  const std::size_t rows = 3 * frame.picked.size();
  const std::span<const double> a = camera_amounts(use, frame);
  if (a.data() != use.amounts(frame.state).data()) return;  // another camera's lens
  const Blur blur(use, frame);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Number& number = use.numbers[numbers[i]];
    const double step = 1e-4 * std::max(number.start - number.neutral, 0.02 * (number.upper - number.lower));
    std::array<double, 2> above{a[0], a[1]}, below = above;
    above[numbers[i]] = std::min(a[numbers[i]] + step, number.upper);
    below[numbers[i]] = std::max(a[numbers[i]] - step, number.lower);
    const double width = above[numbers[i]] - below[numbers[i]];
    if (!(width > 0)) continue;
    blur.add(above[0], above[1], 1 / width, columns.subspan(i * rows, rows));
    blur.add(below[0], below[1], -1 / width, columns.subspan(i * rows, rows));
  }
}

}  // namespace

const Term& optics_defocus() {
  static const Term term{
      .mechanism = mechanism::optics_defocus,
      .reach = Reach::add,
      .order = 50,
      .candidates = candidates,
      .prepare = prepare,
      .add = add,
      .slopes = slopes,
  };
  return term;
}

}  // namespace gonio::relighting::terms
