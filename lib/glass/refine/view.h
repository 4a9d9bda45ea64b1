// One photograph of a transparent object before a polarized screen, as the refinement takes it: reduced to some hundred
// pixels a side, its Stokes vectors, where its outline lies, what a network said about it. World frame, metres: the
// object stands still in it, cameras and screens stand round it (a turntable's turn is theirs).
#pragma once
#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera/camera_model.h"
#include "geom/rigid.h"
#include "glass/refine/screen_picture.h"
#include "io/image.h"
#include "manifest/sections/forward.h"
#include "render/ray_caster.h"

namespace gonio::glass {

// What a network says of a view's pixels: unit normals in the world's frame, and the angles that 68.3 % of them err by
// less than. Layers of its EXR, as glass-net(1) writes them for images with a pose: mask (0 to 1), normal.X, .Y, .Z and
// back_normal.X, .Y, .Z, uncertainty.normal and uncertainty.back_normal (rad). Sizes are the view's.
struct NetworkAnswer {
  std::vector<Vec3> front, back;  // zero vector: says nothing
  std::vector<float> front_sigma_rad, back_sigma_rad;
};

struct View {
  std::string id;
  int width = 0, height = 0, reduced = 1;  // `reduced`: photograph's pixels a side of one of these
  camera::CameraModel camera;              // of the photograph
  Rigid<frame::World, frame::Camera> world_from_camera{};
  Mat3 world_from_camera_axes{};
  double focal_px = 0;              // of the reduced pixels
  std::vector<float> outline_px{};  // distance from the mask's edge, positive inside
  std::array<std::vector<float>, 3> stokes{};
  double noise = 0;  // standard deviation of s0
  std::shared_ptr<const ScreenPicture> screen{};
  std::shared_ptr<const light::Emitter> emitter{};
  std::shared_ptr<const render::RayCaster> others{};  // what else stands there: a platform; null: nothing
  std::optional<NetworkAnswer> network{};

  std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  Vec3 eye_m() const { return world_from_camera.translation_m; }
  Vec3 direction(double x, double y) const;         // unit, world, of a place in the reduced picture
  std::optional<Vec2> project(Vec3 point_m) const;  // to such a place
  Vec3 camera_x() const { return world_from_camera_axes * Vec3{1, 0, 0}; }
  double outline_at(Vec2 place) const;  // bilinear; beyond the borders less by the distance from them
};

// Distance of each pixel's centre from where `mask` passes one half, in pixels, positive where it is more.
std::vector<float> distance_from_edge(const std::vector<float>& mask, int width, int height);

// s0, s1, s2 as a monochrome sensor has them, of a picture with planes R, G, B, s1.R ... or Y, s1.Y, s2.Y; else empty.
std::array<std::vector<float>, 3> stokes_planes(const io::Image& picture);
// Means of `factor` x `factor` pixels; what is left over at the right and below is dropped.
std::vector<float> reduced(const std::vector<float>& plane, int width, int height, int factor);

struct ViewFiles {
  std::optional<std::filesystem::path> network;  // folder with IMAGE.exr for images that a network has seen
  int most_px = 160;                             // of a side, after reduction
  std::function<void(const std::filesystem::path&)> on_file{};  // hears of every file that is read
};
// All images of the document: a camera with its pose, one light of model "screen", a mask (the image's or the
// network's), a photograph behind the mosaic of polarizers or with Stokes planes. Error(data) at the image otherwise.
std::vector<View> views_in(const manifest::Document& document, const ViewFiles& files);

}  // namespace gonio::glass
