// From the manifest to a scene: references followed, files read, impossible values refused in words.
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/progress.h"
#include "io/picture.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/environments.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "mesh/curvature.h"
#include "optics/colour.h"
#include "scene/amounts.h"
#include "scene/checks.h"
#include "scene/deformed.h"
#include "scene/edit.h"
#include "scene/mechanisms.h"
#include "scene/placement.h"
#include "scene/scene.h"
#include "scene/spectra.h"
#include "scene/variation.h"

namespace gonio::mechanism {
const Mechanism& light_second_source();
}

namespace gonio::scene {
namespace {

class Builder {
 public:
  Builder(const manifest::Document& document, const Reading& reading) : document_(document), reading_(reading) {}

  Scene build() {
    Scene scene;
    scene.bands = reading_.bands;
    for (const auto& [id, entry] : document_.surfaces) extend(wish_, entry);
    add_surfaces(scene.appearance);
    add_lights(scene.appearance);
    add_instances(scene);
    scene.centre_m = centre(scene.instances);
    std::map<std::string, manifest::Camera> cameras = document_.cameras;
    apply_mechanisms(scene, cameras);
    add_views(scene, cameras);
    if (!reading_.allow_open) require_closed(scene, [this](const std::string& pointer) { return at(pointer); });
    for (const Finding& f : check_lights(scene)) warn(at(f.pointer) + ": " + f.what + ": " + f.consequence);
    return scene;
  }

 private:
  std::string at(const std::string& pointer) const { return manifest::place(document_, pointer); }

  void warn(const std::string& message) const {
    if (reading_.on_warning)
      reading_.on_warning(message);
    else
      log(LogLevel::warning, message);
  }

  std::filesystem::path file(const std::string& id, const std::string& pointer) const {
    const auto path = manifest::resolve(document_, id, pointer);
    if (reading_.on_file) reading_.on_file(path);
    return path;
  }

  // Linear values: codes of 8/16-bit pictures are taken as sRGB where they stand for a colour.
  std::shared_ptr<const io::Image> picture(const std::string& id, const std::string& pointer, bool colour, double lower,
                                           double upper, bool as_sent = false) const {
    const auto path = file(id, pointer);
    io::Image image = io::read_picture(path);
    if (image.pixels() == 0) throw Error(Exit::data, path.string(), "picture is empty");
    if (colour && !as_sent && path.extension() != ".exr")
      for (float& v : image.data) v = io::linear_from_srgb(v);
    if (colour) image = in_bands(std::move(image), lower, upper, reading_.bands);
    return std::make_shared<const io::Image>(std::move(image));
  }

  void add_surfaces(Appearance& appearance) const {
    for (const auto& [id, entry] : document_.surfaces) {
      const std::string pointer = "/surfaces/" + id;
      Surface surface;
      surface.id = id;
      surface.model = surface::find(entry.model);
      surface.parameters = entry.parameters;
      if (!surface.model) throw Error(Exit::data, at(pointer + "/model"), "no surface model \"" + entry.model + "\"");
      for (const auto& [parameter, file_id] : entry.textures) {
        const auto& known = surface.model->info().parameters;
        const auto found =
            std::find_if(known.begin(), known.end(), [&, key = &parameter](const auto& p) { return p.name == *key; });
        const bool colour = found != known.end() && found->rgb;
        const auto [lower, upper] = colour ? std::pair(found->lower, found->upper) : std::pair(0.0, 0.0);
        surface.textures.push_back(
            {parameter, picture(file_id, pointer + "/textures/" + parameter, colour, lower, upper)});
      }
      if (!entry.file.empty()) surface.file = file(entry.file, pointer + "/file");
      surface.varying = rules_of(entry, *surface.model, wish_, at(pointer));
      fill_bands(surface, entry, pointer);
      refresh(surface, at(pointer));
      check_inside(surface, at(pointer));
      appearance.surfaces.push_back(std::move(surface));
    }
    for (Surface& surface : appearance.surfaces) {
      const std::string& base = document_.surfaces.at(surface.id).base;
      if (!base.empty()) surface.base = surface_index(appearance, base, "/surfaces/" + surface.id + "/base");
    }
  }

  void fill_bands(Surface& surface, const manifest::Surface& entry, const std::string& pointer) const {
    surface.bands = reading_.bands;
    in_bands(surface);
    for (const auto& [parameter, file_id] : entry.spectra) {
      const std::string place = pointer + "/spectra/" + parameter;
      surface.spectra[parameter] =
          spectrum_in_bands(file(file_id, place), surface.model->info(), parameter, reading_.bands, at(place));
    }
  }

