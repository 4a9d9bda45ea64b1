// sensor.clipped-resampling: what native pixels lost beyond full scale is taken from the mean over the box that made
// the picture's pixel of them (render/mechanisms/sensor_clipped_resampling.h). Of the eight pixels around, which the
// cache does not hold, the base model's prediction stands for the reading.
#include "render/mechanisms/sensor_clipped_resampling.h"

#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/recast.h"
#include "relighting/uses.h"
#include "render/mechanisms/sensor_saturation.h"

namespace gonio::relighting::terms {
namespace {

constexpr std::size_t least_readings = 20;  // as for sensor.saturation
constexpr CacheOptions coarse{.samples = 4, .paths = 0, .patches = 1, .penumbrae = false, .seed = 11};

struct Neighbours final : Prepared {
  struct One {
    int dx = 0, dy = 0;
    std::vector<ViewCache> views;
    std::vector<std::vector<float>> sums;
  };
  std::vector<One> all;
};

std::shared_ptr<const Prepared> prepare(const Setting& s, const Use&) {
  auto result = std::make_shared<Neighbours>();
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == 0 && dy == 0) continue;
      Neighbours::One one{dx, dy, {}, {}};
      for (std::size_t v = 0; v < s.model.views(); ++v) {
        std::vector<std::array<int, 2>> beside;
        for (const Pixel& p : s.model.cache(v).pixels) beside.push_back({p.x + dx, p.y + dy});
        one.views.push_back(
            build_cache(s.caster, s.recordings.views[v], s.layout.lights, s.model.monomials(), beside, coarse));
        lend_indirect(s.model.cache(v), one.views.back());
        one.sums.push_back(facet_sums(one.views.back()));
      }
      result->all.push_back(std::move(one));
    }
  return result;
}

std::vector<Use> candidates(const Setting& s) {
  const double full = largest_value(s.recordings);
  if (readings_near(s.recordings, full) < least_readings) return {};
  std::vector<Use> uses = camera_uses(s, mechanism::sensor_clipped_resampling());
  for (Use& use : uses) {
    use.family = "full scale of " + use.on[0];
    use.numbers[0].start = full;
    use.numbers[0].lower = 0.5 * full;
    use.numbers[0].upper = 1.2 * full;
    use.numbers[1].neutral = use.numbers[1].start;  // without a limit no width counts
  }
  return uses;
}

void record(const Use& use, const Frame& frame, std::span<double> values) {
  const std::span<const double> a = camera_amounts(use, frame);
  const double full_scale = a[0], width_px = a[1];
  if (!(full_scale > 0)) return;
  const std::size_t v = frame.image.view;
  const double own = equation::sensor_clipped_resampling(0, width_px);
  for (double& value : values) value = own * own * equation::sensor_saturation(value, full_scale);
  std::vector<double> beside(values.size());
  for (const Neighbours::One& n : static_cast<const Neighbours&>(*use.prepared).all) {
    const double weight =
        equation::sensor_clipped_resampling(n.dx, width_px) * equation::sensor_clipped_resampling(n.dy, width_px);
    if (weight == 0) continue;
    frame.model.predict_from(n.views[v], n.sums[v], frame.state, frame.number, frame.picked, beside);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] += weight * equation::sensor_saturation(beside[i], full_scale);
  }
}

}  // namespace

const Term& sensor_clipped_resampling() {
  static const Term term{
      .mechanism = mechanism::sensor_clipped_resampling,
      .reach = Reach::record,
      .order = 100,
      .candidates = candidates,
      .prepare = prepare,
      .record = record,
  };
  return term;
}

}  // namespace gonio::relighting::terms
