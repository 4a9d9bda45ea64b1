// Ways in which a scene's files may have been meant other than they were read: a mesh in other units, mirrored, with
// axes exchanged or another one up, poses given the wrong way round or of a camera that looks along -z, pictures that
// are flipped. Each is a small change of the scene as it was built.
#pragma once
#include <string>
#include <vector>

#include "explain/images/model.h"
#include "scene/scene.h"

namespace gonio::explain::images {

struct Reading {
  // "[The mesh of `bunny`] seems [to be in millimetres]: [scaled by 0.001] ..."
  std::string subject{}, fault{}, remedy{};
  bool plural = false;
  bool of_pictures = false;                      // may hold for some pictures and not for others
  std::vector<std::size_t> instances{};          // whose meshes are meant otherwise,
  Mat3 meant_from_file{};                        // every vertex times this, in the object's frame
  double cameras_scale = 1, lamps_scale = 1;     // of their places in the world
  bool inverted = false;                         // poses are camera_from_world
  bool looks_back = false;                       // poses are those of a camera with y up that looks along -z
  bool left_right = false, upside_down = false;  // pictures
};

// All that are asked of a scene. Those of meshes stand for the files of meshes alone: of spheres and planes the
// manifest states the size itself.
std::vector<Reading> readings_of(const scene::Scene& scene);

// The scene, its views and its lamps as they would have been meant.
std::vector<scene::Instance> meant(const scene::Scene& scene, const Reading& reading);
View meant(const View& view, const Reading& reading);
LightSource meant(const LightSource& lamp, const Reading& reading);

}  // namespace gonio::explain::images
