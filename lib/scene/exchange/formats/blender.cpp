// Blender 3.x with Cycles: a Python script that builds the scene, and meshes and pictures beside it. The script's head
// says how to run it.
//
// Conventions, each tested against Blender itself (tests/scene/exchange_blender_test.cpp):
// - Camera: looks along -z with x right, y up: world_from_camera times a half turn about x. sensor_fit HORIZONTAL:
//   fx = lens / sensor_width times the width; shifts are of the window, in widths. Orthographic: ortho_scale is the
//   window's width in metres.
// - Point: of power P, I = P / (4 pi) and, for a ball, L = P / (4 pi^2 r^2), the radiance that has this intensity; area
//   lamp: L = P / (4 A); spot: I = P / (4 pi) cos(theta) S, S as in light/models/spot.cpp; sun: its strength is the
//   irradiance on a facing plane.
// - Surroundings: the picture's centre looks along +x, its left quarter along +y: ours, turned by a mapping node.
// - Rough glass: facets that scatter once. Cycles' other kind, MULTI_GGX, is even in even light, but takes a sixth off
//   the light of lamps behind rough glass and of what it throws beyond, for which there is no name.
// - Roughness is the root of alpha. The diffuse node's roughness is Fujii's: a + b s / t with b / a = roughness and
//   a = 1 / (pi + (pi / 2 - 2 / 3) roughness), also for s < 0, where Oren and Nayar's has none.
// - Absorption: density (1 - colour) = sigma_a; scattering: density colour = sigma_s.
// - Subsurface: radius is the diffusion length 1 / sigma_tr, colour the dipole's reflectance; Cycles inverts both for
//   its random walk.
// - Gains of images scale the lights: light is linear.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"
#include "io/exr.h"
#include "light/mechanisms/light_ambient.h"
#include "scene/exchange/blender_script.h"
#include "scene/exchange/geometry.h"
#include "scene/exchange/lamp.h"
#include "scene/exchange/lens.h"
#include "scene/exchange/look.h"

namespace gonio::scene {
namespace {

using manifest::Value;

constexpr double sensor_width_mm = 36;
constexpr double sphere_gap = 1e-4;  // of a sphere's triangles, in radii

Value list(std::initializer_list<double> values) {
  return Value(std::vector<double>(values));
}
Value list(Vec3 v) {
  return list({v.x, v.y, v.z});
}
Value list(Quaternion q) {
  return list({q.w, q.x, q.y, q.z});
}

class Writer {
 public:
  explicit Writer(const Scene& scene) : scene_(scene) {}

  Exported write() {
    Value numbers = Value::object();
    numbers["materials"] = materials();
    Value meshes = Value::object();
    numbers["objects"] = objects(meshes);
    numbers["meshes"] = meshes;
    Value lamps = Value::object(), surroundings = Value::object();
    lights(lamps, surroundings);
    numbers["lights"] = lamps;
    numbers["surroundings"] = surroundings;
    numbers["images"] = images();
    std::string text = manifest::print_json(numbers);
    for (std::size_t at = 0; (at = text.find('\'', at)) != std::string::npos;) text.replace(at, 1, "\\u0027");
    text = std::string(blender_script_head) + text;
    text += blender_script_building;
    text += blender_script_rendering;
    out_.files.insert(out_.files.begin(), {"scene.py", text});
    return std::move(out_);
  }

 private:
  void lose(const std::string& pointer, std::string what, std::string instead) {
    out_.losses.push_back({pointer, std::move(what), std::move(instead)});
  }

  Value picture(const io::Image& image, const std::string& name) {
    const std::string file = "pictures/" + name + ".exr";
    io::Image copy = image;
    if (copy.channels.size() < 3) {  // a single channel would be read as grey with other weights by some
      io::Image rgb(image.width, image.height, {"R", "G", "B"});
      for (std::size_t i = 0; i < image.pixels(); ++i)
        for (std::size_t c = 0; c < 3; ++c) rgb.data[3 * i + c] = image.data[i * image.channels.size()];
      copy = std::move(rgb);
    }
    out_.files.push_back({file, io::encode_exr(copy)});
    return Value(file);
  }

  Value materials() {
    Value all = Value::object();
    for (const Surface& surface : scene_.appearance.surfaces) all[surface.id] = material(surface);
    return all;
  }