  void add_lights(Appearance& appearance) const {
    for (const auto& [id, stated] : document_.lights) {
      const std::string pointer = "/lights/" + id, pictured = manifest::picture_pointer(document_, id);
      const manifest::Light entry = manifest::with_environment(document_, id);
      Light light;
      light.id = id;
      light.model = light::find(entry.model);
      light.parameters = entry.parameters;
      if (!light.model) throw Error(Exit::data, at(pointer + "/model"), "no light model \"" + entry.model + "\"");
      if (!entry.file.empty()) {
        light.file = file(entry.file, pictured);
        if (light.model->info().attachment == manifest::Attachment::picture)
          light.picture = picture(entry.file, pictured, true, 0, std::numeric_limits<double>::infinity(),
                                  light.model->info().attachment_as_sent);
      }
      light.bands = reading_.bands;
      refresh(light, at(pointer));
      appearance.lights.push_back(std::move(light));
    }
  }

  static double positive(double v, const char* what, const std::string& place) {
    if (!(v > 0) || !std::isfinite(v))
      throw Error(Exit::data, place, std::string(what) + " " + std::to_string(v) + " m is not a positive length",
                  "give metres");
    return v;
  }

  Shape shape(const std::string& id, const std::string& object) {
    const std::string pointer = "/meshes/" + id;
    const auto entry = document_.meshes.find(id);
    if (entry == document_.meshes.end()) throw Error(Exit::data, at(pointer), "no such mesh", "name one of `meshes`");
    const manifest::Mesh& mesh = entry->second;
    if (mesh.sphere_radius_m)
      return Sphere{positive(*mesh.sphere_radius_m, "radius", at(pointer + "/sphere/radius_m"))};
    if (mesh.plane_size_m) {
      const std::string place = at(pointer + "/plane/size_m");
      if (mesh.plane_size_m->size() != 2)
        throw Error(Exit::data, place, "a plane has two sizes", "give [x, y] in metres");
      return Plane{positive((*mesh.plane_size_m)[0], "size", place), positive((*mesh.plane_size_m)[1], "size", place)};
    }
    if (mesh.file.empty()) throw Error(Exit::data, at(pointer), "neither file nor sphere nor plane", "name a PLY file");
    const double share = mesh.shapes.empty() ? 0 : deformation_of(document_, object, reading_.image);
    auto& known = meshes_[{id, share}];
    if (!known) known = read_mesh(id, share, wish_of(id), pointer);
    return known;
  }

  // What the surfaces of the objects that show mesh `id` want of it. Properties keep their numbers.
  Wish wish_of(const std::string& id) const {
    Wish wanted;
    for (const manifest::Object& object : document_.objects)
      if (object.mesh == id)
        if (const auto outer = document_.surfaces.find(object.surface); outer != document_.surfaces.end()) {
          extend(wanted, outer->second);
          if (const auto beneath = document_.surfaces.find(outer->second.base); beneath != document_.surfaces.end())
            extend(wanted, beneath->second);
        }
    Wish numbered = wish_;
    for (std::string& name : numbered.ply.properties)
      if (std::find(wanted.ply.properties.begin(), wanted.ply.properties.end(), name) == wanted.ply.properties.end())
        name.clear();
    numbered.ply.labels = wanted.ply.labels;
    numbered.curvature = wanted.curvature;
    return numbered;
  }

  std::shared_ptr<const mesh::Mesh> read_mesh(const std::string& id, double share, const Wish& wish,
                                              const std::string& pointer) const {
    const manifest::Mesh& entry = document_.meshes.at(id);
    const auto path = manifest::resolve(document_, entry.file, pointer + "/file");
    const auto shading = entry.normals == "flat" ? mesh::Shading::flat : mesh::Shading::smooth;
    std::size_t dropped = 0;
    mesh::Mesh mesh = mesh::prepare(deformed_mesh(document_, id, share, wish.ply, reading_.on_file), shading,
                                    path.string(), &dropped);
    if (wish.curvature) mesh.mean_curvature_per_m = mesh::mean_curvature_per_m(mesh);
    if (dropped > 0)
      warn(path.string() + ": " + std::to_string(dropped) + " of " + std::to_string(dropped + mesh.triangles.size()) +
           " triangles have no area and are left out; where they closed a gap there is a hole now");
    return std::make_shared<const mesh::Mesh>(std::move(mesh));
  }

