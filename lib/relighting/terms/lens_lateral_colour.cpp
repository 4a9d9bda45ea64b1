// lens.lateral-colour: red and blue are seen where green shows what lies nearer to the axis, or further
// (relighting/shifted_views.h).
#include "camera/mechanisms/lens_lateral_colour.h"

#include <algorithm>
#include <cmath>

#include "relighting/shifted_views.h"

namespace gonio::mechanism {
const Mechanism& lens_lateral_colour();
}

namespace gonio::relighting::terms {
namespace {

Vec2 green_place(const camera::CameraModel& camera, std::span<const double> a, Vec2 pixel, std::size_t channel) {
  return equation::lens_lateral_colour_pixel(camera.intrinsics(), a, pixel, channel);
}

// Bounds and starts by what they move the corner of the picture.
std::vector<Use> candidates(const Setting& s) {
  std::vector<Use> uses;
  if (std::ranges::all_of(s.recordings.images, [](const Recording& image) { return image.grey; })) return uses;
  for (const View& view : s.recordings.views) {
    const bool known = std::ranges::any_of(
        uses, [&](const Use& use) { return std::ranges::find(use.on, view.camera) != use.on.end(); });
    if (known || view.model.orthographic() || switched_on(s.document, mechanism::lens_lateral_colour().id, view.camera))
      continue;
    const camera::Intrinsics& lens = view.model.intrinsics();
    const double corner_px = 0.5 * std::hypot(view.model.width_px(), view.model.height_px());
    const double corner = corner_px / lens.fx_px;
    Use use = target_use(mechanism::lens_lateral_colour(), {view.camera}, {0}, true);
    for (std::size_t k = 0; k < use.numbers.size(); ++k) {
      Number& n = use.numbers[k];
      const double per_px = 1 / (k % 2 == 0 ? corner_px : corner_px * corner * corner);
      n.start = std::min(0.5 * per_px, 0.5 * n.upper);
      n.upper = std::min(n.upper, 15 * per_px);
      n.lower = std::max(n.lower, -15 * per_px);
      if (k % 2 == 1 && corner < 0.8) n.free = false, n.start = n.neutral;  // the linear part says it all
    }
    uses.push_back(std::move(use));
  }
  return uses;
}

}  // namespace

const Term& lens_lateral_colour() {
  static const Term term = [] {
    Term t = shifted_term(mechanism::lens_lateral_colour, candidates);
    t.add = [](const Use& use, const Frame& frame, std::span<double> radiance) {
      add_shifted(use, frame, radiance, green_place);
    };
    t.slopes = [](const Use& use, const Frame& frame, std::span<const std::size_t> numbers, std::span<double> columns) {
      shifted_slopes(use, frame, numbers, columns, green_place);
    };
    return t;
  }();
  return term;
}

}  // namespace gonio::relighting::terms