  Value material(const Surface& surface) {
    const std::string pointer = "/surfaces/" + surface.id;
    const Look look = look_of(scene_.appearance, surface, out_.losses);
    static constexpr std::array<const char*, 5> kinds = {"matte", "coated", "metal", "glass", "translucent"};
    const RoughMatte rough = rough_matte(look.sigma_rad);
    const double scale = rough.scale * (1 + (0.5 - 2 / (3 * pi)) * rough.ratio);
    const bool textured = look.textures.contains("albedo") || look.textures.contains("f0");
    Value entry = Value::object({{"kind", kinds[static_cast<std::size_t>(look.kind)]},
                                 {"color", list(textured ? look.colour : look.colour * scale)},
                                 {"scale", scale},
                                 {"oren_nayar", rough.ratio},
                                 {"ior", look.eta},
                                 {"coat_ior", look.coat_eta},
                                 {"coat_alpha", look.coat_alpha},
                                 {"alpha", look.alpha()},
                                 {"beckmann", look.beckmann},
                                 {"anisotropic", anisotropic(look)},
                                 {"anisotropic_rotation", look.azimuth_rad / (2 * pi)},
                                 {"sigma_a", list(look.medium.sigma_a_per_m)},
                                 {"sigma_s", list(look.medium.sigma_s_per_m)},
                                 {"g", level(look.medium.g)},
                                 {"radius", list(look.diffuse_length_m)}});
    entry["textures"] = Value::object();
    for (const auto& [name, texture] : look.textures)
      entry["textures"][name == "alpha" ? "alpha" : "color"] =
          picture(*texture->picture, file_stem(surface.id) + "-" + name);
    approximations(look, pointer);
    return entry;
  }

  // Principled: aspect = sqrt(1 - 0.9 anisotropic), alpha_x = alpha / aspect, alpha_y = alpha aspect.
  double anisotropic(const Look& look) const {
    if (look.kind != Look::Kind::metal || !(look.alpha_x > 0) || !(look.alpha_y > 0)) return 0;
    const double squared = std::min(look.alpha_x, look.alpha_y) / std::max(look.alpha_x, look.alpha_y);
    return std::min(1.0, (1 - squared) / 0.9);
  }

  void approximations(const Look& look, const std::string& pointer) {
    const auto& g = look.medium.g;
    if (look.sigma_rad > 0)
      lose(pointer, "Oren and Nayar's law", "Fujii's variant of it: the same towards the light, darker away from it");
    if (look.kind == Look::Kind::coated)
      lose(pointer, "a base that loses what its interface reflects, on the way in and out",
           "a mix of base and gloss by the Fresnel factor of the view alone");
    if (look.own_albedo && look.textures.contains("albedo"))
      lose(pointer + "/textures/albedo", "an albedo beneath the interface", "it as that seen through it, brighter");
    if (look.coat_eta > 0)
      lose(pointer, "light between a coat and its base", "a mix of base and gloss by the Fresnel factor of the view");
    if (look.kind == Look::Kind::metal && look.complex_index)
      lose(pointer, "the Fresnel factor of a complex index",
           "Schlick's rise from the same reflectance at normal incidence");
    if (look.kind == Look::Kind::metal && look.rough() && !look.beckmann)
      lose(pointer, "light of several facets that leaves evenly",
           "the same light where such facets send it (Heitz et al. 2016)");
    if (look.kind == Look::Kind::metal && (!look.rough() || look.beckmann))
      lose(pointer, "a rise of reflectance towards grazing angles", "the reflectance at normal incidence, everywhere");
    if (look.kind == Look::Kind::glass && (look.rough() || look.textures.contains("alpha")))
      lose(pointer, "light that facets scatter twice",
           "a rough glass that loses it and mirrors by the Fresnel factor of the mean normal");
    if (look.kind == Look::Kind::translucent)
      lose(pointer, "a dipole", "a random walk of the same diffuse reflectance and diffusion length");
    if (look.kind != Look::Kind::metal && look.alpha_x != look.alpha_y)
      lose(pointer, "an anisotropic roughness", "an isotropic one of the same product");
    if (g.x != g.y || g.y != g.z) lose(pointer, "an asymmetry g per band", "their mean");
  }

  Value objects(Value& meshes) {
    Value all = Value::array();
    std::map<const mesh::Mesh*, std::string> known;
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      const Instance& instance = scene_.instances[i];
      const auto* shared = std::get_if<std::shared_ptr<const mesh::Mesh>>(&instance.shape);
      std::string& name = known[shared ? shared->get() : nullptr];
      if (!shared || name.empty()) {
        name = "mesh" + std::to_string(i);
        const std::string file = "meshes/" + std::to_string(i) + "-" + file_stem(instance.id) + ".ply";
        out_.files.push_back({file, compact_ply(triangles_of(instance.shape, sphere_gap))});
        meshes[name] = Value::object({{"file", file}});
      }
      if (std::holds_alternative<Sphere>(instance.shape))
        lose("/objects/" + std::to_string(i), "a sphere",
             format("triangles that leave at most %.0e of its radius", sagitta_of_sphere(sphere_gap)));
      if (instance.priority != 0)
        lose("/objects/" + std::to_string(i) + "/priority", "priorities of overlapping media",
             "both media at once, and each interface against air");
      all.push_back(Value::object({{"id", instance.id},
                                   {"mesh", name},
                                   {"material", scene_.appearance.surfaces[instance.surface].id},
                                   {"location", list(instance.world_from_object.translation_m)},
                                   {"rotation", list(instance.world_from_object.rotation)}}));
    }
    return all;
  }

