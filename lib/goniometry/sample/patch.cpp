// Pixels on a flat patch (goniometry/sample/patch.h).
#include "goniometry/sample/patch.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "manifest/sections/flat_patch.h"

namespace gonio::goniometry {
namespace {

constexpr int disc_corners = 96, edge_parts = 16;

double cross2(Vec2 a, Vec2 b) {
  return a.x * b.y - a.y * b.x;
}

std::vector<Vec2> polygon_of(const manifest::FlatPatch& entry, const std::string& place) {
  std::vector<Vec2> corners;
  if (entry.radius_m) {
    if (!entry.centre_m.empty() && entry.centre_m.size() != 2)
      throw Error(Exit::data, place + "/centre_m", "is no pair of numbers", "give [x, y] in metres");
    const Vec2 centre = entry.centre_m.empty() ? Vec2{} : Vec2{entry.centre_m[0], entry.centre_m[1]};
    for (int i = 0; i < disc_corners; ++i) {
      const double angle = 2 * pi * i / disc_corners;
      corners.push_back(centre + Vec2{std::cos(angle), std::sin(angle)} * *entry.radius_m);
    }
    return corners;
  }
  for (std::size_t i = 0; i < entry.polygon_m.size(); ++i) {
    const std::vector<double>& corner = entry.polygon_m[i];
    if (corner.size() != 2)
      throw Error(Exit::data, place + "/polygon_m/" + std::to_string(i), "is no pair of numbers",
                  "give [x, y] in metres");
    corners.push_back({corner[0], corner[1]});
  }
  return corners;
}

// Where the ray through a position of the picture meets the patch's plane from its front.
std::optional<Vec2> on_plane(const camera::CameraModel& camera,
                             const Rigid<frame::Object, frame::Camera>& patch_from_camera, const Mat3& turn,
                             Vec2 pixel) {
  const camera::Ray ray = camera.ray(pixel);
  const Vec3 from = patch_from_camera * ray.origin_m, along = turn * ray.direction;
  if (!(along.z < 0)) return std::nullopt;
  const double t = -from.z / along.z;
  if (!(t > 0)) return std::nullopt;
  return Vec2{from.x + t * along.x, from.y + t * along.y};
}

struct Box {
  int left = 0, top = 0, right = -1, bottom = -1;
};
// Of the pixels that the patch touches; nothing where a part of it is not in the picture.
std::optional<Box> box_of(const Patch& patch, const camera::CameraModel& camera,
                          const Rigid<frame::Camera, frame::Object>& camera_from_patch) {
  double left = 1e300, right = -1e300, top = 1e300, bottom = -1e300;
  const auto& corners = patch.corners();
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (int k = 0; k < edge_parts; ++k) {
      const Vec2 at = corners[i] + (corners[(i + 1) % corners.size()] - corners[i]) * (1.0 * k / edge_parts);
      const auto pixel = camera.project(camera_from_patch * Vec3{at.x, at.y, 0});
      if (!pixel || !(pixel->x >= -0.5 && pixel->x <= camera.width_px() - 0.5 && pixel->y >= -0.5 &&
                      pixel->y <= camera.height_px() - 0.5))
        return std::nullopt;
      left = std::min(left, pixel->x), right = std::max(right, pixel->x);
      top = std::min(top, pixel->y), bottom = std::max(bottom, pixel->y);
    }
  return Box{static_cast<int>(std::floor(left + 0.5)), static_cast<int>(std::floor(top + 0.5)),
             std::min(static_cast<int>(std::floor(right + 0.5)), camera.width_px() - 1),
             std::min(static_cast<int>(std::floor(bottom + 0.5)), camera.height_px() - 1)};
}

}  // namespace

Patch::Patch(const manifest::FlatPatch& entry, const std::string& place) : corners_(polygon_of(entry, place)) {
  const std::string where = place + (entry.radius_m ? "/radius_m" : "/polygon_m");
  if (corners_.size() < 3)
    throw Error(Exit::data, where, "has " + std::to_string(corners_.size()) + " corners",
                "a polygon has three or more");
  double twice = 0;
  Vec2 moment;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Vec2 a = corners_[i] - corners_[0], b = corners_[(i + 1) % corners_.size()] - corners_[0];
    twice += cross2(a, b);
    moment = moment + (a + b) * cross2(a, b);
  }
  if (!(std::abs(twice) > 0) || !std::isfinite(twice))
    throw Error(Exit::data, where, "encloses no area", "give the corners in order, in metres");
  middle_ = corners_[0] + moment * (1 / (3 * twice));
  for (const Vec2 corner : corners_) extent_m_ = std::max(extent_m_, norm(corner - middle_));
}

bool Patch::holds(Vec2 at) const {
  bool inside = false;
  for (std::size_t i = 0, j = corners_.size() - 1; i < corners_.size(); j = i++) {
    const Vec2 a = corners_[i], b = corners_[j];
    if ((a.y > at.y) != (b.y > at.y) && at.x < (b.x - a.x) * (at.y - a.y) / (b.y - a.y) + a.x) inside = !inside;
  }
  return inside;
}

Footprint footprint(const Patch& patch, const camera::CameraModel& camera,
                    const Rigid<frame::Camera, frame::Object>& camera_from_patch) {
  const auto patch_from_camera = inverse(camera_from_patch);
  const auto box = box_of(patch, camera, camera_from_patch);
  if (!box) return {{}, "a part of the patch is outside the picture"};
  const Mat3 turn = matrix_of(patch_from_camera.rotation);
  const std::size_t columns = static_cast<std::size_t>(box->right - box->left + 2);
  std::vector<std::optional<Vec2>> above(columns), below(columns);  // corners of the pixels; nothing: not on the patch
  const auto fill = [&](std::vector<std::optional<Vec2>>& line, int row) {
    for (std::size_t i = 0; i < columns; ++i) {
      line[i] = on_plane(camera, patch_from_camera, turn, {box->left + static_cast<double>(i) - 0.5, row - 0.5});
      if (line[i] && !patch.holds(*line[i])) line[i].reset();
    }
  };
  Footprint result;
  fill(above, box->top);
  for (int y = box->top; y <= box->bottom; ++y, std::swap(above, below)) {
    fill(below, y + 1);
    for (std::size_t i = 0; i + 1 < columns; ++i) {
      if (!above[i] || !above[i + 1] || !below[i] || !below[i + 1]) continue;
      const Vec2 a = *above[i], b = *above[i + 1], c = *below[i + 1], d = *below[i];
      const double area_m2 = 0.5 * std::abs(cross2(c - a, d - b));
      if (area_m2 > 0) result.pixels.push_back({box->left + static_cast<int>(i), y, (a + b + c + d) * 0.25, area_m2});
    }
  }
  return result;
}

}  // namespace gonio::goniometry
