// Positions closer than 1e-9 px to a whole pixel are that pixel: a lens without distortion then changes no bit.
#include "camera/undistort.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "manifest/sections/camera.h"

namespace gonio::camera {
namespace {

constexpr double whole_px = 1e-9;
constexpr double most_pixels = 268435456;  // 2^28
constexpr int border_samples = 400;        // along each side
constexpr double spare_px = 0.01;          // between them the border may bend by less
constexpr std::size_t most_channels = 24;

// Ray through a pixel position as (x / z, y / z); nothing where the lens cannot be inverted or the angle is too large.
std::optional<Vec2> on_plane(const CameraModel& lens, Vec2 pixel, double largest_angle_rad) {
  const Vec3 d = lens.ray(pixel).direction;
  if (!(d.z > 0) || std::atan2(std::hypot(d.x, d.y), d.z) > largest_angle_rad) return std::nullopt;
  const auto back = lens.project(d);
  if (!back || norm(*back - pixel) > 1e-6) return std::nullopt;
  return Vec2{d.x / d.z, d.y / d.z};
}

// The farthest point from `inside` towards `border` that a pinhole can show.
Vec2 reached(const CameraModel& lens, Vec2 inside, Vec2 border, double largest_angle_rad) {
  if (const auto at = on_plane(lens, border, largest_angle_rad)) return *at;
  double low = 0, high = 1;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (on_plane(lens, inside + (border - inside) * middle, largest_angle_rad) ? low : high) = middle;
  }
  return on_plane(lens, inside + (border - inside) * low, largest_angle_rad).value_or(Vec2{});
}

struct Bounds {
  double left = 0, right = 0, top = 0, bottom = 0;
};

// Of the plane z = 1: the largest rectangle within the border's image (valid), or the smallest around it.
Bounds bounds_of(const CameraModel& lens, const PinholeChoice& choice) {
  const bool valid = choice.keep == Keep::valid;
  const double reach = kernel_radius(choice.kernel) * std::max(1.0, 1 / choice.scale) - 1;  // on a filter's lattice
  const double margin = valid ? choice.pitch * reach + choice.pitch - 1 + spare_px : 0;
  const double x0 = margin, x1 = lens.width_px() - 1 - margin, y0 = margin, y1 = lens.height_px() - 1 - margin;
  const Vec2 centre = lens.principal_point_px();
  const Vec2 inside{std::clamp(centre.x, x0, std::max(x0, x1)), std::clamp(centre.y, y0, std::max(y0, y1))};
  constexpr double infinite = std::numeric_limits<double>::infinity();
  Bounds b =
      valid ? Bounds{-infinite, infinite, -infinite, infinite} : Bounds{infinite, -infinite, infinite, -infinite};
  const auto outer = [&](Vec2 p) {
    b = {std::min(b.left, p.x), std::max(b.right, p.x), std::min(b.top, p.y), std::max(b.bottom, p.y)};
  };
  for (int i = 0; i <= border_samples; ++i) {
    const double t = static_cast<double>(i) / border_samples, x = x0 + t * (x1 - x0), y = y0 + t * (y1 - y0);
    const auto at = [&](double px, double py) { return reached(lens, inside, {px, py}, choice.largest_angle_rad); };
    const Vec2 left = at(x0, y), right = at(x1, y), top = at(x, y0), bottom = at(x, y1);
    if (valid) {
      b = {std::max(b.left, left.x), std::min(b.right, right.x), std::max(b.top, top.y), std::min(b.bottom, bottom.y)};
    } else {
      for (const Vec2& p : {left, right, top, bottom}) outer(p);
    }
  }
  return b;
}

// Whole pixels in `extent` focal lengths; inside rounds down, outside up, with 1e-6 px for rounding.
int pixels_in(double extent_px, bool inside) {
  return static_cast<int>(inside ? std::floor(extent_px + 1e-6) : std::ceil(extent_px - 1e-6)) + 1;
}

struct Taps {
  int first = 0, count = 0;
  std::array<double, 64> weights{};
};

Taps taps_at(double position, const Resampling& resampling) {
  Taps taps;
  const double nearest = std::round(position);
  if (std::abs(position - nearest) < whole_px) position = nearest;
  const double radius = kernel_radius(resampling.kernel) * resampling.stretch;
  taps.first = static_cast<int>(std::floor(position - radius)) + 1;
  const int last = static_cast<int>(std::ceil(position + radius)) - 1;
  taps.count = std::min(last - taps.first + 1, static_cast<int>(taps.weights.size()));
  double sum = 0;
  for (int i = 0; i < taps.count; ++i) {
    double& w = taps.weights[static_cast<std::size_t>(i)];
    w = kernel_weight(resampling.kernel, (taps.first + i - position) / resampling.stretch);
    sum += w;
  }
  double moment = 0;
  for (int i = 0; i < taps.count; ++i) {
    double& w = taps.weights[static_cast<std::size_t>(i)];
    w /= sum;
    moment += w * (taps.first + i - position);
  }
  // The first moment of a Lanczos or widened kernel is not zero, which shifts edges by up to 0.03 px: it is moved to
  // the two samples around the position.
  const double below = std::floor(position);
  if (below == position || (resampling.kernel != Kernel::lanczos3 && resampling.stretch == 1)) return taps;
  const auto at = static_cast<std::size_t>(static_cast<int>(below) - taps.first);
  taps.weights[at] += moment;
  taps.weights[at + 1] -= moment;
  return taps;
}

// One pixel: the sums over its footprint.
class Footprint {
 public:
  Footprint(const io::Image& source, const std::vector<std::uint8_t>& good, const Resampling& resampling)
      : source_(source), good_(good), resampling_(resampling), channels_(source.channels.size()) {
    for (const std::string& name : source.channels) variance_.push_back(name.starts_with("variance."));
  }
  // Writes the channels to `out`; true where the pixel is valid. `phase_x`, `phase_y`: which filter it stands behind.
  bool sum(Vec2 at, int phase_x, int phase_y, float* out) const {
    const int pitch = resampling_.pitch;
    const Taps x = taps_at((at.x - phase_x) / pitch, resampling_), y = taps_at((at.y - phase_y) / pitch, resampling_);
    const int last_x = (source_.width - 1 - phase_x) / pitch, last_y = (source_.height - 1 - phase_y) / pitch;
    std::array<double, most_channels> sums{}, low{}, high{};
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    bool valid = true;
    for (int j = 0; j < y.count; ++j) {
      for (int i = 0; i < x.count; ++i) {
        const double w = x.weights[static_cast<std::size_t>(i)] * y.weights[static_cast<std::size_t>(j)];
        if (w == 0) continue;
        const int px = x.first + i, py = y.first + j;
        const int cx = std::clamp(px, 0, last_x), cy = std::clamp(py, 0, last_y);
        const std::size_t pixel = source_.index(phase_x + pitch * cx, phase_y + pitch * cy, 0);
        valid = valid && px == cx && py == cy && (good_.empty() || good_[pixel / channels_] != 0);
        for (std::size_t c = 0; c < channels_; ++c) {
          const double v = source_.data[pixel + c];
          sums[c] += (variance_[c] ? w * w : w) * v;
          low[c] = std::min(low[c], v);
          high[c] = std::max(high[c], v);
        }
      }
    }
    for (std::size_t c = 0; c < channels_; ++c) {
      const bool limit = resampling_.limit_overshoot && !variance_[c] && low[c] <= high[c];
      out[c] = static_cast<float>(limit ? std::clamp(sums[c], low[c], high[c]) : sums[c]);
      valid = valid && std::isfinite(out[c]);
    }
    return valid;
  }