  // The cosines between which the light fades, as a share of those within the cone.
  static double spot_blend(const Lamp& lamp) {
    return (std::cos(lamp.inner_rad) - std::cos(lamp.outer_rad)) / (1 - std::cos(lamp.outer_rad));
  }

  Value lamp_entry(const Lamp& lamp) {
    using Kind = Lamp::Kind;
    const double area =
        lamp.kind == Kind::rectangle ? lamp.size_x_m * lamp.size_y_m : pi * lamp.radius_m * lamp.radius_m;
    switch (lamp.kind) {
      case Kind::directional:
        return Value::object({{"kind", "SUN"}, {"power", list(lamp.value)}, {"towards", list(lamp.axis)}});
      case Kind::disc:
      case Kind::rectangle: {
        const bool disc = lamp.kind == Kind::disc;
        return Value::object(
            {{"kind", "AREA"},
             {"shape", disc ? "DISK" : "RECTANGLE"},
             {"power", list(lamp.value * (4 * area))},
             {"position", list(lamp.position_m)},
             {"rotation", list(lamp.turn())},
             {"size", disc ? list({2 * lamp.radius_m, 2 * lamp.radius_m}) : list({lamp.size_x_m, lamp.size_y_m})}});
      }
      case Kind::spot:
        lose_exponent(lamp, 1, out_.losses);
        return Value::object({{"kind", "SPOT"},
                              {"power", list(lamp.value * (4 * pi))},
                              {"position", list(lamp.position_m)},
                              {"rotation", list(lamp.turn())},
                              {"radius", lamp.radius_m},
                              {"spot_size", 2 * lamp.outer_rad},
                              {"spot_blend", spot_blend(lamp)}});
      default: {
        const double intensity = lamp.kind == Kind::ball ? area : 1;
        return Value::object({{"kind", "POINT"},
                              {"power", list(lamp.value * (4 * pi * intensity))},
                              {"position", list(lamp.position_m)},
                              {"radius", lamp.radius_m}});
      }
    }
  }

  void enter(const Lamp& lamp, Value& lamps, Value& surroundings) {
    if (!lamp.infinite()) {
      lamps[lamp.id] = lamp_entry(lamp);
      return;
    }
    Value& entry = surroundings[lamp.id] = Value::object({{"radiance", list(lamp.value)}});
    if (!lamp.picture) return;
    entry["rotation"] = lamp.rotation_rad;
    entry["file"] = picture(*lamp.picture, "surroundings-" + file_stem(lamp.id));
  }

  void lights(Value& lamps, Value& surroundings) {
    for (const Light& light : scene_.appearance.lights) enter(lamp_of(light, out_.losses), lamps, surroundings);
    if (scene_.appearance.ambient) enter(ambient_lamp(*scene_.appearance.ambient), lamps, surroundings);
  }

  Value images() {
    Value all = Value::array();
    for (const View& view : scene_.views) {
      Value lamps = Value::array(), surroundings = Value::array();
      for (const std::size_t i : view.lights) {
        const Light& light = scene_.appearance.lights[i];
        (light.emitter->infinite() ? surroundings : lamps).push_back(light.id);
      }
      if (scene_.appearance.ambient) surroundings.push_back(mechanism::light_ambient().id);
      all.push_back(Value::object({{"id", view.image},
                                   {"camera", camera(view)},
                                   {"lights", lamps},
                                   {"surroundings", surroundings},
                                   {"gain", list(view.gain)}}));
    }
    return all;
  }

  Value camera(const View& view) const {
    const Lens lens = lens_of(view);
    const double width = lens.width, height = lens.height, aspect = lens.fx / lens.fy;
    const Quaternion q = view.world_from_camera.rotation * Quaternion{0, 1, 0, 0};
    const double aperture = lens.orthographic ? 0 : view.lens.aperture_radius_m;
    return Value::object(
        {{"orthographic", lens.orthographic},
         {"location", list(view.world_from_camera.translation_m)},
         {"rotation", list(q)},
         {"sensor_width_mm", sensor_width_mm},
         {"lens_mm", sensor_width_mm * lens.fx / width},
         {"ortho_scale", width / lens.fx},
         {"shift", list({0.5 - (lens.cx + 0.5) / width, (lens.cy + 0.5 - 0.5 * height) * aspect / width})},
         {"resolution", Value(Value::Array{Value(lens.width), Value(lens.height)})},
         {"pixel_aspect", list({std::max(1.0, 1 / aspect), std::max(1.0, aspect)})},
         {"aperture_radius", aperture},
         {"focus", view.lens.focus_m},
         {"clip", list({1e-5, 1e5})}});
  }

  const Scene& scene_;
  Exported out_;
};

class Blender final : public Exchange {
 public:
  std::string_view name() const override { return "blender"; }
  std::string_view sentence() const override {
    return "Python script for Blender 3 with Cycles, PLY meshes, EXR pictures";
  }
  Exported write(const Scene& scene) const override { return Writer(scene).write(); }
};

}  // namespace

const Exchange& blender() {
  static const Blender format;
  return format;
}

}  // namespace gonio::scene
