// Pieces and calibrated photographs, as the manifest has them.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "io/grey.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/object.h"
#include "manifest/sections/volume.h"
#include "photograph/mask.h"
#include "reassembly/piece_document.h"

namespace gonio::reassembly {
namespace {

using manifest::Document;

// A sigma that is not stated is zero: then the pose is taken as it stands.
std::array<double, 36> pose_covariance(const manifest::Pose<frame::World, frame::Camera>& pose) {
  std::array<double, 36> c{};
  if (!pose.sigma) return c;
  const auto put = [&](const std::vector<double>& sigma, std::size_t first) {
    for (std::size_t k = 0; k < 3 && !sigma.empty(); ++k) {
      const double s = sigma.size() == 1 ? sigma[0] : sigma.at(k);
      c[7 * (first + k)] = s * s;
    }
  };
  put(pose.sigma->rotation_rad, 0);
  put(pose.sigma->translation_m, 3);
  return c;
}

std::vector<std::size_t> asked_images(const Document& document, const std::vector<std::string>& images) {
  std::vector<std::size_t> chosen;
  for (const std::string& id : images) {
    const auto at = manifest::index_of_image(document, id);
    if (!at)
      throw Error(Exit::usage, "--image", "\"" + id + "\" is not in images of " + document.name,
                  "name one that is there");
    chosen.push_back(*at);
  }
  for (std::size_t i = 0; images.empty() && i < document.images.size(); ++i)
    if (document.images[i].weight.value_or(1) > 0) chosen.push_back(i);
  if (chosen.empty())
    throw Error(Exit::data, manifest::place(document, "/images"), "is empty",
                "give photographs with their poses: calib-charuco ... | handeye | reassemble");
  return chosen;
}

// The point nearest to the axes of all cameras; nothing where these are about parallel, or pass it behind a camera.
// Normal equations sum (1 - a a') (x - c) = 0, solved by Cramer's rule.
std::optional<Vec3> looked_at(const Document& document, const std::vector<std::size_t>& images) {
  Mat3 sum;
  sum.m.fill(0);
  std::array<double, 3> sums{};
  for (const std::size_t i : images) {
    const auto& pose = *document.images[i].world_from_camera;
    const Vec3 axis = pose.rotate({0, 0, 1}), c = pose.translation_m;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) {
        const double part = (row == column ? 1 : 0) - axis[row] * axis[column];
        sum(row, column) += part;
        sums[static_cast<std::size_t>(row)] += part * c[column];
      }
  }
  const Vec3 right{sums[0], sums[1], sums[2]};
  const auto column = [&](int k) { return Vec3{sum(0, k), sum(1, k), sum(2, k)}; };
  const double volume = dot(cross(column(0), column(1)), column(2));
  const auto n = static_cast<double>(images.size());
  constexpr double least_spread = 1e-3;  // of the axes' directions: two degrees or so
  if (!(volume > least_spread * n * n * n)) return {};
  const Vec3 x{dot(cross(right, column(1)), column(2)) / volume, dot(cross(column(0), right), column(2)) / volume,
               dot(cross(column(0), column(1)), right) / volume};
  for (const std::size_t i : images)
    if ((inverse(*document.images[i].world_from_camera) * x).z <= 0) return {};
  return x;
}

View view_of(const Document& document, std::size_t index, const DetectWish& wish, std::vector<Refused>& refused) {
  const manifest::ImageEntry& image = document.images[index];
  const camera::CameraModel camera = camera_of(document, index);
  const std::filesystem::path path = manifest::picture_path(document, index);
  const io::GreyImage picture = io::read_grey(path);
  if (picture.width != camera.width_px() || picture.height != camera.height_px())
    throw Error(Exit::data, path.string(),
                "is " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                    " pixels, its camera has " + std::to_string(camera.width_px()) + " x " +
                    std::to_string(camera.height_px()),
                "photograph and camera must be of one size: was it cut or scaled?");
  std::vector<unsigned char> mask;
  if (const auto file = manifest::mask_path(document, index); !file.empty()) {
    const photograph::Mask counts = photograph::read_mask(file);
    if (counts.width != picture.width || counts.height != picture.height)
      throw Error(Exit::data, file.string(), "has another size than its photograph", "give a mask of the same size");
    mask.assign(counts.counts.begin(), counts.counts.end());
  }
  Detected detected = detect_spheres(picture, camera, wish, mask);
  refused = std::move(detected.refused);
  return {image.id, *image.world_from_camera, pose_covariance(*image.world_from_camera), std::move(detected.found)};
}

Mat3 covariance_of(const manifest::Marker& marker) {
  Mat3 c;
  std::ranges::copy(marker.covariance_m2, c.m.begin());
  return c;
}

void check_covariance(const Mat3& c, const std::string& at) {
  const double xy = std::abs(c(0, 1) - c(1, 0)), xz = std::abs(c(0, 2) - c(2, 0)), yz = std::abs(c(1, 2) - c(2, 1));
  const double size = c(0, 0) + c(1, 1) + c(2, 2);
  const double minor = c(0, 0) * c(1, 1) - c(0, 1) * c(1, 0);
  const double volume =
      dot(cross(Vec3{c(0, 0), c(0, 1), c(0, 2)}, Vec3{c(1, 0), c(1, 1), c(1, 2)}), Vec3{c(2, 0), c(2, 1), c(2, 2)});
  const bool positive = c(0, 0) > 0 && minor > 0 && volume > 0;
  if (!positive || std::max({xy, xz, yz}) > 1e-6 * size)
    throw Error(Exit::data, at, "is no covariance: symmetric and positive definite", "give variances in m^2");
}

}  // namespace

