// pbrt-v4: one scene file per image; meshes and pictures beside them.
//
// Conventions (pbrt-v4 file format, and Pharr, Jakob & Humphreys 2023):
// - The camera looks along +z with x right and y up, and LookAt takes the world as left-handed: `Scale -1 1 1` before
// it
//   keeps a right-handed world unmirrored. screenwindow holds the principal point and two focal lengths, in units of
//   the tangent of half the field of view; orthographic: in metres.
// - Shapes, lights and media stand in world coordinates after WorldBegin; Transform takes a matrix column by column.
// - Surroundings are square pictures on which equal areas are equal solid angles (Clarberg 2008), z up: ours are drawn
//   anew, each pixel the mean of 4 x 4 directions.
// - Spots: the edge between inner and outer cone is the same 3 t^2 - 2 t^3.
// - The film of `rgb` leaves linear radiance as it is at iso 100, exposure 1.
// - coateddiffuse follows light through its layers at random: albedo A as seen through the interface becomes the base's
//   rho = A / (1 - F + A F), F the mean internal reflectance.
#include <algorithm>
#include <array>
#include <cmath>

#include "io/exr.h"
#include "scene/exchange/geometry.h"
#include "scene/exchange/lamp.h"
#include "scene/exchange/look.h"
#include "scene/exchange/text.h"

namespace gonio::scene {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return out + "\"";
}
std::string number(const char* name, double value) {
  return std::string(" \"float ") + name + "\" [ " + shortest_text(value) + " ]";
}
std::string rgb(const char* name, Rgb value) {
  return std::string(" \"rgb ") + name + "\" [ " + numbers(value) + " ]";
}
std::string words(const char* type_and_name, const std::string& value) {
  return std::string(" \"") + type_and_name + "\" [ " + quoted(value) + " ]";
}

// Direction of a point of the unit square (Clarberg 2008, section 3).
Vec3 equal_area_direction(double x, double y) {
  const double u = 2 * x - 1, v = 2 * y - 1, up = std::abs(u), vp = std::abs(v);
  const double rim = 1 - (up + vp), r = 1 - std::abs(rim);
  const double phi = (r == 0 ? 1 : (vp - up) / r + 1) * pi / 4, flat = r * std::sqrt(2 - r * r);
  return {std::copysign(std::cos(phi), u) * flat, std::copysign(std::sin(phi), v) * flat,
          std::copysign(1 - r * r, rim)};
}

io::Image equal_area_picture(const light::Emitter& emitter, int side, Rgb gain) {
  constexpr int fine = 4;
  io::Image picture(side, side, {"R", "G", "B"});
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      Rgb sum;
      for (int k = 0; k < fine * fine; ++k)
        sum += emitter
                   .hit({}, equal_area_direction((x + (k % fine + 0.5) / fine) / side,
                                                 (y + (k / fine + 0.5) / fine) / side))
                   .radiance;
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<float>(sum[c] * gain[c] / (fine * fine));
    }
  return picture;
}

class Writer {
 public:
  explicit Writer(const Scene& scene) : scene_(scene) {}

  Exported write() {
    std::string shared = surfaces();
    shared += shapes();
    for (const Light& light : scene_.appearance.lights) lamps_.push_back(lamp_of(light, out_.losses));
    for (const View& view : scene_.views)
      out_.files.push_back({file_stem(view.image) + ".pbrt", camera(view) + "WorldBegin\n" + lights(view) + shared});
    return std::move(out_);
  }

 private:
  void lose(const std::string& pointer, std::string what, std::string instead) {
    out_.losses.push_back({pointer, std::move(what), std::move(instead)});
  }

