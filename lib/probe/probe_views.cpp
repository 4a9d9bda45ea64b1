// See probe_views.h.
#include "probe/probe_views.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "camera/undistort_document.h"
#include "io/picture.h"
#include "linear/geom_matrices.h"
#include "linear/solve.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "photograph/linear_picture.h"
#include "photograph/mask.h"
#include "photograph/noise_variance.h"

namespace gonio::probe {
namespace {

// Three numbers where one stands for all.
void add_sigmas(std::vector<double>& all, const std::vector<double>& stated) {
  for (std::size_t k = 0; k < 3; ++k) all.push_back(stated.empty() ? 0 : stated[stated.size() == 3 ? k : 0]);
}

OutlineWish wish_of(const LoadedView& view, const ProbeRequest& request) {
  OutlineWish wish{request.balls, request.circle, {}, view.counts};
  if (request.silhouettes.empty()) return wish;
  const auto at = static_cast<std::size_t>(std::ranges::find(request.images, view.image) - request.images.begin());
  const std::filesystem::path& path = request.silhouettes[request.silhouettes.size() == 1 ? 0 : at];
  request.note_input(path);
  wish.silhouette = io::read_picture(path);
  const io::Image& s = *wish.silhouette;
  if (s.width != view.picture.width || s.height != view.picture.height)
    throw Error(
        Exit::data, path.string(),
        format("is %d x %d pixels, its photograph %d x %d", s.width, s.height, view.picture.width, view.picture.height),
        "draw it over the photograph");
  const auto [least, most] = std::ranges::minmax(s.data);
  if (!(most > least))
    throw Error(Exit::data, path.string(), "is the same everywhere",
                "make it white where the ball is, and black elsewhere");
  wish.counts.clear();
  return wish;
}

// Centre, and both ends of its covariance's axes, by one standard deviation each.
std::vector<Ball> moved_balls(const Ball& ball, const Mat3& covariance, bool radius_is_third, const Vec3& first,
                              const Vec3& second) {
  const Eigen::MatrixXd root = linear::Llt(linear::as_eigen(covariance)).lower();
  std::vector<Ball> all;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = root.col(k);
    Ball moved = ball;
    if (radius_is_third) {
      moved.centre_m += first * step[0] + second * step[1];
      moved.radius_m += step[2];
    } else {
      moved.centre_m += Vec3{step[0], step[1], step[2]};
    }
    all.push_back(moved);
  }
  return all;
}

void check_light(const LoadedView& loaded, const BallView& view, const std::string& place) {
  const Vec3 centre = inverse(view.world_from_camera) * view.ball.centre_m;
  const auto middle = view.camera.project(centre);
  if (!middle || loaded.clipped.empty()) return;
  std::size_t inside = 0, clipped = 0;
  for (int y = 0; y < loaded.picture.height; ++y)
    for (int x = 0; x < loaded.picture.width; ++x)
      if (norm(Vec2{double(x), double(y)} - *middle) < 0.95 * view.radius_px) {
        const auto i =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(loaded.picture.width) + static_cast<std::size_t>(x);
        ++inside, clipped += loaded.clipped[i] != 0;
      }
  if (clipped == inside)
    throw Error(Exit::data, place, "is saturated all over the ball",
                "take shorter exposures; develop --merge joins them");
}

BallView picture_view(const LoadedView& loaded) {
  BallView view{.picture = loaded.picture,
                .variance = loaded.variance,
                .counts = loaded.counts,
                .clipped = loaded.clipped,
                .camera = loaded.camera ? *loaded.camera : far_camera(loaded.picture.width, loaded.picture.height)};
  view.world_from_camera = loaded.outlines.world_from_camera;
  return view;
}

void add_parallel(BallViews& all, const LoadedView& loaded, const ProbeRequest& request) {
  const double focal = far_camera(loaded.picture.width, loaded.picture.height).intrinsics().fx_px;
  for (const reassembly::Outline& o : loaded.outlines.outlines) {
    const double radius_m = request.radius_m > 0 ? request.radius_m : 1, radius_px = focal * o.half_angle_rad;
    const double px_per_m = radius_px / radius_m;
    BallView view = picture_view(loaded);
    view.camera = camera::CameraModel::parallel(px_per_m, loaded.picture.width, loaded.picture.height);
    const Vec2 off = o.centre_px - view.camera.principal_point_px();
    constexpr double away = 10;  // radii; without effect
    view.ball = {view.world_from_camera * Vec3{off.x / px_per_m, off.y / px_per_m, away * radius_m}, radius_m};
    view.radius_px = radius_px;
    Mat3 covariance = o.covariance_rad2;
    for (double& v : covariance.m) v *= std::pow(focal / px_per_m, 2);
    view.sigma_px = px_per_m * std::sqrt((covariance(0, 0) + covariance(1, 1)) / 2);
    const Vec3 right = view.world_from_camera.rotate({1, 0, 0}), down = view.world_from_camera.rotate({0, 1, 0});
    view.variants = moved_balls(view.ball, covariance, true, right, down);
    Mat3 world{{}};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        world(i, j) = covariance(0, 0) * right[i] * right[j] + covariance(1, 1) * down[i] * down[j];
    view.number = all.balls.size();
    all.balls.push_back({view.ball, world, 0, 0, {{all.views.size(), o}}});
    all.image_of_view.push_back(loaded.image), all.ball_of_view.push_back(all.balls.size() - 1);
    all.outline_of_view.push_back(o);
    all.views.push_back(std::move(view));
  }
}

}  // namespace