  std::size_t surface_index(const Appearance& appearance, const std::string& id, const std::string& pointer) const {
    const auto& all = appearance.surfaces;
    const auto found = std::find_if(all.begin(), all.end(), [&](const Surface& s) { return s.id == id; });
    if (found == all.end()) throw Error(Exit::data, at(pointer), "no surface \"" + id + "\"", "name one of `surfaces`");
    return static_cast<std::size_t>(found - all.begin());
  }

  template <class To, class From>
  Rigid<To, From> pose(const std::optional<manifest::Pose<To, From>>& given, const std::string& pointer) const {
    if (!given) return {};
    const Quaternion& q = given->rotation;
    const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    if (!is_finite(given->translation_m) || !(std::abs(length - 1) < 1e-5))
      throw Error(Exit::data, at(pointer), "pose is not finite or its rotation has no unit length (limit 1e-5)",
                  "check the pose's numbers");
    return {normalized(q), given->translation_m};
  }

  void add_instances(Scene& scene) {
    if (document_.objects.empty())
      throw Error(Exit::data, at("/objects"), "nothing to be seen", "add an object to the scene");
    for (std::size_t i = 0; i < document_.objects.size(); ++i) {
      const manifest::Object& object = document_.objects[i];
      const std::string pointer = "/objects/" + std::to_string(i);
      scene.instances.push_back(
          {object.id, shape(object.mesh, object.id), pose(object.world_from_object, pointer + "/world_from_object"),
           surface_index(scene.appearance, object.surface, pointer + "/surface"), object.priority.value_or(0)});
      const Surface& outer = scene.appearance.surfaces[scene.instances.back().surface];
      check_fit(outer, scene.instances.back().shape, at(pointer));
      if (outer.base) check_fit(scene.appearance.surfaces[*outer.base], scene.instances.back().shape, at(pointer));
    }
  }

  // Centre of the box around everything but planes: how far a table reaches says nothing about where the scene is.
  static Vec3 centre(const std::vector<Instance>& instances) {
    for (const bool planes : {false, true}) {
      Vec3 low{1e300, 1e300, 1e300}, high = -low;
      for (const Instance& instance : instances) grow(instance, planes, low, high);
      if (low.x <= high.x) return (low + high) * 0.5;
    }
    return {};
  }

  static void grow(const Instance& instance, bool planes, Vec3& low, Vec3& high) {
    const auto include = [&](Vec3 p) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    };
    const auto& world_from_object = instance.world_from_object;
    if (const auto* sphere = std::get_if<Sphere>(&instance.shape)) {
      const Vec3 r{sphere->radius_m, sphere->radius_m, sphere->radius_m};
      include(world_from_object.translation_m - r);
      include(world_from_object.translation_m + r);
    } else if (const auto* plane = std::get_if<Plane>(&instance.shape)) {
      if (!planes) return;
      for (const double sx : {-0.5, 0.5})
        for (const double sy : {-0.5, 0.5})
          include(world_from_object * Vec3{sx * plane->size_x_m, sy * plane->size_y_m, 0});
    } else {
      const Mat3 rotation = matrix_of(world_from_object.rotation);
      for (const Vec3 p : std::get<std::shared_ptr<const mesh::Mesh>>(instance.shape)->positions_m)
        include(rotation * p + world_from_object.translation_m);
    }
  }

  void apply_mechanisms(Scene& scene, std::map<std::string, manifest::Camera>& cameras) const {
    for (const auto& [id, use] : document_.mechanisms) {
      const mechanism::Mechanism* mechanism = mechanism::find_mechanism(id);
      const std::string place = at("/mechanisms/" + id);
      if (!mechanism) throw Error(Exit::data, place, "no such mechanism", "gonio-manifest(5) lists them");
      if (beyond_rendering(*mechanism)) warn(id + " is not rendered; the picture is without it");
      apply_mechanism(scene.appearance, *mechanism, use, scene.centre_m, place);
      apply_mechanism(scene.instances, *mechanism, use, place);
      for (auto& [name, camera] : cameras) apply_mechanism(camera, name, *mechanism, use, place);
    }
  }