  std::string camera(const View& view) {
    const Lens lens = lens_of(view);
    const double width = lens.width, height = lens.height;
    const double unit = lens.orthographic ? 1 : std::min(0.5 * width / lens.fx, 0.5 * height / lens.fy);
    const double span_x = width / (lens.fx * unit), span_y = height / (lens.fy * unit);
    const double x_min = -(lens.cx + 0.5) / width * span_x, y_max = (lens.cy + 0.5) / height * span_y;
    const Stand stand = stand_of(view);
    std::string lens_text;
    if (!lens.orthographic) lens_text = number("fov", 2 * std::atan(unit) * 180 / pi);
    if (!lens.orthographic && view.lens.aperture_radius_m > 0)
      lens_text += number("lensradius", view.lens.aperture_radius_m) + number("focaldistance", view.lens.focus_m);
    return "Scale -1 1 1\nLookAt " + numbers(stand.eye) + "  " + numbers(stand.target) + "  " + numbers(stand.up) +
           "\nCamera \"" + (lens.orthographic ? "orthographic" : "perspective") + "\"" + lens_text +
           " \"float screenwindow\" [ " + shortest_text(x_min) + " " + shortest_text(x_min + span_x) + " " +
           shortest_text(y_max - span_y) + " " + shortest_text(y_max) + " ]\nFilm \"rgb\" \"integer xresolution\" [ " +
           std::to_string(lens.width) + " ] \"integer yresolution\" [ " + std::to_string(lens.height) + " ]" +
           words("string filename", file_stem(view.image) + ".exr") +
           "\nPixelFilter \"box\"\nSampler \"independent\" \"integer pixelsamples\" [ 64 ]\n" +
           "Integrator \"volpath\" \"integer maxdepth\" [ 128 ]\n";
  }

  std::string colour(const Look& look, const char* name, const char* parameter, Rgb value, const Surface& surface,
                     std::string& before) {
    const auto texture = look.textures.find(parameter);
    if (texture == look.textures.end())
      return std::string_view(parameter) == "alpha" ? number(name, value.x) : rgb(name, value);
    const std::string id = surface.id + "-" + parameter, file = "pictures/" + file_stem(id) + ".exr";
    const bool scalar = std::string_view(parameter) == "alpha";
    out_.files.push_back({file, io::encode_exr(*texture->second->picture)});
    before += "Texture " + quoted(id) + (scalar ? " \"float\"" : " \"spectrum\"") + " \"imagemap\"" +
              words("string filename", file) + words("string wrap", "repeat") + words("string filter", "bilinear") +
              "\n";
    return words((std::string("texture ") + name).c_str(), id);
  }

  std::string surfaces() {
    std::string text;
    for (const Surface& surface : scene_.appearance.surfaces) {
      const std::string pointer = "/surfaces/" + surface.id;
      const Look look = look_of(scene_.appearance, surface, out_.losses);
      std::string before;
      const std::string body = material(look, surface, before);
      text += before + "MakeNamedMaterial " + quoted(surface.id) + body + "\n";
      const Rgb g = look.medium.g;
      if (g.x != g.y || g.y != g.z) lose(pointer + "/g", "an asymmetry g per band", "their mean");
      if (has_medium(look))
        text += "MakeNamedMedium " + quoted(surface.id) + words("string type", "homogeneous") +
                rgb("sigma_a", look.medium.sigma_a_per_m) + rgb("sigma_s", look.medium.sigma_s_per_m) +
                number("g", level(look.medium.g)) + "\n";
      if (look.azimuth_rad != 0) lose(pointer + "/azimuth_rad", "a turned tangent", "the tangent of the mesh");
      if (look.beckmann) lose(pointer, "Beckmann's slopes", "those of GGX of the same roughness");
      looks_.push_back(look);
    }
    return text;
  }

  static bool has_medium(const Look& look) {
    return look.kind == Look::Kind::glass && (look.medium.absorbs() || look.medium.scatters());
  }

  std::string roughness(const Look& look, const Surface& surface, std::string& before) {
    const std::string remap = " \"bool remaproughness\" [ false ]";
    if (look.textures.contains("alpha")) return colour(look, "roughness", "alpha", {}, surface, before) + remap;
    return number("uroughness", look.alpha_x) + number("vroughness", look.alpha_y) + remap;
  }