 private:
  const io::Image& source_;
  const std::vector<std::uint8_t>& good_;
  const Resampling& resampling_;
  std::size_t channels_;
  std::vector<char> variance_;
};

}  // namespace

double kernel_radius(Kernel kernel) {
  return kernel == Kernel::lanczos3 ? 3 : 2;
}

double kernel_weight(Kernel kernel, double distance_px) {
  const double t = std::abs(distance_px);
  if (t >= kernel_radius(kernel)) return 0;
  switch (kernel) {
    case Kernel::keys: return t < 1 ? 1 + t * t * (1.5 * t - 2.5) : 2 + t * (-4 + t * (2.5 - 0.5 * t));
    case Kernel::mitchell:
      return t < 1 ? 8.0 / 9 + t * t * (7.0 / 6 * t - 2) : 16.0 / 9 + t * (-10.0 / 3 + t * (2 - 7.0 / 18 * t));
    case Kernel::lanczos3: break;
  }
  if (t == std::floor(t)) return t == 0 ? 1 : 0;
  return 3 * std::sin(pi * t) * std::sin(pi * t / 3) / (pi * pi * t * t);
}

manifest::Camera pinhole_for(const manifest::Camera& camera, const PinholeChoice& choice, const std::string& place) {
  const CameraModel lens(camera, place);
  const Intrinsics numbers = intrinsics_of(camera, place);
  const bool plain = camera.model == "pinhole" && numbers.fx_px == numbers.fy_px;
  manifest::Camera result;
  result.model = "pinhole";
  if (choice.pitch > 1) result.mosaic = camera.mosaic;
  result.width_px = camera.width_px;
  result.height_px = camera.height_px;
  result.fx_px = numbers.fx_px * choice.scale;
  result.fy_px = numbers.fy_px * choice.scale;
  result.cx_px = (numbers.cx_px + 0.5) * choice.scale - 0.5;
  result.cy_px = (numbers.cy_px + 0.5) * choice.scale - 0.5;
  if (plain && choice.scale == 1) return result;
  double width = std::round(camera.width_px * choice.scale), height = std::round(camera.height_px * choice.scale);
  if (choice.keep != Keep::same) {
    const double f = choice.scale * std::sqrt(numbers.fx_px * numbers.fy_px);
    const Bounds b = bounds_of(lens, choice);
    const bool inside = choice.keep == Keep::valid;
    if (!(b.right > b.left && b.bottom > b.top))
      throw Error(Exit::data, place, "has no rectangle of valid pixels", "use --keep all, or a smaller --max-angle");
    width = f * (b.right - b.left) < most_pixels ? pixels_in(f * (b.right - b.left), inside) : most_pixels;
    height = f * (b.bottom - b.top) < most_pixels ? pixels_in(f * (b.bottom - b.top), inside) : most_pixels;
    // The spare fraction of a pixel is shared by both sides.
    result.fx_px = f;
    result.fy_px = f;
    result.cx_px = 0.5 * (width - 1 - f * (b.left + b.right));
    result.cy_px = 0.5 * (height - 1 - f * (b.top + b.bottom));
  }
  if (!(width >= 1 && height >= 1 && width * height <= most_pixels))
    throw Error(Exit::data, place,
                "would become a picture of " + std::to_string(std::lround(width)) + " x " +
                    std::to_string(std::lround(height)) + " pixels",
                "use --keep valid, a smaller --scale or a smaller --max-angle");
  result.width_px = static_cast<int>(width);
  result.height_px = static_cast<int>(height);
  return result;
}

