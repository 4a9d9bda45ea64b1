// A scene: what a manifest describes, checked and ready to be simulated. World frame, metres.
//
// Geometry (instances) is heavy and never edited. Appearance (surfaces, lights, settings) is small: simulations of
// "what if" copy it and edit the copy, see apply_mechanism() in scene/mechanisms.h.
//
// Radiometry: the value of a pixel is the mean, over the pixel's square, of the radiance that arrives along the
// camera's rays (W / (m^2 sr) in the scene's unit), times the image's `gain`, times vignetting. Exposure times do not
// enter.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "camera/camera_model.h"
#include "geom/rigid.h"
#include "io/image.h"
#include "light/light.h"
#include "manifest/sections/forward.h"
#include "mesh/mesh.h"
#include "optics/bands.h"
#include "surface/surface.h"

namespace gonio::scene {

struct Sphere {  // centred at the object's origin
  double radius_m = 0;
};
struct Plane {  // in its own xy plane, centred at the origin, normal +z
  double size_x_m = 0, size_y_m = 0;
};
using Shape = std::variant<Sphere, Plane, std::shared_ptr<const mesh::Mesh>>;

struct Instance {  // an object of the manifest; number i in `instances` is id i + 1 in pictures (0: nothing there)
  std::string id;
  Shape shape;
  Rigid<frame::World, frame::Object> world_from_object;
  std::size_t surface = 0;  // place in Appearance::surfaces
  int priority = 0;         // of overlapping objects that let light through, the highest fills the space
};

struct Texture {
  std::string name;  // of the parameter that it replaces
  std::shared_ptr<const io::Image> picture;
  std::size_t parameter = 0;  // derived: place in the model's parameters
  Rgb at(Vec2 uv) const;      // bilinear, repeating; v grows upwards
};

// Where on an object: what decides on a surface's parameters there. Object frame.
struct Place {
  Vec2 uv{};
  Vec3 position_m{}, normal{};       // the unit shading normal, outwards
  const mesh::Mesh* mesh = nullptr;  // null for analytic shapes
  std::uint32_t triangle = 0;
  double b1 = 0, b2 = 0;  // barycentric coordinates of the triangle's second and third vertex
};

class Rule;  // scene/variation.h
struct Varying {
  std::string name;  // of the parameter that it replaces
  std::shared_ptr<const Rule> rule;
  std::size_t parameter = 0;  // derived: place in the model's parameters
};

struct Surface {
  std::string id{};
  const surface::Model* model = nullptr;
  manifest::Parameters parameters{};  // as in the manifest
  surface::Values values{};           // derived from `parameters`
  std::vector<Texture> textures{};
  std::vector<Varying> varying{};                        // per vertex, per face label, by a law
  std::map<std::string, std::vector<double>> spectra{};  // parameters that files state, in the bands
  optics::Bands bands{};                                 // of `values`; `parameters` are RGB
  std::shared_ptr<const surface::Prepared> prepared{};   // derived; values.prepared points to it
  std::filesystem::path file{};                          // of models that read a table
  std::optional<std::size_t> base{};                     // place in Appearance::surfaces of the surface beneath
  bool varies() const { return !textures.empty() || !varying.empty(); }  // else `values` hold everywhere
  surface::Values values_at(const Place& place) const;
};

struct Light {
  std::string id{};
  const light::Model* model = nullptr;
  manifest::Parameters parameters{};
  std::shared_ptr<const io::Image> picture{};
  std::filesystem::path file{};
  optics::Bands bands{};                            // of the emitter; `parameters` are RGB
  std::shared_ptr<const light::Emitter> emitter{};  // derived from `parameters`
};

struct Appearance {
  std::vector<Surface> surfaces;                  // in the order of their names
  std::vector<Light> lights;                      // in the order of their names
  std::shared_ptr<const light::Emitter> ambient;  // light.ambient: on in every image; null where there is none
  double indirect_strength = 1;   // transport.indirect: factor on light that was scattered more than once
  double vignetting_falloff = 0;  // optics.vignetting: pixel value *= 1 - falloff r^2
};

struct ThinLens {                             // optics.defocus; a radius of zero is a pinhole
  double aperture_radius_m = 0, focus_m = 1;  // focus: distance along the axis of what is sharp
};

struct View {  // one image to be simulated
  std::string image{};
  camera::CameraModel camera;
  Rigid<frame::World, frame::Camera> world_from_camera{};
  std::vector<std::size_t> lights{};  // that are on: places in Appearance::lights
  Rgb gain{1, 1, 1};
  ThinLens lens{};
  std::string camera_name{};
};

struct Scene {
  std::vector<Instance> instances;
  Appearance appearance;
  std::vector<View> views;  // one per image of the manifest, in its order
  optics::Bands bands;      // what the three components of every Rgb stand for
  Vec3 centre_m;            // of the box around meshes and spheres (around planes, where there is nothing else)
};

struct Reading {
  std::function<void(const std::filesystem::path&)> on_file;  // hears of every file that is read
  optics::Bands bands{};
  bool allow_open = false;                               // meshes with holes may bound media
  std::string image{};                                   // whose shapes things that deform have (scene/deformed.h)
  std::function<void(const std::string&)> on_warning{};  // hears what is odd about files; else it is logged
};
// Reads meshes and textures, checks everything, applies the `mechanisms` section. Error(data | no_input) at the place
// in the manifest. Without objects: Error(data).
Scene build_scene(const manifest::Document& document, const Reading& reading = {});

// Derives Surface::values and Light::emitter anew from model and parameters; `place` for messages.
void refresh(Surface& surface, const std::string& place);
void refresh(Light& light, const std::string& place);

// Factor by which optics.vignetting darkens `pixel`: 1 - falloff r^2, r the distance from the picture's centre over
// half its width. Exactly 1 at falloff 0; never below 0.
double vignetting(double falloff, int width_px, int height_px, Vec2 pixel);

}  // namespace gonio::scene