  std::string material(const Look& look, const Surface& surface, std::string& before) {
    const std::string pointer = "/surfaces/" + surface.id;
    switch (look.kind) {
      case Look::Kind::matte:
        if (look.sigma_rad > 0) lose(pointer + "/sigma_rad", "a rough matte", "Lambert's law");
        return words("string type", "diffuse") + colour(look, "reflectance", "albedo", look.colour, surface, before);
      case Look::Kind::coated: return coated(look, surface, before);
      case Look::Kind::metal: return metal(look, surface, before);
      case Look::Kind::translucent:
        lose(pointer, "this dipole", "pbrt's photon beam diffusion of the same medium");
        return words("string type", "subsurface") + rgb("sigma_a", look.medium.sigma_a_per_m) +
               rgb("sigma_s", look.medium.sigma_s_per_m) + number("g", level(look.medium.g)) + number("eta", look.eta) +
               number("scale", 1) + roughness(look, surface, before);
      case Look::Kind::glass: break;
    }
    if (std::abs(look.eta - 1) < 1e-9) return words("string type", "interface");
    return words("string type", "dielectric") + number("eta", look.eta) + roughness(look, surface, before);
  }

  std::string metal(const Look& look, const Surface& surface, std::string& before) {
    const std::string pointer = "/surfaces/" + surface.id;
    lose(pointer, "light that facets scatter twice", "a rough metal that loses it");
    if (!look.complex_index)
      lose(pointer, "Schlick's rise towards grazing angles", "that of a conductor of the same reflectance");
    const bool coat = look.coat_eta > 0;
    const std::string optics = look.complex_index ? rgb(coat ? "conductor.eta" : "eta", look.metal_eta) +
                                                        rgb(coat ? "conductor.k" : "k", look.metal_k)
                                                  : colour(look, "reflectance", "f0", look.colour, surface, before);
    if (!coat) return words("string type", "conductor") + roughness(look, surface, before) + optics;
    lose(pointer, "a coat and base in closed form", "random paths between the layers, within about a percent");
    return words("string type", "coatedconductor") + optics + number("conductor.uroughness", look.alpha_x) +
           number("conductor.vroughness", look.alpha_y) + number("interface.roughness", look.coat_alpha) +
           number("interface.eta", look.coat_eta) + number("thickness", 1e-6) + " \"bool remaproughness\" [ false ]";
  }

  std::string coated(const Look& look, const Surface& surface, std::string& before) {
    const double inside = mean_internal_reflectance(look.eta);
    const std::string pointer = "/surfaces/" + surface.id;
    if (!look.own_albedo && look.textures.contains("albedo"))
      lose(pointer + "/textures/albedo", "an albedo as seen through the interface", "it as the albedo beneath, darker");
    if (look.sigma_rad > 0) lose(pointer + "/sigma_rad", "a rough matte base", "Lambert's law");
    lose(pointer, "a coat and base in closed form", "random paths between the layers, within about a percent");
    return words("string type", "coateddiffuse") +
           colour(look, "reflectance", "albedo", albedo_beneath(look.colour, inside), surface, before) +
           number("eta", look.eta) + number("thickness", 1e-6) + roughness(look, surface, before);
  }