  // What lamps give at the time of an image over what they are stated to; 1 where it states none.
  Rgb lamps_at(const manifest::ImageEntry& image) const {
    if (!image.time_s) return {1, 1, 1};
    double first_s = *image.time_s, last_s = first_s;
    for (const manifest::ImageEntry& other : document_.images) {
      first_s = std::min(first_s, other.time_s.value_or(first_s));
      last_s = std::max(last_s, other.time_s.value_or(last_s));
    }
    const double since_s = *image.time_s - first_s, along = last_s > first_s ? since_s / (last_s - first_s) : 0;
    const Moment moment{since_s, along};
    Rgb factor{1, 1, 1};
    for (const auto& [id, use] : document_.mechanisms) {
      const mechanism::Mechanism* mechanism = mechanism::find_mechanism(id);
      const Edit* edit = mechanism != nullptr ? find_edit(*mechanism) : nullptr;
      if (edit != nullptr && edit->lamps != nullptr)
        factor *= edit->lamps(amounts_of(*mechanism, use, 0, 1, at("/mechanisms/" + id)), moment);
    }
    return factor;
  }

  static bool is_companion(const std::string& id, const std::string& of) {
    const std::size_t blank = id.size() > of.size() ? id.size() - of.size() - 1 : 0;
    if (blank == 0 || id[blank] != ' ' || !id.ends_with(of)) return false;
    const mechanism::Mechanism* mechanism = mechanism::find_mechanism(id.substr(0, blank));
    const Edit* edit = mechanism != nullptr ? find_edit(*mechanism) : nullptr;
    return edit != nullptr && edit->companion != nullptr;
  }

  // What mechanisms of single pictures make of this one.
  double factor_of(const manifest::ImageEntry& image) const {
    double factor = 1;
    for (const auto& [id, use] : document_.mechanisms) {
      const mechanism::Mechanism* mechanism = mechanism::find_mechanism(id);
      const Edit* edit = mechanism != nullptr ? find_edit(*mechanism) : nullptr;
      if (edit == nullptr || edit->picture == nullptr) continue;
      const auto found = std::find(use.on.begin(), use.on.end(), image.id);
      if (!use.on.empty() && found == use.on.end()) continue;
      const auto place = static_cast<std::size_t>(found - use.on.begin());
      factor *= edit->picture(
          amounts_of(*mechanism, use, place, std::max<std::size_t>(1, use.on.size()), at("/mechanisms/" + id)));
    }
    return factor;
  }

  std::vector<std::size_t> lights_of(const Scene& scene, const manifest::ImageEntry& image,
                                     const std::string& pointer) const {
    const auto& all = scene.appearance.lights;
    std::vector<std::size_t> lights;
    for (const std::string& name : image.light) {
      const auto found = std::find_if(all.begin(), all.end(), [&](const Light& l) { return l.id == name; });
      if (found == all.end())
        throw Error(Exit::data, at(pointer + "/light"), "no light \"" + name + "\"", "name one of `lights`");
      lights.push_back(static_cast<std::size_t>(found - all.begin()));
    }
    for (std::size_t i = 0, named = lights.size(); i < all.size(); ++i)
      for (std::size_t k = 0; k < named; ++k)
        if (is_companion(all[i].id, all[lights[k]].id)) lights.push_back(i);
    for (std::size_t i = 0; i < all.size(); ++i)
      if ((image.light.empty() && !image.dark.value_or(false)) || all[i].id == mechanism::light_second_source().id)
        lights.push_back(i);
    return lights;
  }

  void add_views(Scene& scene, const std::map<std::string, manifest::Camera>& cameras) const {
    for (std::size_t i = 0; i < document_.images.size(); ++i) {
      const manifest::ImageEntry& image = document_.images[i];
      const std::string pointer = "/images/" + std::to_string(i);
      const auto camera = cameras.find(image.camera);
      if (camera == cameras.end())
        throw Error(Exit::data, at(pointer + "/camera"), "no camera \"" + image.camera + "\"", "name one of `cameras`");
      scene.views.push_back(
          {image.id,
           camera::CameraModel(camera->second, at("/cameras/" + image.camera)),
           pose(image.world_from_camera, pointer + "/world_from_camera"),
           lights_of(scene, image, pointer),
           optics::upsampled(image.gain && image.gain->given() ? image.gain->rgb() : Rgb{1, 1, 1}, reading_.bands),
           {},
           image.camera});
      scene.views.back().gain *= lamps_at(image) * factor_of(image);
      for (const auto& [id, use] : document_.mechanisms)
        apply_mechanism(scene.views.back(), *mechanism::find_mechanism(id), use, at("/mechanisms/" + id));
    }
  }

  const manifest::Document& document_;
  const Reading& reading_;
  Wish wish_;
  std::map<std::pair<std::string, double>, std::shared_ptr<const mesh::Mesh>> meshes_;  // by id and deformation
};

}  // namespace

Scene build_scene(const manifest::Document& document, const Reading& reading) {
  return Builder(document, reading).build();
}

}  // namespace gonio::scene
