#include "mesh/reconstruct/viewpoints.h"

#include <algorithm>
#include <optional>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/cloud.h"
#include "manifest/sections/image.h"
#include "manifest/sections/rig.h"

namespace gonio::mesh {
namespace {

using manifest::Document;
using RigFromCamera = Rigid<frame::Rig, frame::Camera>;

struct Seen {
  std::vector<Vec3> from;
  enum class Frame { world, rig, stated } frame = Frame::world;
};

std::string place_of(const Document& document, const std::string& cloud) {
  return manifest::place(document, "/clouds/" + cloud);
}

// The cameras of the first rig that has them all.
std::optional<std::vector<RigFromCamera>> in_rig(const Document& document, const std::vector<std::string>& cameras) {
  for (const auto& [name, rig] : document.rigs) {
    std::vector<RigFromCamera> found;
    for (const std::string& camera : cameras)
      for (const manifest::RigMember& member : rig.cameras)
        if (member.camera == camera) {
          found.push_back(member.rig_from_camera);
          break;
        }
    if (found.size() == cameras.size()) return found;
  }
  return std::nullopt;
}

std::optional<Rigid<frame::World, frame::Camera>> pose_of(const Document& document, const std::string& name,
                                                          const manifest::Cloud& cloud) {
  for (const std::size_t i : images_of_cloud(document, name)) {
    const manifest::ImageEntry& image = document.images[i];
    if (image.camera == cloud.cameras.front() && image.world_from_camera) return *image.world_from_camera;
  }
  return std::nullopt;
}

Seen seen(const Document& document, const std::string& name) {
  const manifest::Cloud& cloud = document.clouds.at(name);
  Seen made;
  if (!cloud.cameras.empty()) {
    const auto rig = in_rig(document, cloud.cameras);
    const auto pose = pose_of(document, name, cloud);
    const Vec3 origin{};
    if (pose && rig) {
      for (const RigFromCamera& one : *rig) made.from.push_back(*pose * (inverse(rig->front()) * (one * origin)));
      return made;
    }
    if (pose) {
      made.from.push_back(*pose * origin);
      return made;
    }
    if (rig) {
      for (const RigFromCamera& one : *rig) made.from.push_back(one * origin);
      made.frame = Seen::Frame::rig;
      return made;
    }
  }
  throw Error(Exit::data, place_of(document, name),
              cloud.cameras.empty() ? "names no camera that saw it"
                                    : "was seen by " + cloud.cameras.front() +
                                          ", and neither an image nor a rig says "
                                          "where that stood",
              "--viewpoint " + name + "=X,Y,Z: the camera's place in the frame of the points, in metres");
}

}  // namespace

std::vector<std::size_t> images_of_cloud(const Document& document, const std::string& cloud) {
  const manifest::Cloud& own = document.clouds.at(cloud);
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < document.images.size(); ++i) {
    const manifest::ImageEntry& image = document.images[i];
    if (std::ranges::find(own.cameras, image.camera) == own.cameras.end()) continue;
    if (!own.projection.empty() && image.projection != own.projection) continue;
    if ((image.group.empty() ? image.projection : image.group) == cloud) found.push_back(i);
  }
  return found;
}

std::vector<std::vector<Vec3>> viewpoints_of(const Document& document, const std::vector<std::string>& clouds,
                                             const std::map<std::string, Vec3>& stated) {
  std::vector<std::vector<Vec3>> all;
  std::vector<std::string> world, rig;
  for (const std::string& name : clouds) {
    if (const auto own = stated.find(name); own != stated.end()) {
      all.push_back({own->second});
      continue;
    }
    const Seen one = seen(document, name);
    (one.frame == Seen::Frame::world ? world : rig).push_back(name);
    all.push_back(one.from);
  }
  const bool apart = rig.size() > 1 || (rig.size() == 1 && clouds.size() > 1);
  if (apart)
    throw Error(Exit::data, place_of(document, rig[0]),
                "lies in the frame of its rig, and nothing says how it lies to " + (rig.size() > 1        ? rig[1]
                                                                                    : clouds[0] == rig[0] ? clouds[1]
                                                                                                          : clouds[0]),
                "give its images poses (world_from_camera), or make meshes one by one (--view)");
  return all;
}

}  // namespace gonio::mesh
