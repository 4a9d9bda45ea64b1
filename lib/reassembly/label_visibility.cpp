// A depth buffer for any camera model: faces are halved until lens and perspective are straight within them.
#include "reassembly/label_visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonio::reassembly {
namespace {

constexpr double most_pixels = 3e6;
constexpr int most_halvings = 8;
constexpr float nothing = -std::numeric_limits<float>::infinity();

}  // namespace

Visibility::Visibility(const io::TriangleMesh& mesh, const LabelView& view)
    : view_(&view), camera_from_world_(inverse(view.world_from_camera)) {
  const double pixels = static_cast<double>(view.camera->width_px()) * view.camera->height_px();
  coarse_ = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / most_pixels))));
  width_ = (view.camera->width_px() + coarse_ - 1) / coarse_;
  height_ = (view.camera->height_px() + coarse_ - 1) / coarse_;
  for (const Vec2 at : {view.camera->principal_point_px(), Vec2{0, 0}}) {
    const camera::Ray one = view.camera->ray(at), other = view.camera->ray(at + Vec2{1, 0});
    const Vec3 step = view.camera->orthographic() ? other.origin_m - one.origin_m : other.direction - one.direction;
    pixel_ = std::max(pixel_, norm(step) * coarse_);
  }
  depth_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), nothing);
  std::vector<Corner> corners(mesh.positions_m.size());
  const Mat3 rotation = matrix_of(camera_from_world_.rotation);
  for (std::size_t v = 0; v < corners.size(); ++v)
    corners[v] = corner(rotation * mesh.positions_m[v] + camera_from_world_.translation_m);
  for (const auto& t : mesh.triangles) draw(corners[t[0]], corners[t[1]], corners[t[2]], 0);
}

Visibility::Corner Visibility::corner(Vec3 camera_m) const {
  Corner result{camera_m, {}, view_->camera->orthographic() ? -camera_m.z : 1 / std::max(norm(camera_m), 1e-12)};
  if (const auto pixel = view_->camera->project(camera_m); pixel && is_finite({pixel->x, pixel->y, 0})) {
    // Pixel (0, 0) of the coarse picture covers the first `coarse` x `coarse` of the fine one.
    result.pixel = {(pixel->x + 0.5) / coarse_ - 0.5, (pixel->y + 0.5) / coarse_ - 0.5};
    result.seen = true;
  }
  return result;
}

// Does the middle of an edge lie where the middles of its ends say?
bool Visibility::even(const Corner& a, const Corner& b) const {
  const Corner middle = corner((a.point_m + b.point_m) * 0.5);
  if (!middle.seen) return false;
  const double expected = (a.depth + b.depth) / 2;
  // Between two pixels of a picture the middle in space is not the middle in the picture: what counts is its distance
  // from the line, and the depth there.
  const Vec2 way = b.pixel - a.pixel, off = middle.pixel - a.pixel;
  const double length = norm(way);
  if (length < 2) return true;
  if (std::abs(way.x * off.y - way.y * off.x) / length > 0.25) return false;
  const double t = dot(off, way) / (length * length);
  const double between = a.depth + t * (b.depth - a.depth);
  return std::abs(between - middle.depth) < 1e-3 * std::abs(expected);
}

void Visibility::draw(const Corner& a, const Corner& b, const Corner& c, int deep) {
  if (!a.seen && !b.seen && !c.seen && deep > 2) return;
  const bool all = a.seen && b.seen && c.seen;
  if (all) {
    const auto [left, right] = std::minmax({a.pixel.x, b.pixel.x, c.pixel.x});
    const auto [high, low] = std::minmax({a.pixel.y, b.pixel.y, c.pixel.y});
    if (right < -1 || low < -1 || left > width_ || high > height_) return;
    if (right - left < 4 && low - high < 4) return fill(a, b, c);
    if (even(a, b) && even(b, c) && even(c, a)) return fill(a, b, c);
  }
  if (deep == most_halvings) return all ? fill(a, b, c) : void();
  const Corner ab = corner((a.point_m + b.point_m) * 0.5), bc = corner((b.point_m + c.point_m) * 0.5),
               ca = corner((c.point_m + a.point_m) * 0.5);
  draw(a, ab, ca, deep + 1);
  draw(ab, b, bc, deep + 1);
  draw(ca, bc, c, deep + 1);
  draw(ab, bc, ca, deep + 1);
}

