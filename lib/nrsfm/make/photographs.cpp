// See photographs.h.
#include "nrsfm/make/photographs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "camera/camera_model.h"
#include "camera/intrinsics.h"
#include "camera/mosaic.h"
#include "linear/geom_matrices.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "nrsfm/make/camera_paths.h"
#include "nrsfm/make/frame_caster.h"
#include "nrsfm/make/selection.h"
#include "nrsfm/make/tracker.h"
#include "photograph/linear_picture.h"
#include "scene/deformed.h"
#include "stats/intervals.h"

namespace gonio::nrsfm {
namespace {

constexpr double least_corner = 0.05;  // of the best one's smaller eigenvalue
constexpr double not_seen = std::numeric_limits<double>::quiet_NaN();

// Corners at least a patch away from `taken` and from each other, the best first.
std::vector<Eigen::Vector2d> corners(const GreyPicture& picture, const Eigen::Matrix2Xd& taken, Eigen::Index most) {
  if (most <= 0) return {};
  const int half_px = TrackerOptions{}.half_px;
  const cv::Mat grey(picture.height, picture.width, CV_8UC1, const_cast<std::uint8_t*>(picture.value.data()));
  cv::Mat free(grey.size(), CV_8UC1, cv::Scalar(255));
  for (Eigen::Index p = 0; p < taken.cols(); ++p)
    if (!std::isnan(taken(0, p)))
      cv::circle(free, {static_cast<int>(taken(0, p)), static_cast<int>(taken(1, p))}, half_px, cv::Scalar(0), -1);
  std::vector<cv::Point2f> found;
  cv::goodFeaturesToTrack(grey, found, static_cast<int>(most), least_corner, half_px, free, half_px);
  std::vector<Eigen::Vector2d> places;
  for (const cv::Point2f& place : found) places.emplace_back(place.x + 0.5, place.y + 0.5);
  return places;
}

double grey_at(const photograph::LinearPicture& picture, std::size_t pixel) {
  const std::size_t channels = picture.colour.channels.size();
  double sum = 0;
  for (std::size_t c = 0; c < channels; ++c) sum += static_cast<double>(picture.colour.data[pixel * channels + c]);
  return std::max(0.0, sum / static_cast<double>(channels));
}

photograph::LinearPicture read(const manifest::Document& document, std::size_t image) {
  const manifest::ImageEntry& entry = document.images[image];
  const std::string pointer = "/images/" + std::to_string(image);
  return photograph::read_linear(manifest::resolve(document, entry.file, pointer + "/file"), entry.response,
                                 manifest::place(document, pointer), entry.saturation);
}

camera::CameraModel lens_of(const manifest::Document& document, const manifest::ImageEntry& image) {
  return {document.cameras.at(image.camera), manifest::place(document, "/cameras/" + image.camera)};
}

// All meshes of a scene in world coordinates, the followed one's first.
struct Stage {
  FrameMesh mesh;
  std::size_t followed = 0;  // its triangles
};
Stage stage_of(const manifest::Document& truth, const std::string& id, const manifest::ImageEntry& image) {
  Stage stage;
  stage.mesh.vertices_m.resize(3, 0);
  const auto add = [&](const manifest::Object& object) {
    const auto found = image.shapes.find(object.id);
    const double share = found == image.shapes.end() ? 0 : found->second;
    const io::TriangleMesh mesh = scene::deformed_mesh(truth, object.mesh, share);
    const auto first = stage.mesh.vertices_m.cols();
    stage.mesh.vertices_m.conservativeResize(3, first + static_cast<Eigen::Index>(mesh.positions_m.size()));
    for (std::size_t v = 0; v < mesh.positions_m.size(); ++v) {
      const Vec3 place =
          object.world_from_object ? *object.world_from_object * mesh.positions_m[v] : Vec3(mesh.positions_m[v]);
      stage.mesh.vertices_m.col(first + static_cast<Eigen::Index>(v)) = linear::as_eigen(place);
    }
    const auto offset = static_cast<std::uint32_t>(first);
    for (const auto& [a, b, c] : mesh.triangles) stage.mesh.triangles.push_back({a + offset, b + offset, c + offset});
  };
  const auto object = std::ranges::find(truth.objects, id, &manifest::Object::id);
  if (object == truth.objects.end() || truth.meshes.at(object->mesh).file.empty())
    throw Error(Exit::data, manifest::place(truth, "/objects"), "has no \"" + id + "\" with a mesh of a file",
                "name the object that was followed: --object");
  add(*object);
  stage.followed = stage.mesh.triangles.size();
  for (const manifest::Object& other : truth.objects)
    if (other.id != id && !truth.meshes.at(other.mesh).file.empty()) add(other);
  return stage;
}

}  // namespace

FollowedPoints follow(std::size_t count, const std::function<GreyPicture(std::size_t)>& picture,
                      const FollowOptions& options) {
  const auto every = static_cast<std::size_t>(options.every);
  const auto frames = static_cast<Eigen::Index>((count + every - 1) / every);
  constexpr Eigen::Index generations = 20;  // of lost points that are replaced
  const Eigen::Index capacity = generations * options.points;
  Tracker tracker(capacity);
  FollowedPoints out;
  out.tracks_px = Tracks::Constant(2 * frames, capacity, not_seen);
  out.sigma_px = Eigen::MatrixXd::Constant(frames, capacity, not_seen);
  for (std::size_t k = 0; k < count; ++k) {
    GreyPicture now = picture(k);
    const GreyPicture seen = now;
    tracker.advance(std::move(now));
    if (k % every != 0) continue;
    const auto f = static_cast<Eigen::Index>(k / every);
    const Eigen::Matrix2Xd& places = tracker.places_px();
    const Eigen::Index alive = places.row(0).array().isFinite().count();
    const Eigen::Index wanted = std::min(options.points - alive, capacity - static_cast<Eigen::Index>(out.born.size()));
    for (const Eigen::Vector2d& corner : corners(seen, places, wanted)) {
      tracker.begin(static_cast<Eigen::Index>(out.born.size()), corner);
      out.born.push_back(f);
    }
    out.tracks_px.middleRows<2>(2 * f) = places;
    for (Eigen::Index p = 0; p < capacity; ++p)
      if (!std::isnan(places(0, p))) out.sigma_px(f, p) = tracker.sigma_px(p);
  }
  const auto chosen = static_cast<Eigen::Index>(out.born.size());
  out.tracks_px.conservativeResize(Eigen::NoChange, chosen);
  out.sigma_px.conservativeResize(Eigen::NoChange, chosen);
  return out;
}

Photographs::Photographs(const manifest::Document& document) : document_(document) {
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const manifest::ImageEntry& image = document.images[i];
    if (image.file.empty() || image.camera.empty() || !image.world_from_camera) continue;
    if (!camera::mosaic_of(document, image.camera).empty())
      throw Error(Exit::data, manifest::place(document, "/images/" + std::to_string(i)), "is a mosaic",
                  "develop it first (develop(1))");
    images_.push_back(i);
  }
  if (images_.size() < 2)
    throw Error(Exit::data, manifest::place(document, "/images"),
                std::to_string(images_.size()) + " of them have a file, a camera and its place, two are needed",
                "take them with acquire");
  std::ranges::sort(images_, {}, [&](std::size_t i) { return document.images[i].id; });
  full_ = 0;
  for (const std::size_t k : {std::size_t{0}, count() / 2, count() - 1}) {
    const photograph::LinearPicture picture = read(document_, images_[k]);
    std::vector<double> values(picture.colour.pixels());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = grey_at(picture, i);
    full_ = std::max(full_, stats::quantile(values, 0.998));
  }
  if (!(full_ > 0)) throw Error(Exit::data, manifest::place(document, "/images"), "are dark", "light them");
}

