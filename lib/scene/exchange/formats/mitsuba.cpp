// Mitsuba 3: one XML scene per image; meshes and pictures beside them.
//
// Conventions (Mitsuba 3 documentation, plugin reference):
// - Sensors look along +z with x to the left and y up; film coordinates run from 0 to 1 with pixel centres at (i + 0.5)
//   / n, and principal_point_offset is added to them. Pixels are square. Orthographic: the window is 2 by 2 / aspect,
//   scaled by to_world; the eye moves so that the axis meets the film's middle.
// - Surroundings: u = atan2(x, -z) / (2 pi), v = acos(y) / pi in the light's frame; so its z is our x, its x our y, its
//   y our z, turned by the rotation. Pictures carry the light's scale and the image's gain.
// - Texture rows run downwards with v: meshes ask for flip_tex_coords.
// - roughplastic reflects  rho / (1 - rho F) / eta^2 (1 - Fi) (1 - Fo)  with F the mean internal reflectance; albedo A
// as
//   seen through the interface is rho = A / (1 - F + A F).
// - Mitsuba 3 has no dipole: translucent bodies become the medium itself behind its interface.
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

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
  return out;
}
std::string item(const char* type, const char* name, const std::string& value) {
  return std::string("<") + type + " name=\"" + name + "\" value=\"" + value + "\"/>";
}
std::string number(const char* name, double value) {
  return item("float", name, shortest_text(value));
}
std::string rgb(const char* name, Rgb value) {
  return item("rgb", name, numbers(value, ", "));
}
std::string to_world(const Affine& affine) {
  return "<transform name=\"to_world\"><matrix value=\"" + affine.by_rows() + "\"/></transform>";
}

class Writer {
 public:
  explicit Writer(const Scene& scene) : scene_(scene) {}

  Exported write() {
    std::string shared = surfaces();
    shared += shapes();
    for (const Light& light : scene_.appearance.lights) lamps_.push_back(lamp_of(light, out_.losses));
    for (const View& view : scene_.views)
      out_.files.push_back({file_stem(view.image) + ".xml", "<scene version=\"3.0.0\">\n  <integrator type=\"" +
                                                                std::string(media_ ? "volpath" : "path") +
                                                                "\"><integer name=\"max_depth\" value=\"-1\"/>" +
                                                                "</integrator>\n" + sensor(view) + shared +
                                                                lights(view) + "</scene>\n"});
    return std::move(out_);
  }

 private:
  void lose(const std::string& pointer, std::string what, std::string instead) {
    out_.losses.push_back({pointer, std::move(what), std::move(instead)});
  }

  std::string picture(const io::Image& image, const std::string& name, Rgb scale = {1, 1, 1}) {
    io::Image rgb_image(image.width, image.height, {"R", "G", "B"});
    const std::size_t channels = image.channels.size();
    for (std::size_t i = 0; i < image.pixels(); ++i)
      for (std::size_t c = 0; c < 3; ++c)
        rgb_image.data[3 * i + c] =
            static_cast<float>(image.data[i * channels + (channels < 3 ? 0 : c)] * scale[static_cast<int>(c)]);
    const std::string file = "pictures/" + name + ".exr";
    out_.files.push_back({file, io::encode_exr(rgb_image)});
    return file;
  }

  std::string colour(const Look& look, const char* name, const char* parameter, Rgb value, const Surface& surface) {
    const auto texture = look.textures.find(parameter);
    if (texture == look.textures.end()) return rgb(name, value);
    const std::string file = picture(*texture->second->picture, file_stem(surface.id) + "-" + parameter);
    return "<texture type=\"bitmap\" name=\"" + std::string(name) + "\">" + item("string", "filename", file) +
           item("boolean", "raw", "true") + "</texture>";
  }

  std::string surfaces() {
    std::string text;
    for (const Surface& surface : scene_.appearance.surfaces) {
      const Look look = look_of(scene_.appearance, surface, out_.losses);
      text += "  " + bsdf(look, surface) + "\n";
      if (look.kind == Look::Kind::glass || look.kind == Look::Kind::translucent)
        if (look.medium.absorbs() || look.medium.scatters()) {
          media_ = true;
          text += "  " + medium(look, surface) + "\n";
        }
      looks_.push_back(look);
    }
    return text;
  }