void Visibility::fill(const Corner& a, const Corner& b, const Corner& c) {
  const double area =
      (b.pixel.x - a.pixel.x) * (c.pixel.y - a.pixel.y) - (b.pixel.y - a.pixel.y) * (c.pixel.x - a.pixel.x);
  if (!(std::abs(area) > 1e-12)) return;
  const auto whole = [](double v, int most) { return std::clamp(static_cast<int>(v), 0, most); };
  const int first_x = whole(std::ceil(std::min({a.pixel.x, b.pixel.x, c.pixel.x})), width_ - 1);
  const int last_x = whole(std::floor(std::max({a.pixel.x, b.pixel.x, c.pixel.x})), width_ - 1);
  const int first_y = whole(std::ceil(std::min({a.pixel.y, b.pixel.y, c.pixel.y})), height_ - 1);
  const int last_y = whole(std::floor(std::max({a.pixel.y, b.pixel.y, c.pixel.y})), height_ - 1);
  for (int y = first_y; y <= last_y; ++y)
    for (int x = first_x; x <= last_x; ++x) {
      const double wa = ((b.pixel.x - x) * (c.pixel.y - y) - (b.pixel.y - y) * (c.pixel.x - x)) / area;
      const double wb = ((c.pixel.x - x) * (a.pixel.y - y) - (c.pixel.y - y) * (a.pixel.x - x)) / area;
      const double wc = 1 - wa - wb;
      if (wa < -1e-9 || wb < -1e-9 || wc < -1e-9) continue;
      float& here =
          depth_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
      here = std::max(here, static_cast<float>(wa * a.depth + wb * b.depth + wc * c.depth));
    }
}

std::optional<Visibility::Seen> Visibility::sees(Vec3 point_m, Vec3 normal) const {
  const Corner at = corner(camera_from_world_ * point_m);
  if (!at.seen) return {};
  const bool parallel = view_->camera->orthographic();
  const Vec3 towards = camera_from_world_.rotate(normal);
  const double cosine = parallel ? -towards.z : -dot(towards, at.point_m) * at.depth;
  if (!(cosine > 0.1)) return {};
  const int x = static_cast<int>(std::floor(at.pixel.x + 0.5)), y = static_cast<int>(std::floor(at.pixel.y + 0.5));
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return {};
  // How much depth one pixel spans on this face.
  const double distance_m = norm(at.point_m);
  const double footprint_m = parallel ? pixel_ : distance_m * pixel_;
  const double slope = std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine;
  const double allowed_m = footprint_m * (1 + 1.5 * slope) + 1e-6 * distance_m;
  Seen seen;
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= width_ || y + dy >= height_) continue;
      const float depth = depth_[static_cast<std::size_t>(y + dy) * static_cast<std::size_t>(width_) +
                                 static_cast<std::size_t>(x + dx)];
      // Beside the point its own surface comes nearer by its slope, and by the bends of what it belongs to.
      const int reach = std::max(std::abs(dx), std::abs(dy));
      const double bend_m = allowed_m * (1 + 3 * reach);
      if (depth == nothing) {
        seen.at_edge = seen.at_edge || reach <= 1;
        continue;
      }
      const double there = static_cast<double>(depth);
      const double nearer_m = parallel ? there - at.depth : distance_m - 1 / there;
      if (nearer_m > bend_m) return {};
      seen.at_edge = seen.at_edge || (reach <= 1 && -nearer_m > bend_m);
    }
  seen.pixel = {(at.pixel.x + 0.5) * coarse_ - 0.5, (at.pixel.y + 0.5) * coarse_ - 0.5};
  seen.cosine = cosine;
  return seen;
}

}  // namespace gonio::reassembly