  std::string shapes() {
    std::string text;
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      const Instance& instance = scene_.instances[i];
      const Surface& surface = scene_.appearance.surfaces[instance.surface];
      const Look& look = looks_[instance.surface];
      if (instance.priority != 0)
        lose("/objects/" + std::to_string(i) + "/priority", "priorities of overlapping media",
             "each interface against air");
      text += "AttributeBegin # " + file_stem(instance.id) + "\n  Transform [ " +
              affine_of(instance.world_from_object).by_columns() + " ]\n  NamedMaterial " + quoted(surface.id) + "\n";
      if (has_medium(look)) text += "  MediumInterface " + quoted(surface.id) + " \"\"\n";
      text += "  " + shape(instance, i, look) + "\nAttributeEnd\n";
    }
    return text;
  }

  std::string shape(const Instance& instance, std::size_t i, const Look& look) {
    if (const auto* sphere = std::get_if<Sphere>(&instance.shape); sphere && look.textures.empty())
      return "Shape \"sphere\"" + number("radius", sphere->radius_m);
    const std::string file = "meshes/" + std::to_string(i) + "-" + file_stem(instance.id) + ".ply";
    out_.files.push_back({file, compact_ply(triangles_of(instance.shape))});
    return "Shape \"plymesh\"" + words("string filename", file);
  }

  std::string lights(const View& view) {
    std::string text;
    for (const std::size_t i : view.lights) text += light(lamps_[i], &scene_.appearance.lights[i], view);
    if (scene_.appearance.ambient) text += light(ambient_lamp(*scene_.appearance.ambient), nullptr, view);
    return text;
  }

  static std::string from(Vec3 at) { return " \"point3 from\" [ " + numbers(at) + " ]"; }
  static std::string to(Vec3 at) { return " \"point3 to\" [ " + numbers(at) + " ]"; }

  std::string light(const Lamp& lamp, const Light* source, const View& view) {
    using Kind = Lamp::Kind;
    const Rgb value = lamp.value * view.gain;
    const std::string area = "  AreaLightSource \"diffuse\"" + rgb("L", value) + "\n";
    const auto turned = [&](double x, double y) {
      return "AttributeBegin\n  Transform [ " +
             Affine{{lamp.x * x, cross(lamp.axis, lamp.x) * y, lamp.axis}, lamp.position_m}.by_columns() + " ]\n" +
             area;
    };
    switch (lamp.kind) {
      case Kind::point: return "LightSource \"point\"" + from(lamp.position_m) + rgb("I", value) + "\n";
      case Kind::ball:
        return "AttributeBegin\n" + area + "  Translate " + numbers(lamp.position_m) + "\n  Shape \"sphere\"" +
               number("radius", lamp.radius_m) + "\nAttributeEnd\n";
      case Kind::disc: return turned(1, 1) + "  Shape \"disk\"" + number("radius", lamp.radius_m) + "\nAttributeEnd\n";
      case Kind::rectangle:
        return turned(lamp.size_x_m / 2, lamp.size_y_m / 2) +
               "  Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point3 P\" [ -1 -1 0  1 -1 0  1 1 0  -1 "
               "1 0 ]\n"
               "AttributeEnd\n";
      case Kind::spot:
        lose_exponent(lamp, 0, out_.losses);
        return "LightSource \"spot\"" + from(lamp.position_m) + to(lamp.position_m + lamp.axis) + rgb("I", value) +
               number("coneangle", lamp.outer_rad * 180 / pi) +
               number("conedeltaangle", (lamp.outer_rad - lamp.inner_rad) * 180 / pi) + "\n";
      case Kind::directional:
        return "LightSource \"distant\"" + from(lamp.axis) + to({0, 0, 0}) + rgb("L", value) + "\n";
      case Kind::uniform: return "LightSource \"infinite\"" + rgb("L", value) + "\n";
      case Kind::picture: break;
    }
    const int side = std::clamp(lamp.picture->width, 16, 2048);
    const std::string file = "pictures/surroundings-" + file_stem(lamp.id) + "-" + file_stem(view.image) + ".exr";
    out_.files.push_back({file, io::encode_exr(equal_area_picture(*source->emitter, side, view.gain))});
    lose("/lights/" + lamp.id, "a latitude-longitude picture",
         format("an equal-area one of %d x %d pixels", side, side));
    return "LightSource \"infinite\"" + words("string filename", file) + "\n";
  }

  const Scene& scene_;
  Exported out_;
  std::vector<Look> looks_;
  std::vector<Lamp> lamps_;
};

class Pbrt final : public Exchange {
 public:
  std::string_view name() const override { return "pbrt"; }
  std::string_view sentence() const override {
    return "one scene file per image for pbrt-v4, PLY meshes, EXR pictures";
  }
  Exported write(const Scene& scene) const override { return Writer(scene).write(); }
};

}  // namespace

const Exchange& pbrt() {
  static const Pbrt format;
  return format;
}

}  // namespace gonio::scene