  std::string roughness(const Look& look, const Surface& surface) {
    if (look.textures.contains("alpha")) return colour(look, "alpha", "alpha", {}, surface) + distribution(look);
    const bool plastic = look.kind == Look::Kind::coated;
    if (plastic && look.alpha_x != look.alpha_y)
      lose("/surfaces/" + surface.id, "an anisotropic coat", "an isotropic one of the same product");
    return distribution(look) + (plastic || look.alpha_x == look.alpha_y
                                     ? number("alpha", look.alpha())
                                     : number("alpha_u", look.alpha_x) + number("alpha_v", look.alpha_y));
  }
  static std::string distribution(const Look& look) {
    return item("string", "distribution", look.beckmann ? "beckmann" : "ggx");
  }

  std::string bsdf(const Look& look, const Surface& surface) {
    const std::string pointer = "/surfaces/" + surface.id, id = "\" id=\"" + escaped(surface.id) + "\">";
    const bool rough = look.rough() || look.textures.contains("alpha");
    const auto two = [&](const std::string& type, const std::string& body) {
      return "<bsdf type=\"twosided" + id + "<bsdf type=\"" + type + "\">" + body + "</bsdf></bsdf>";
    };
    if (look.azimuth_rad != 0) lose(pointer + "/azimuth_rad", "a turned tangent", "the tangent of the mesh");
    switch (look.kind) {
      case Look::Kind::matte:
        if (look.sigma_rad > 0) lose(pointer + "/sigma_rad", "a rough matte", "Lambert's law");
        return two("diffuse", colour(look, "reflectance", "albedo", look.colour, surface));
      case Look::Kind::coated: return coated(look, surface, two);
      case Look::Kind::metal: return metal(look, surface, two);
      default: break;
    }
    if (look.kind == Look::Kind::translucent)
      lose(pointer, "a dipole", "the medium itself, path traced behind its interface");
    if (std::abs(look.eta - 1) < 1e-9) return "<bsdf type=\"null" + id + "</bsdf>";
    return std::string("<bsdf type=\"") + (rough ? "roughdielectric" : "dielectric") + id +
           number("int_ior", look.eta) + number("ext_ior", 1) + (rough ? roughness(look, surface) : "") + "</bsdf>";
  }

  template <class Two>
  std::string coated(const Look& look, const Surface& surface, const Two& two) {
    const double inside = mean_internal_reflectance(look.eta);
    const std::string pointer = "/surfaces/" + surface.id;
    if (!look.own_albedo && look.textures.contains("albedo"))
      lose(pointer + "/textures/albedo", "an albedo as seen through the interface", "it as the albedo beneath, darker");
    if (look.sigma_rad > 0) lose(pointer + "/sigma_rad", "a rough matte base", "Lambert's law");
    lose(pointer, "energy that facets return by scattering twice", "a coat and base within about a percent");
    return two("roughplastic",
               colour(look, "diffuse_reflectance", "albedo", albedo_beneath(look.colour, inside), surface) +
                   number("int_ior", look.eta) + number("ext_ior", 1) + item("boolean", "nonlinear", "true") +
                   distribution(look) + number("alpha", std::max(look.alpha(), 1e-3)));
  }

  template <class Two>
  std::string metal(const Look& look, const Surface& surface, const Two& two) {
    const std::string pointer = "/surfaces/" + surface.id;
    const bool rough = look.rough() || look.textures.contains("alpha");
    std::string optics = rgb("eta", look.metal_eta) + rgb("k", look.metal_k);
    if (!look.complex_index) {
      lose(pointer, "Schlick's rise towards grazing angles", "the reflectance at normal incidence, everywhere");
      optics = item("string", "material", "none") + colour(look, "specular_reflectance", "f0", look.colour, surface);
    }
    if (rough) lose(pointer, "light that facets scatter twice", "a rough metal that loses it");
    if (look.coat_eta > 0) lose(pointer + "/base", "a coat over metal", "the metal alone");
    return two(rough ? "roughconductor" : "conductor", optics + (rough ? roughness(look, surface) : ""));
  }