LoadedView read_view(const manifest::Document& document, std::size_t index, const ProbeRequest& request) {
  const manifest::ImageEntry& image = document.images[index];
  const auto path = manifest::picture_path(document, index), mask = manifest::mask_path(document, index);
  request.note_input(path);
  auto read = photograph::read_linear(path, image.response, path.string(), image.saturation);
  LoadedView view;
  view.image = index;
  view.picture = std::move(read.colour), view.variance = std::move(read.variance),
  view.clipped = std::move(read.clipped);
  if (view.variance.data.empty() && image.noise) {
    view.variance = view.picture;
    for (float& v : view.variance.data) v = static_cast<float>(photograph::noise_variance(*image.noise, double{v}));
  }
  if (!mask.empty()) {
    request.note_input(mask);
    view.counts = photograph::read_mask_of(view.picture, mask, mask.string());
    if (std::ranges::none_of(view.counts, [](std::uint8_t c) { return c != 0; }))
      throw Error(Exit::data, mask.string(), "counts no pixel", "masks are white where pixels count");
  }
  if (request.parallel) {
    view.outlines.world_from_camera.rotation = quaternion_of(Mat3{{0, 0, 1, -1, 0, 0, 0, -1, 0}});
  } else {
    const std::string name = camera::camera_of_picture(document, index);
    view.camera = camera::CameraModel(document.cameras.at(name), manifest::place(document, "/cameras/" + name));
    if (view.camera->width_px() != view.picture.width || view.camera->height_px() != view.picture.height)
      throw Error(Exit::data, path.string(),
                  format("is %d x %d pixels, its camera \"%s\" has %d x %d", view.picture.width, view.picture.height,
                         name.c_str(), view.camera->width_px(), view.camera->height_px()),
                  "use the camera that took it; pictures must be neither cropped nor scaled");
    if (image.world_from_camera) {
      view.outlines.world_from_camera = *image.world_from_camera;
      if (const auto& sigma = image.world_from_camera->sigma) {
        add_sigmas(view.outlines.pose_sigma, sigma->rotation_rad);
        add_sigmas(view.outlines.pose_sigma, sigma->translation_m);
      }
    }
  }
  return view;
}

LoadedView load_view(const manifest::Document& document, std::size_t index, const ProbeRequest& request) {
  LoadedView view = read_view(document, index, request);
  const camera::CameraModel seen_by = view.camera ? *view.camera : far_camera(view.picture.width, view.picture.height);
  view.outlines.outlines =
      ball_outlines(view.picture, seen_by, wish_of(view, request), manifest::picture_path(document, index).string());
  return view;
}

BallViews ball_views(const std::vector<LoadedView>& loaded, const ProbeRequest& request, const std::string& place) {
  BallViews all;
  if (request.parallel) {
    for (const LoadedView& view : loaded) add_parallel(all, view, request);
  } else {
    std::vector<OutlineView> outlines;
    for (const LoadedView& view : loaded) outlines.push_back(view.outlines);
    all.balls = located_balls(outlines, request.radius_m, request.balls, place);
    for (std::size_t b = 0; b < all.balls.size(); ++b)
      for (const BallSighting& s : all.balls[b].sightings) {
        BallView view = picture_view(loaded[s.view]);
        view.ball = all.balls[b].ball, view.number = b;
        for (std::size_t other = 0; other < all.balls.size(); ++other)
          if (other != b) view.others.push_back(all.balls[other].ball);
        view.variants = moved_balls(view.ball, all.balls[b].covariance_m2, false, {}, {});
        view.radius_px = s.outline.radius_px;
        const double px_per_rad = s.outline.radius_px / s.outline.half_angle_rad,
                     away = norm(view.ball.centre_m - view.world_from_camera.translation_m);
        double trace = 0;
        for (int k = 0; k < 3; ++k) trace += all.balls[b].covariance_m2(k, k);
        view.sigma_px = std::sqrt(trace / 3) / away * px_per_rad;
        all.image_of_view.push_back(loaded[s.view].image), all.ball_of_view.push_back(b);
        all.outline_of_view.push_back(s.outline);
        all.views.push_back(std::move(view));
      }
  }
  for (std::size_t v = 0; v < all.views.size(); ++v)
    for (const LoadedView& view : loaded)
      if (view.image == all.image_of_view[v]) check_light(view, all.views[v], place);
  for (const FoundBall& b : all.balls) all.middle_m += b.ball.centre_m / static_cast<double>(all.balls.size());
  return all;
}

}  // namespace gonio::probe
