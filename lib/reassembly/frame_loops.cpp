// The links of a scene's frames: see frame_loops.h.
#include "reassembly/frame_loops.h"

#include <cmath>
#include <optional>

#include "manifest/sections/frame_link.h"
#include "manifest/sections/image.h"
#include "manifest/sections/object.h"
#include "manifest/sections/rig.h"

namespace gonio::reassembly {
namespace {

using manifest::FrameEdge;

manifest::PoseSigma unstated(Vec3 translation_m) {
  constexpr double turn_rad = pi / 180, least_m = 1e-3, share = 0.01;
  return {{turn_rad}, {std::hypot(least_m, share * norm(translation_m))}};
}

class Gathered {
 public:
  explicit Gathered(const manifest::Document& document) : document_(document) {}

  void add(std::string to, std::string from, const Quaternion& rotation, Vec3 translation_m,
           const std::optional<manifest::PoseSigma>& sigma, const std::string& pointer) {
    if (to == from) return;
    edges_.push_back({std::move(to),
                      std::move(from),
                      {normalized(rotation), translation_m},
                      covariance_of(sigma ? *sigma : unstated(translation_m)),
                      place(document_, pointer)});
  }
  template <class Pose>
  void add(std::string to, std::string from, const Pose& pose, const std::string& pointer) {
    add(std::move(to), std::move(from), pose.rotation, pose.translation_m, pose.sigma, pointer);
  }

  void add_image(std::size_t index) {
    const manifest::ImageEntry& image = document_.images[index];
    if (image.weight.value_or(1) == 0) return;
    const std::string pointer = "/images/" + std::to_string(index), camera = "camera of image " + image.id;
    if (image.world_from_camera) add("world", camera, *image.world_from_camera, pointer + "/world_from_camera");
    if (image.camera_from_board) add(camera, image.board, *image.camera_from_board, pointer + "/camera_from_board");
    for (std::size_t k = 0; k < image.boards.size(); ++k)
      if (const auto& seen = image.boards[k]; seen.camera_from_board)
        add(camera, seen.board, *seen.camera_from_board,
            pointer + "/boards/" + std::to_string(k) + "/camera_from_board");
    if (image.shot.empty()) return;
    for (const auto& [name, rig] : document_.rigs)
      for (std::size_t k = 0; k < rig.cameras.size(); ++k)
        if (rig.cameras[k].camera == image.camera)
          add("rig " + name + " at shot " + image.shot, camera, rig.cameras[k].rig_from_camera,
              "/rigs/" + name + "/cameras/" + std::to_string(k) + "/rig_from_camera");
  }

  std::vector<FrameEdge> all() {
    for (std::size_t i = 0; i < document_.frames.size(); ++i) {
      const manifest::Link& link = document_.frames[i];
      add(link.to, link.from, link.rotation, link.translation_m, link.sigma, "/frames/" + std::to_string(i));
    }
    for (std::size_t i = 0; i < document_.objects.size(); ++i)
      if (const manifest::Object& object = document_.objects[i]; object.world_from_object)
        add("world", object.id, *object.world_from_object, "/objects/" + std::to_string(i) + "/world_from_object");
    for (std::size_t i = 0; i < document_.images.size(); ++i) add_image(i);
    return std::move(edges_);
  }

 private:
  const manifest::Document& document_;
  std::vector<FrameEdge> edges_;
};

}  // namespace

std::vector<FrameEdge> frame_edges(const manifest::Document& document) {
  return Gathered(document).all();
}

std::string frame_loop_complaint(const manifest::Document& document) {
  const std::vector<FrameEdge> edges = frame_edges(document);
  return manifest::check_loops(edges).sentence;
}

}  // namespace gonio::reassembly
