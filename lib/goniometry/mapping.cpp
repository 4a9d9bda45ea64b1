// Places of a table and the coordinates they fold into.
#include "goniometry/mapping.h"

#include "surface/half_angle.h"

namespace gonio::goniometry {
namespace {

struct Between {
  std::size_t low, high;
  double share;  // of `high`
};

Between clamped(double x, std::size_t count) {
  const double c = std::clamp(x - 0.5, 0.0, static_cast<double>(count - 1));
  const auto low = std::min(static_cast<std::size_t>(c), count - 2);
  return {low, low + 1, c - static_cast<double>(low)};
}

Between wrapped(double x, std::size_t count) {
  const double c = x < 0.5 ? x - 0.5 + static_cast<double>(count) : x - 0.5;
  const auto low = std::min(static_cast<std::size_t>(c), count - 1);
  return {low, low + 1 == count ? 0 : low + 1, c - static_cast<double>(low)};
}

surface::HalfAngles middle(const Bins& bins, std::size_t h, std::size_t d, std::size_t p) {
  const double u = (static_cast<double>(h) + 0.5) / static_cast<double>(bins[0]);
  return {u * u * pi / 2, (static_cast<double>(d) + 0.5) / static_cast<double>(bins[1]) * pi / 2,
          (static_cast<double>(p) + 0.5) / static_cast<double>(bins[2]) * pi};
}

}  // namespace

Cells::Cells(const Bins& bins) : bins_(bins) {
  index_.assign(bins[0] * bins[1] * folded(), none);
  for (std::size_t h = 0; h < bins[0]; ++h) {
    ring_begin_.push_back(weight_.size());
    for (std::size_t d = 0; d < bins[1]; ++d)
      for (std::size_t p = 0; p < folded(); ++p) {
        const auto [wo, wi] = surface::directions_of(middle(bins, h, d, p));
        if (wo.z <= 0 || wi.z <= 0) continue;
        const std::size_t place = (h * bins[1] + d) * folded() + p;
        index_[place] = static_cast<std::uint32_t>(weight_.size());
        place_.push_back(static_cast<std::uint32_t>(place));
        weight_.push_back(static_cast<float>(cosine_weight(wi, wo)));
      }
  }
  ring_begin_.push_back(weight_.size());
}

Cells::Pair Cells::directions(std::size_t cell) const {
  const std::size_t place = place_.at(cell), row = place / folded();
  const auto [wo, wi] = surface::directions_of(middle(bins_, row / bins_[1], row % bins_[1], place % folded()));
  return {wo, wi};
}

std::uint32_t Cells::cell_of(std::size_t h, std::size_t d, std::size_t p) const {
  return index_[(h * bins_[1] + d) * folded() + std::min(p, bins_[2] - 1 - p)];
}

// At the horizon: the next with smaller theta_d, else larger, else the ring inside.
std::uint32_t Cells::nearest(std::size_t h, std::size_t d, std::size_t p) const {
  for (std::size_t ring = h + 1; ring-- > 0;) {
    for (std::size_t k = d + 1; k-- > 0;)
      if (const auto cell = cell_of(ring, k, p); cell != none) return cell;
    for (std::size_t k = d + 1; k < bins_[1]; ++k)
      if (const auto cell = cell_of(ring, k, p); cell != none) return cell;
  }
  return 0;
}

Cells::Blend Cells::blend(Vec3 wo, Vec3 wi) const {
  const surface::HalfAngles at = surface::half_angles(wo, wi);
  const auto count = [&](std::size_t i) { return static_cast<double>(bins_[i]); };
  const Between h = clamped(count(0) * std::sqrt(at.theta_h * (2 / pi)), bins_[0]);
  const Between d = clamped(count(1) * at.theta_d * (2 / pi), bins_[1]);
  const Between p = wrapped(count(2) * at.phi_d / pi, bins_[2]);
  Blend blend;
  for (std::size_t k = 0; k < 8; ++k) {
    const bool hh = k & 4, dh = k & 2, ph = k & 1;
    blend.share[k] = (hh ? h.share : 1 - h.share) * (dh ? d.share : 1 - d.share) * (ph ? p.share : 1 - p.share);
    blend.cell[k] = nearest(hh ? h.high : h.low, dh ? d.high : d.low, ph ? p.high : p.low);
  }
  return blend;
}

}  // namespace gonio::goniometry