Undistorted undistort(const io::Image& source, const std::vector<std::uint8_t>& good, const CameraModel& from,
                      const CameraModel& to, const Resampling& resampling) {
  if (source.channels.size() > most_channels) throw Error(Exit::data, "picture", "has more than 24 channels");
  if (source.width < resampling.pitch || source.height < resampling.pitch)
    throw Error(Exit::data, "picture", "is smaller than its mosaic of filters");
  Undistorted result;
  result.picture = io::Image(to.width_px(), to.height_px(), source.channels);
  result.valid.assign(result.picture.pixels(), 0);
  const Footprint footprint(source, good, resampling);
  const auto width = static_cast<std::size_t>(to.width_px());
  parallel_for(
      0, static_cast<std::size_t>(to.height_px()),
      [&](std::size_t y) {
        for (std::size_t x = 0; x < width; ++x) {
          const auto at = from.project(to.ray({static_cast<double>(x), static_cast<double>(y)}).direction);
          const bool meets =
              at && at->x >= -0.5 && at->y >= -0.5 && at->x <= source.width - 0.5 && at->y <= source.height - 0.5;
          if (!meets) continue;
          const std::size_t pixel = y * width + x;
          float* out = &result.picture.data[pixel * source.channels.size()];
          const int phase_x = static_cast<int>(x) % resampling.pitch, phase_y = static_cast<int>(y) % resampling.pitch;
          result.valid[pixel] = footprint.sum(*at, phase_x, phase_y, out) ? 1 : 0;
        }
      },
      8);
  return result;
}

}  // namespace gonio::camera
