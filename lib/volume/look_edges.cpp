// Edge width: all voxels of a short cylinder across the surface, fitted by a step that a normal spread function has
// smeared,
//
//   v(x) = air + step * Phi((position - n . x) / s)
//
// with n, position, s, air and step free. Voxels round a slanting plane sample the step far more densely than voxels
// are apart (the slanted edge of ISO 12233), and nothing is interpolated, which would widen what it measures.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "optim/least_squares.h"
#include "volume/look_parts.h"

namespace gonio::volume {
namespace {

constexpr double reach = 4.5, lateral = 2.2, tenth_to_ninth = 2.5631;  // Phi^-1(0.9) - Phi^-1(0.1)
constexpr std::ptrdiff_t patch_half = 5;

// air, step, position, ln s, two tilts of the normal
class PatchModel final : public optim::Model {
 public:
  explicit PatchModel(const PatchPoint& patch) : patch_(patch), basis_(patch.normal) {}
  bool residuals(const Eigen::VectorXd& x, Eigen::VectorXd& r) const override {
    if (!(std::abs(x[3]) < 3 && std::abs(x[4]) < 1 && std::abs(x[5]) < 1)) return false;
    const Vec3 n = normalized(basis_.to_world({x[4], x[5], 1}));
    const double over_s = std::exp(-x[3]) / std::sqrt(2.0);
    r.resize(static_cast<Eigen::Index>(patch_.voxels.size()));
    for (Eigen::Index k = 0; k < r.size(); ++k) {
      const auto& v = patch_.voxels[static_cast<std::size_t>(k)];
      const double along = n.x * v[0] + n.y * v[1] + n.z * v[2];
      r[k] = x[0] + x[1] * 0.5 * std::erfc((along - x[2]) * over_s) - v[3];
    }
    return true;
  }

 private:
  const PatchPoint& patch_;
  Basis basis_;
};

}  // namespace

void take_patches(const Slab& slab, const Sides& sides, Thinned<PatchPoint>& into) {
  const std::size_t w = slab.width, h = slab.height, slice = w * h;
  const auto half = static_cast<float>(sides.half());
  const auto ws = static_cast<std::ptrdiff_t>(w), ss = static_cast<std::ptrdiff_t>(slice);
  if (w <= 2 * patch_half || h <= 2 * patch_half) return;
  for (std::size_t k = slab.margin; k < slab.margin + slab.count; ++k)
    for (std::size_t j = patch_half; j + patch_half < h; ++j)
      for (std::size_t i = patch_half; i + patch_half < w; ++i) {
        const float* v = slab.values.data() + k * slice + j * w + i;
        if (!(v[0] >= half) || (v[1] >= half && v[-1] >= half && v[ws] >= half && v[-ws] >= half && v[ss] >= half &&
                                v[-ss] >= half))
          continue;
        if (!into.wants()) continue;
        Vec3 slope{};  // least squares over 5 x 5 x 5
        for (std::ptrdiff_t c = -2; c <= 2; ++c)
          for (std::ptrdiff_t b = -2; b <= 2; ++b)
            for (std::ptrdiff_t a = -2; a <= 2; ++a)
              slope += Vec3{static_cast<double>(a), static_cast<double>(b), static_cast<double>(c)} *
                       (v[c * ss + b * ws + a] / 250.0);
        if (norm(slope) < 0.04 * sides.step()) continue;
        PatchPoint patch{{static_cast<double>(i), static_cast<double>(j),
                          static_cast<double>(slab.first + k) - static_cast<double>(slab.margin)},
                         {},
                         normalized(slope) * -1};
        for (std::ptrdiff_t c = -patch_half; c <= patch_half; ++c)
          for (std::ptrdiff_t b = -patch_half; b <= patch_half; ++b)
            for (std::ptrdiff_t a = -patch_half; a <= patch_half; ++a) {
              const Vec3 d{static_cast<double>(a), static_cast<double>(b), static_cast<double>(c)};
              const double along = dot(d, patch.normal);
              if (std::abs(along) > reach || dot(d, d) - along * along > lateral * lateral) continue;
              patch.voxels.push_back({static_cast<float>(a), static_cast<float>(b), static_cast<float>(c),
                                      v[c * ss + b * ws + a]});
            }
        into.add(std::move(patch));
      }
}

PatchFit fitted(const PatchPoint& patch, const Sides& sides, double noise) {
  PatchFit result;
  Eigen::VectorXd start(6);
  start << sides.air, sides.step(), 0, std::log(0.8), 0, 0;
  optim::Limits limits;
  limits.most_steps = 30;
  limits.small_fall = {1e-8, 0};
  const optim::Fit fit = optim::fit(PatchModel(patch), start, {}, limits);
  const double rms = std::sqrt(fit.cost / static_cast<double>(patch.voxels.size())), s = std::exp(fit.x[3]);
  result.air = fit.x[0], result.step = fit.x[1];
  result.position = fit.x[2], result.width = tenth_to_ninth * s;
  // A second wall, a corner or a bend is no step: it does not fit.
  result.good = fit.descended.settled() && result.step > 0.3 * sides.step() && s > 0.15 && s < 2.5 &&
                std::abs(result.position) < 2 && std::abs(fit.x[4]) < 0.4 && std::abs(fit.x[5]) < 0.4 &&
                rms < 1.3 * noise + 0.03 * result.step;
  return result;
}

std::vector<PatchFit> all_fitted(const std::vector<PatchPoint>& patches, const Sides& sides, double noise) {
  std::vector<PatchFit> fits(patches.size());
  parallel_for(0, patches.size(), [&](std::size_t k) { fits[k] = fitted(patches[k], sides, noise); }, 16);
  return fits;
}

}  // namespace gonio::volume