GreyPicture Photographs::picture(std::size_t k) const {
  const photograph::LinearPicture picture = read(document_, images_[k]);
  GreyPicture grey{picture.colour.width, picture.colour.height, {}, {}};
  grey.value.resize(picture.colour.pixels());
  const manifest::Noise noise = image(k).noise.value_or(manifest::Noise{.gain = 0, .read = 0});
  const auto even = [&noise](double v) {
    return noise.gain > 0 ? std::sqrt(v * noise.gain + 0.375 + std::pow(noise.gain * noise.read, 2)) : std::sqrt(v);
  };
  const double dark = even(0), span = even(full_) - dark;
  for (std::size_t i = 0; i < grey.value.size(); ++i)
    grey.value[i] =
        static_cast<std::uint8_t>(std::lround(255 * (even(std::min(full_, grey_at(picture, i))) - dark) / span));
  return grey;
}

const manifest::ImageEntry& Photographs::image(std::size_t k) const {
  return document_.images[images_[k]];
}

CameraFromObject Photographs::camera_from_world(std::size_t k) const {
  const auto& world_from_camera = *image(k).world_from_camera;
  CameraFromObject camera;
  camera.rotation = linear::as_eigen(matrix_of(world_from_camera.rotation)).transpose();
  camera.translation = -camera.rotation * linear::as_eigen(world_from_camera.translation_m);
  return camera;
}

std::vector<std::filesystem::path> Photographs::files() const {
  std::vector<std::filesystem::path> all;
  for (std::size_t k = 0; k < count(); ++k) all.push_back(manifest::resolve(document_, image(k).file, "/files"));
  return all;
}

