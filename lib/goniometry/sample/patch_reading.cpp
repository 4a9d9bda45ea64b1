// From the pixels of a patch to its mean (goniometry/sample/patch_reading.h).
#include "goniometry/sample/patch_reading.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "goniometry/sample/irradiance.h"
#include "goniometry/sample/patch_cells.h"
#include "photograph/saturation.h"
#include "scene/mechanisms/reference_tile.h"
#include "scene/scene.h"
#include "stats/intervals.h"

namespace gonio::goniometry {
namespace {

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
constexpr int most_cells = 8, pixels_per_cell = 8;

std::string degrees(double cosine) {
  std::ostringstream text;
  text.precision(3);
  text << std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / pi << " degrees";
  return text.str();
}

Rgb inverse_of(Rgb v) {
  return {1 / v.x, 1 / v.y, 1 / v.z};
}

// Sums over one cell or the whole patch.
struct Sums {
  Vec2 at;
  Rgb radiance, expected, variance;
  double area = 0;
  std::vector<double> ratios;  // of the pixels
  void add(const PatchPixel& pixel, Rgb l, Rgb t, Rgb var) {
    at = at + pixel.at * pixel.area_m2;
    radiance += l * pixel.area_m2;
    expected += t * pixel.area_m2;
    variance += var * (pixel.area_m2 * pixel.area_m2);
    area += pixel.area_m2;
    ratios.push_back(mean(l * inverse_of(t)));
  }
  double middle() const { return stats::median(ratios); }
};

class Reader {
 public:
  Reader(const Patch& patch, const PictureView& view, const Reflector* reflector, const PatchLimits& limits)
      : patch_(patch),
        view_(view),
        reflector_(reflector),
        limits_(limits),
        turn_(matrix_of(view.world_from_patch.rotation)),
        to_patch_(transposed(turn_)) {}

  PatchReading read() {
    PatchReading result;
    result.refusal = facing();
    if (!result.refusal.empty()) return result;
    Footprint print = footprint(patch_, *view_.camera, inverse(view_.world_from_camera) * view_.world_from_patch);
    if (view_.mask != nullptr) std::erase_if(print.pixels, [&](const PatchPixel& p) { return !counts(p); });
    result.pixels = print.pixels.size();
    result.refusal = print.refusal.empty() ? unusable(print.pixels) : print.refusal;
    if (result.refusal.empty()) gather(print.pixels);
    if (result.refusal.empty() && !(whole_.expected.x > 0 && whole_.expected.y > 0 && whole_.expected.z > 0))
      result.refusal = "no light arrives at the patch";
    if (result.refusal.empty()) finish(print.pixels, result);
    return result;
  }

 private:
  Vec3 world(Vec2 at) const { return view_.world_from_patch * Vec3{at.x, at.y, 0}; }
  // To the eye, patch's frame.
  Vec3 to_eye(Vec3 point_m) const {
    const auto& pose = view_.world_from_camera;
    const Vec3 d = view_.camera->orthographic() ? -pose.rotate({0, 0, 1}) : normalized(pose.translation_m - point_m);
    return to_patch_ * d;
  }

  bool counts(const PatchPixel& pixel) const {
    return view_.mask->counts[static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(view_.mask->width) +
                              static_cast<std::size_t>(pixel.x)] != 0;
  }

  // At the patch's middle.
  std::string facing() {
    const Vec3 middle = world(patch_.middle());
    beams_at(*view_.light, middle, beams_);
    Vec3 towards;
    for (const Beam& beam : beams_) towards += beam.direction * mean(beam.weight);
    const double cos_o = to_eye(middle).z, least = std::cos(limits_.max_theta_rad);
    if (!(norm(towards) > 0)) return "no light arrives at the patch";
    const double cos_i = (to_patch_ * normalized(towards)).z;
    const std::string limit = " from the normal (limit " + degrees(least) + ")";
    if (cos_o <= 0) return "the camera stands below the patch's horizon, " + degrees(cos_o) + " from the normal";
    if (cos_i <= 0) return "the light stands below the patch's horizon, " + degrees(cos_i) + " from the normal";
    if (cos_o < least) return "grazing: the camera stands " + degrees(cos_o) + limit;
    if (cos_i < least) return "grazing: the light stands " + degrees(cos_i) + limit;
    return {};
  }

