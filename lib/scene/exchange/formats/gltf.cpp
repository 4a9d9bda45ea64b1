// glTF 2.0 with extensions of Khronos: a file of JSON, one of numbers, pictures as PNG. Written and read.
//
// Conventions (Khronos Group, glTF 2.0 specification, 2021):
// - y up, right-handed, metres: our z up, turned by -90 degrees about x in a node above everything.
// - Cameras look along -z with y up. Their principal point is the picture's middle and they know of no pixels: the
//   picture's size and principal point stand in `extras`, for whoever reads them. Orthographic: xmag, ymag are half
//   extents.
// - Texture coordinates run downwards. Colours of textures are sRGB codes.
// - KHR_lights_punctual: candela and lux, at 683 lm/W; colours have 1 as their largest component. Lamps shine along -z.
//   Gains of images scale the lamps: light is linear.
// - One glTF scene for each image, with the camera and the lamps that are on, and the objects of all. Read, every
// camera
//   of a scene becomes an image, lit by the lamps of that scene.
// - Read, a matrix that is no rigid motion is applied to the mesh.
#include "scene/exchange/gltf/gltf.h"

namespace gonio::scene {
namespace {

class Gltf final : public Exchange {
 public:
  std::string_view name() const override { return "gltf"; }
  std::string_view sentence() const override { return "glTF 2.0 as scene.gltf and scene.bin, pictures as PNG"; }
  Exported write(const Scene& scene) const override { return gltf2::write_scene(scene); }
  std::vector<std::string_view> extensions() const override { return {".gltf", ".glb"}; }
  Imported read(const std::filesystem::path& path) const override { return gltf2::read_scene(path); }
};

}  // namespace

const Exchange& gltf() {
  static const Gltf format;
  return format;
}

}  // namespace gonio::scene