camera::CameraModel camera_of(const Document& document, std::size_t image) {
  const std::string& stated = manifest::camera_of_image(document, image);
  const std::string name = stated.empty() && document.cameras.size() == 1 ? document.cameras.begin()->first : stated;
  const manifest::Camera* camera = manifest::find_camera(document, name);
  if (camera == nullptr)
    throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(image) + "/camera"), "is not said",
                "name one of cameras");
  return {*camera, manifest::place(document, "/cameras/" + name)};
}

std::vector<Piece> pieces_of(const Document& document) {
  std::vector<Piece> pieces;
  for (const manifest::Object& object : document.objects) {
    Piece piece{object.id, {}};
    for (std::size_t i = 0; i < document.markers.size(); ++i) {
      const manifest::Marker& marker = document.markers[i];
      if (marker.object != object.id) continue;
      const std::string at = manifest::place(document, "/markers/" + std::to_string(i));
      if (marker.covariance_m2.empty())
        throw Error(Exit::data, at, "has no covariance_m2", "ct-mesh-clean --markers states it; else diag(sigma^2)");
      PieceMarker own{marker.id,
                      {marker.centre_m[0], marker.centre_m[1], marker.centre_m[2]},
                      marker.radius_m.value_or(0),
                      covariance_of(marker)};
      check_covariance(own.covariance_m2, at + "/covariance_m2");
      piece.markers.push_back(std::move(own));
    }
    if (!piece.markers.empty()) pieces.push_back(std::move(piece));
  }
  for (std::size_t i = 0; i < document.markers.size(); ++i) {
    const std::string& object = document.markers[i].object;
    if (std::ranges::none_of(document.objects, [&](const manifest::Object& o) { return o.id == object; }))
      throw Error(Exit::data, manifest::place(document, "/markers/" + std::to_string(i) + "/object"),
                  "names \"" + object + "\", which is not in objects", "name the piece that the marker is glued to");
  }
  if (pieces.empty())
    throw Error(Exit::data, manifest::place(document, "/markers"), "no object has markers",
                "give pieces: --piece NAME=FILE, as ct-mesh-clean --markers writes them");
  return pieces;
}

SeenViews views_of(const Document& document, const std::vector<std::string>& images, const DetectWish& wish,
                   double marker_radius_m) {
  const std::vector<std::size_t> chosen = asked_images(document, images);
  for (const std::size_t i : chosen)
    if (!document.images[i].world_from_camera)
      throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(i)), "has no world_from_camera",
                  "find the poses first: calib-charuco ... | handeye | reassemble");
  SeenViews seen;
  seen.views.resize(chosen.size());
  seen.refused.resize(chosen.size());
  const std::optional<Vec3> middle = looked_at(document, chosen);
  Progress progress("markers", chosen.size());
  parallel_for(0, chosen.size(), [&](std::size_t k) {
    DetectWish own = wish;
    const double away_m = middle ? norm(*middle - document.images[chosen[k]].world_from_camera->translation_m) : 0;
    if (marker_radius_m > 0 && away_m > 3 * marker_radius_m && !own.least_half_angle_rad &&
        !own.largest_half_angle_rad) {
      constexpr double nearer = 2;  // or farther, by this factor, than what all cameras look at
      own.least_half_angle_rad = std::asin(marker_radius_m / away_m) / nearer;
      own.largest_half_angle_rad = std::asin(marker_radius_m / away_m) * nearer;
    }
    seen.views[k] = view_of(document, chosen[k], own, seen.refused[k]);
    progress.advance();
  });
  return seen;
}

}  // namespace gonio::reassembly