  Rgb value(const PatchPixel& pixel, const io::Image& image) const {
    const float* at = image.data.data() + image.index(pixel.x, pixel.y, 0);
    return image.channels.size() < 3 ? Rgb{at[0], at[0], at[0]} : Rgb{at[0], at[1], at[2]};
  }

  std::string unusable(const std::vector<PatchPixel>& pixels) const {
    std::size_t no_numbers = 0, saturated = 0;
    for (const PatchPixel& pixel : pixels) {
      const Rgb v = value(pixel, view_.picture->colour);
      if (!is_finite(v)) ++no_numbers;
      const std::size_t at = static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(view_.picture->colour.width) +
                             static_cast<std::size_t>(pixel.x);
      if (view_.picture->clipped[at] != 0 || photograph::at_full_scale(max_component(v), view_.full_scale)) ++saturated;
    }
    const std::string of = " of its " + std::to_string(pixels.size()) + " pixels ";
    if (no_numbers > 0) return std::to_string(no_numbers) + of + "are no numbers";
    if (saturated > 0) return "saturated: " + std::to_string(saturated) + of + "are at full scale";
    if (pixels.size() < limits_.min_pixels)
      return "too few pixels: " + std::to_string(pixels.size()) + " lie wholly on the patch (limit " +
             std::to_string(limits_.min_pixels) + ")";
    return {};
  }

  Rgb variance(const PatchPixel& pixel, Rgb v) const {
    if (!view_.picture->variance.data.empty()) return value(pixel, view_.picture->variance);
    if (!view_.noise) return {not_known, not_known, not_known};
    const double read = view_.noise->read * view_.noise->read;
    const auto of = [&](double x) { return (view_.noise->gain > 0 ? std::max(0.0, x) / view_.noise->gain : 0) + read; };
    return {of(v.x), of(v.y), of(v.z)};
  }

  void gather(const std::vector<PatchPixel>& pixels) {
    const int side =
        std::clamp(static_cast<int>(std::sqrt(static_cast<double>(pixels.size()) / pixels_per_cell)), 3, most_cells);
    cells_.assign(static_cast<std::size_t>(side * side), {});
    for (const PatchPixel& pixel : pixels) {
      const Vec3 point_m = world(pixel.at), wo = to_eye(point_m);
      beams_at(*view_.light, point_m, beams_);
      Rgb expected;
      for (const Beam& beam : beams_) {
        const Vec3 wi = to_patch_ * beam.direction;
        if (wi.z <= 0) continue;
        const Rgb arrives = beam.weight * wi.z;
        expected += reflector_ == nullptr ? arrives : arrives * (*reflector_)(wo, wi);
        add_directions(wi, wo, mean(arrives) * pixel.area_m2, pixel.area_m2);
      }
      if (view_.picture->colour.channels.size() < 3) expected = Rgb{1, 1, 1} * mean(expected);
      const Rgb v = value(pixel, view_.picture->colour);
      const Rgb per =
          inverse_of(view_.gain * scene::vignetting(view_.falloff, view_.picture->colour.width,
                                                    view_.picture->colour.height, {1.0 * pixel.x, 1.0 * pixel.y}));
      const Rgb l = (v - Rgb{1, 1, 1} * view_.black) * per, var = variance(pixel, v) * per * per;
      whole_.add(pixel, l, expected, var);
      cells_[cell(pixel.at, side)].add(pixel, l, expected, var);
    }
  }