Sequence Photographs::sequence(const FollowedPoints& followed, Eigen::Index every) const {
  Sequence s;
  s.projection = Projection::perspective;
  s.tracks = Tracks::Constant(followed.tracks_px.rows(), followed.tracks_px.cols(), not_seen);
  s.sigma = followed.sigma_px;
  s.visible = !followed.sigma_px.array().isNaN();
  s.unit_m = 1;
  const manifest::Camera& first = document_.cameras.at(image(0).camera);
  s.pinhole = Pinhole{first.fx_px.scalar(), first.fy_px.scalar(), first.cx_px.scalar(), first.cy_px.scalar()};
  for (Eigen::Index f = 0; f < s.frames(); ++f) {
    const auto k = static_cast<std::size_t>(f * every);
    const camera::CameraModel lens = lens_of(document_, image(k));
    s.cameras.push_back(camera_from_world(k));
    for (Eigen::Index p = 0; p < s.points(); ++p) {
      if (!s.visible(f, p)) continue;
      const Vec3 d = lens.ray({followed.tracks_px(2 * f, p) - 0.5, followed.tracks_px(2 * f + 1, p) - 0.5}).direction;
      s.tracks(2 * f, p) = s.pinhole->fx_px * d.x / d.z + s.pinhole->cx_px;
      s.tracks(2 * f + 1, p) = s.pinhole->fy_px * d.y / d.z + s.pinhole->cy_px;
    }
  }
  return s;
}

KnownTracks with_truth(const Photographs& photographs, const FollowedPoints& followed, Sequence tracks,
                       Eigen::Index every, const manifest::Document& truth, const std::string& id) {
  const Eigen::Index frames = tracks.frames();
  std::vector<std::optional<Anchor>> anchors(followed.born.size());
  std::vector<Stage> stages(static_cast<std::size_t>(frames));
  parallel_for(0, stages.size(), [&](std::size_t at) {
    stages[at] = stage_of(truth, id, photographs.image(at * static_cast<std::size_t>(every)));
    const auto f = static_cast<Eigen::Index>(at);
    const FrameCaster caster(stages[at].mesh);
    const CameraFromObject& camera = tracks.cameras[at];
    const Eigen::Vector3d eye = -camera.rotation.transpose() * camera.translation;
    for (Eigen::Index p = 0; p < tracks.points(); ++p) {
      if (followed.born[static_cast<std::size_t>(p)] != f || !tracks.visible(f, p)) continue;
      const Eigen::Vector3d ray((tracks.tracks(2 * f, p) - tracks.pinhole->cx_px) / tracks.pinhole->fx_px,
                                (tracks.tracks(2 * f + 1, p) - tracks.pinhole->cy_px) / tracks.pinhole->fy_px, 1);
      const auto met = caster.closest(eye, camera.rotation.transpose() * ray.normalized());
      if (met && met->triangle < stages[at].followed)
        anchors[static_cast<std::size_t>(p)] = Anchor{met->triangle, met->b1, met->b2};
    }
  });
  std::vector<Eigen::Index> kept;
  for (Eigen::Index p = 0; p < tracks.points(); ++p)
    if (anchors[static_cast<std::size_t>(p)]) kept.push_back(p);
  KnownTracks known;
  known.elsewhere = tracks.points() - static_cast<Eigen::Index>(kept.size());
  known.tracks = std::move(tracks);
  keep_points(known.tracks, kept);
  Shapes points(3 * frames, known.tracks.points());
  known.ideal = known.tracks;
  known.ideal.sigma.resize(0, 0);
  parallel_for(0, stages.size(), [&](std::size_t at) {
    const auto f = static_cast<Eigen::Index>(at);
    const FrameMesh& mesh = stages[at].mesh;
    for (std::size_t p = 0; p < kept.size(); ++p) {
      const Anchor& a = *anchors[static_cast<std::size_t>(kept[p])];
      const auto& t = mesh.triangles[a.triangle];
      points.block<3, 1>(3 * f, static_cast<Eigen::Index>(p)) = on_triangle(mesh.vertices_m, t, a.b1, a.b2);
    }
    known.ideal.visible.row(f) =
        visible_in(mesh, shape_of(points, f), known.tracks.cameras[at], Projection::perspective, 1e-5);
  });
  known.ideal.tracks = project(points, known.tracks.cameras, Projection::perspective, *known.tracks.pinhole);
  for (Eigen::Index f = 0; f < frames; ++f)
    for (Eigen::Index p = 0; p < known.ideal.points(); ++p)
      if (!known.ideal.visible(f, p)) known.ideal.tracks.block<2, 1>(2 * f, p).setConstant(not_seen);
  known.tracks.truth = known.ideal.truth = points;
  return known;
}

}  // namespace gonio::nrsfm