  std::string medium(const Look& look, const Surface& surface) {
    const Rgb sigma_t = look.medium.sigma_a_per_m + look.medium.sigma_s_per_m;
    const auto share = [](double s, double t) { return t > 0 ? s / t : 0; };
    const Rgb& s = look.medium.sigma_s_per_m;
    const Rgb& g = look.medium.g;
    if (g.x != g.y || g.y != g.z) lose("/surfaces/" + surface.id + "/g", "an asymmetry g per band", "their mean");
    return "<medium type=\"homogeneous\" id=\"" + escaped(surface.id) + "-inside\">" + rgb("sigma_t", sigma_t) +
           rgb("albedo", {share(s.x, sigma_t.x), share(s.y, sigma_t.y), share(s.z, sigma_t.z)}) +
           "<phase type=\"hg\">" + number("g", level(g)) + "</phase></medium>";
  }

  std::string shapes() {
    std::string text;
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      const Instance& instance = scene_.instances[i];
      const Look& look = looks_[instance.surface];
      const bool native =
          look.textures.empty() && !std::holds_alternative<std::shared_ptr<const mesh::Mesh>>(instance.shape);
      const std::string pointer = "/objects/" + std::to_string(i),
                        id = escaped(scene_.appearance.surfaces[instance.surface].id);
      std::string inside;
      if (look.kind == Look::Kind::glass || look.kind == Look::Kind::translucent)
        if (look.medium.absorbs() || look.medium.scatters())
          inside = "<ref name=\"interior\" id=\"" + id + "-inside\"/>";
      if (instance.priority != 0)
        lose(pointer + "/priority", "priorities of overlapping media", "each interface against air");
      text +=
          "  " + (native ? analytic(instance) : ply(instance, i)) + "<ref id=\"" + id + "\"/>" + inside + "</shape>\n";
    }
    return text;
  }

  static std::string analytic(const Instance& instance) {
    if (const auto* sphere = std::get_if<Sphere>(&instance.shape)) {
      const double r = sphere->radius_m;
      return "<shape type=\"sphere\">" + to_world(affine_of(instance.world_from_object, {r, r, r}));
    }
    const Plane& plane = std::get<Plane>(instance.shape);
    return "<shape type=\"rectangle\">" +
           to_world(affine_of(instance.world_from_object, {plane.size_x_m / 2, plane.size_y_m / 2, 1}));
  }

  std::string ply(const Instance& instance, std::size_t i) {
    const io::TriangleMesh mesh = triangles_of(instance.shape);
    const std::string file = "meshes/" + std::to_string(i) + "-" + file_stem(instance.id) + ".ply";
    out_.files.push_back({file, compact_ply(mesh)});
    return "<shape type=\"ply\">" + item("string", "filename", file) +
           item("boolean", "face_normals", mesh.normals.empty() ? "true" : "false") +
           item("boolean", "flip_tex_coords", "true") + to_world(affine_of(instance.world_from_object));
  }

  std::string sensor(const View& view) {
    const Lens lens = lens_of(view);
    Stand stand = stand_of(view);
    std::string body, scale;
    if (lens.orthographic) {
      const Vec3 shift = view.world_from_camera.rotate(
          {(lens.width / 2.0 - 0.5 - lens.cx) / lens.fx, (lens.height / 2.0 - 0.5 - lens.cy) / lens.fy, 0});
      stand.eye += shift;
      stand.target += shift;
      scale = "<scale x=\"" + shortest_text(lens.width / (2 * lens.fx)) + "\" y=\"" +
              shortest_text(lens.width / (2 * lens.fy)) + "\"/>";
    } else {
      body = item("string", "fov_axis", "x") + number("fov", 2 * std::atan(lens.width / (2 * lens.fx)) * 180 / pi) +
             number("principal_point_offset_x", 0.5 - (lens.cx + 0.5) / lens.width) +
             number("principal_point_offset_y", 0.5 - (lens.cy + 0.5) / lens.height);
      if (square_error_px(lens) > 0.05)
        lose("/cameras/" + view.camera_name + "/fy_px", "pixels that are not square",
             format("square ones, off by up to %.3g px", square_error_px(lens)));
    }
    const bool thin = !lens.orthographic && view.lens.aperture_radius_m > 0;
    if (thin)
      body += number("aperture_radius", view.lens.aperture_radius_m) + number("focus_distance", view.lens.focus_m);
    return std::string("  <sensor type=\"") +
           (thin                ? "thinlens"
            : lens.orthographic ? "orthographic"
                                : "perspective") +
           "\">" + body + number("near_clip", 1e-4) + number("far_clip", 1e4) + "<transform name=\"to_world\">" +
           scale + "<lookat origin=\"" + numbers(stand.eye, ", ") + "\" target=\"" + numbers(stand.target, ", ") +
           "\" up=\"" + numbers(stand.up, ", ") +
           "\"/></transform><sampler type=\"independent\"><integer name=\"sample_count\" " +
           "value=\"64\"/></sampler><film type=\"hdrfilm\">" + item("integer", "width", std::to_string(lens.width)) +
           item("integer", "height", std::to_string(lens.height)) + "<rfilter type=\"box\"/></film></sensor>\n";
  }

  std::string lights(const View& view) {
    std::string text;
    bool surrounded = false;
    const auto add = [&](Lamp lamp) {
      lamp.value *= view.gain;
      if (lamp.infinite() && surrounded) {
        lose("/lights/" + lamp.id, "several surroundings at once", "the first only");
        return;
      }
      surrounded = surrounded || lamp.infinite();
      text += "  " + emitter(lamp, view) + "\n";
    };
    for (const std::size_t i : view.lights) add(lamps_[i]);
    if (scene_.appearance.ambient) add(ambient_lamp(*scene_.appearance.ambient));
    return text;
  }

  static Affine facing(const Lamp& lamp, double x, double y) {
    return {{lamp.x * x, cross(lamp.axis, lamp.x) * y, lamp.axis}, lamp.position_m};
  }

  std::string emitter(const Lamp& lamp, const View& view) {
    using Kind = Lamp::Kind;
    const std::string area = "<emitter type=\"area\">" + rgb("radiance", lamp.value) + "</emitter></shape>";
    switch (lamp.kind) {
      case Kind::point:
        return "<emitter type=\"point\"><point name=\"position\" value=\"" + numbers(lamp.position_m, ", ") + "\"/>" +
               rgb("intensity", lamp.value) + "</emitter>";
      case Kind::ball:
        return "<shape type=\"sphere\"><point name=\"center\" value=\"" + numbers(lamp.position_m, ", ") + "\"/>" +
               number("radius", lamp.radius_m) + area;
      case Kind::disc: return "<shape type=\"disk\">" + to_world(facing(lamp, lamp.radius_m, lamp.radius_m)) + area;
      case Kind::rectangle:
        return "<shape type=\"rectangle\">" + to_world(facing(lamp, lamp.size_x_m / 2, lamp.size_y_m / 2)) + area;
      case Kind::spot:
        lose_exponent(lamp, 0, out_.losses);
        lose("/lights/" + lamp.id, "a smooth edge of the cone", "one that falls off linearly with the angle");
        return "<emitter type=\"spot\">" + to_world(facing(lamp, 1, 1)) + rgb("intensity", lamp.value) +
               number("cutoff_angle", lamp.outer_rad * 180 / pi) + number("beam_width", lamp.inner_rad * 180 / pi) +
               "</emitter>";
      case Kind::directional:
        return "<emitter type=\"directional\"><vector name=\"direction\" value=\"" + numbers(-lamp.axis, ", ") +
               "\"/>" + rgb("irradiance", lamp.value) + "</emitter>";
      case Kind::uniform: return "<emitter type=\"constant\">" + rgb("radiance", lamp.value) + "</emitter>";
      case Kind::picture: break;
    }
    const double c = std::cos(lamp.rotation_rad), s = std::sin(lamp.rotation_rad);
    lose("/lights/" + lamp.id, "texels of constant radiance", "values interpolated between them");
    return "<emitter type=\"envmap\">" +
           item(
               "string", "filename",
               picture(*lamp.picture, "surroundings-" + file_stem(lamp.id) + "-" + file_stem(view.image), lamp.value)) +
           to_world({{Vec3{-s, c, 0}, Vec3{0, 0, 1}, Vec3{c, s, 0}}, {}}) + "</emitter>";
  }

  const Scene& scene_;
  Exported out_;
  std::vector<Look> looks_;
  std::vector<Lamp> lamps_;
  bool media_ = false;
};

class Mitsuba final : public Exchange {
 public:
  std::string_view name() const override { return "mitsuba"; }
  std::string_view sentence() const override {
    return "one XML scene per image for Mitsuba 3, PLY meshes, EXR pictures";
  }
  Exported write(const Scene& scene) const override { return Writer(scene).write(); }
};

}  // namespace

const Exchange& mitsuba() {
  static const Mitsuba format;
  return format;
}

}  // namespace gonio::scene