  std::size_t cell(Vec2 at, int side) const {
    const auto step = [&](double x) {
      return static_cast<std::size_t>(
          std::clamp(static_cast<int>(side * (x / patch_.extent_m() + 1) / 2), 0, side - 1));
    };
    return step(at.y - patch_.middle().y) * static_cast<std::size_t>(side) + step(at.x - patch_.middle().x);
  }

  void add_directions(Vec3 wi, Vec3 wo, double arrives, double area) {
    wi_ += wi * arrives, wo_ += wo * area;
    arrives_ += arrives, seen_ += area;
  }

  std::vector<PatchCell> cells() const {
    std::vector<PatchCell> result;
    for (const Sums& sums : cells_) {
      if (!(sums.area > 0.02 * whole_.area / static_cast<double>(cells_.size()))) continue;
      const Rgb per = inverse_of(sums.expected);
      result.push_back({(sums.at * (1 / sums.area) - patch_.middle()) * (1 / patch_.extent_m()), sums.radiance * per,
                        sums.variance * per * per, sums.expected * inverse_of(whole_.expected), sums.middle()});
    }
    return result;
  }

  void finish(const std::vector<PatchPixel>&, PatchReading& result) const {
    // Of unit vectors with the mean m, the mean square distance from m / |m| is 2 (1 - |m|).
    result.wi = normalized(wi_), result.wo = normalized(wo_);
    result.spread_i_rad = std::sqrt(std::max(0.0, 2 * (1 - norm(wi_) / arrives_)));
    result.spread_o_rad = std::sqrt(std::max(0.0, 2 * (1 - norm(wo_) / seen_)));
    const Rgb per = inverse_of(whole_.expected);
    result.ratio = whole_.radiance * per;
    const std::vector<PatchCell> parts = cells();
    const Outlying outlying = outlying_cells(parts);
    result.cells = static_cast<int>(parts.size());
    result.outlying = outlying.count, result.farthest = outlying.farthest;
    set_sigma(whole_.variance * per * per, scatter_of(parts), result);
  }

  static void set_sigma(Rgb noise, const Scatter& scatter, PatchReading& result) {
    if (std::isnan(noise.x)) {
      result.scatter = not_known;
      const Rgb v = scatter.variance;
      const double none = scatter.degrees > 0 ? 0 : not_known;
      result.sigma = {std::sqrt(v.x + none), std::sqrt(v.y + none), std::sqrt(v.z + none)};
      return;
    }
    const double excess = 1 + 3.09 * std::sqrt(2.0 / std::max(1, scatter.degrees));  // 1 in 1000
    const auto larger = [&](double n, double s) { return std::sqrt(scatter.degrees > 0 && s > excess * n ? s : n); };
    result.sigma = {larger(noise.x, scatter.variance.x), larger(noise.y, scatter.variance.y),
                    larger(noise.z, scatter.variance.z)};
    result.scatter = scatter.degrees > 0 && mean(noise) > 0 ? std::sqrt(mean(scatter.variance) / mean(noise)) : 1;
  }

  const Patch& patch_;
  const PictureView& view_;
  const Reflector* reflector_;
  const PatchLimits& limits_;
  Mat3 turn_, to_patch_;
  std::vector<Beam> beams_;
  Sums whole_;
  std::vector<Sums> cells_;
  Vec3 wi_, wo_;
  double arrives_ = 0, seen_ = 0;
};

}  // namespace

Rgb Reflector::operator()(Vec3 wo, Vec3 wi) const {
  surface::Values values = outer.values;
  if (base.model != nullptr) values.base = &base;
  return outer.model->evaluate(values, wo, wi) * (scale / equation::reference_tile(falls_in, falls_out, wi.z, wo.z));
}

PatchReading read_patch(const Patch& patch, const PictureView& view, const Reflector* reflector,
                        const PatchLimits& limits) {
  return Reader(patch, view, reflector, limits).read();
}

}  // namespace gonio::goniometry
