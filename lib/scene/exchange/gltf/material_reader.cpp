// Materials of glTF 2.0 as surfaces (scene/exchange/formats/gltf.cpp): glass where most of the light is transmitted,
// metal where most of it is metallic, else a matte, within its interface unless that reflects nothing; a clear coat
// over any of the opaque ones. Pictures become linear EXR files with the factors applied.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "io/exr.h"
#include "io/picture.h"
#include "io/raster.h"
#include "manifest/sections/surface.h"
#include "scene/exchange/gltf/gltf.h"
#include "surface/interface_albedo.h"

namespace gonio::scene::gltf2 {
namespace {

constexpr double smoothest = surface::min_alpha;  // of rough opaque surfaces

manifest::Parameter rgb(const std::vector<double>& v) {
  return manifest::Parameter(std::vector<double>{v[0], v[1], v[2]});
}

bool same(double a, double b) {
  return std::abs(a - b) < 1e-6;
}

}  // namespace

void MaterialReader::lose(const Item& at, std::string what, std::string instead) {
  imported_.losses.push_back({at.pointer(), std::move(what), std::move(instead)});
}

std::string MaterialReader::free_name(const std::string& wanted) const {
  return unused_name(imported_.document.surfaces, wanted, "surface");
}

io::Image MaterialReader::picture_of(const Item& texture) {
  const Item entry = source_.root().named("textures", texture["index"]);
  if (texture["texCoord"].count(0) != 0)
    lose(texture["texCoord"], "several sets of texture coordinates", "the first set");
  if (texture["extensions"]["KHR_texture_transform"].there())
    lose(texture, "texture coordinates that are transformed", "them as they are");
  if (!entry["source"].there()) entry.refuse("has no picture as PNG or JPEG", "export the file with such pictures");
  const Item image = source_.root().named("images", entry["source"]);
  if (image["bufferView"].there())
    return io::decode_raster(std::string(source_.view(image["bufferView"])), image.place());
  return io::decode_raster(source_.bytes_of(image["uri"]), image["uri"].place());
}

void MaterialReader::read_colour(const Item& factor, const Item& texture, const char* parameter,
                                 manifest::Surface& surface) {
  const std::vector<double> all = factor.numbers(4, {1, 1, 1, 1});
  if (!same(all[3], 1)) lose(factor, "surfaces with holes in them", "surfaces without");
  if (!texture.there()) {
    surface.parameters[parameter] = rgb(all);
    return;
  }
  io::Image codes = picture_of(texture);
  io::Image linear(codes.width, codes.height, {"R", "G", "B"});
  const std::size_t channels = codes.channels.size();
  for (std::size_t i = 0; i < linear.pixels(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      linear.data[3 * i + c] =
          io::linear_from_srgb(codes.data[i * channels + (channels < 3 ? 0 : c)]) * static_cast<float>(all[c]);
  const std::string file = "pictures/" + std::to_string(imported_.files.size()) + "-" + parameter + ".exr";
  imported_.files.push_back({file, io::encode_exr(linear)});
  surface.textures[parameter] = file;
}

// `alpha` is the square of roughness: of the factor times the texture's green channel.
void MaterialReader::read_roughness(const Item& pbr, manifest::Surface& surface) {
  const double roughness = pbr["roughnessFactor"].number(1);
  const bool glass = surface.model == "dielectric";
  const double least = glass ? 0 : smoothest;
  const Item texture = pbr["metallicRoughnessTexture"];
  if (!texture.there()) {
    surface.parameters["alpha"] = std::clamp(roughness * roughness, least, 1.0);
    return;
  }
  const io::Image codes = picture_of(texture);
  const std::size_t channels = codes.channels.size();
  io::Image alpha(codes.width, codes.height, {"Y"});
  for (std::size_t i = 0; i < alpha.pixels(); ++i) {
    const double share = roughness * codes.data[i * channels + (channels < 3 ? 0 : 1)];
    alpha.data[i] = static_cast<float>(std::clamp(share * share, least * (1 + 1e-6), 1.0));
  }
  const std::string file = "pictures/" + std::to_string(imported_.files.size()) + "-alpha.exr";
  imported_.files.push_back({file, io::encode_exr(alpha)});
  surface.textures["alpha"] = file;
  if (!same(pbr["metallicFactor"].number(1), 0) && !same(pbr["metallicFactor"].number(1), 1))
    lose(texture, "a share of metal that varies over the surface", "one kind of surface");
}

void MaterialReader::read_matte(const Item& material, manifest::Surface& surface) {
  const Item pbr = material["pbrMetallicRoughness"], extensions = material["extensions"];
  const double ior = extensions["KHR_materials_ior"]["ior"].number(1.5), r = (ior - 1) / (ior + 1);
  const double f0 = r * r * extensions["KHR_materials_specular"]["specularFactor"].number(1);
  surface.model = f0 > 0 ? "coated-diffuse" : "diffuse";
  read_colour(pbr["baseColorFactor"], pbr["baseColorTexture"], "albedo", surface);
  if (!(f0 > 0)) return;
  surface.parameters["f0"] = std::min(f0, surface::max_dielectric_f0);
  if (f0 > surface::max_dielectric_f0)
    lose(extensions["KHR_materials_ior"], "interfaces that reflect more than 0.2 at normal incidence", "one of 0.2");
  read_roughness(pbr, surface);
}

void MaterialReader::read_glass(const Item& material, manifest::Surface& surface) {
  const Item pbr = material["pbrMetallicRoughness"], extensions = material["extensions"];
  surface.model = "dielectric";
  surface.parameters["eta"] = std::clamp(extensions["KHR_materials_ior"]["ior"].number(1.5), 1.0, 4.0);
  read_roughness(pbr, surface);
  const std::vector<double> tint = pbr["baseColorFactor"].numbers(4, {1, 1, 1, 1});
  if (!same(tint[0], 1) || !same(tint[1], 1) || !same(tint[2], 1) || pbr["baseColorTexture"].there())
    lose(pbr, "an interface that colours what passes it", "a clear one");
  const Item volume = extensions["KHR_materials_volume"];
  if (!(volume["thicknessFactor"].number(0) > 0)) lose(material, "thin walls", "a massive body");
  if (!volume["attenuationDistance"].there()) return;
  const double distance = volume["attenuationDistance"].number();
  if (!(distance > 0)) volume["attenuationDistance"].refuse("is not above 0");
  std::vector<double> sigma = volume["attenuationColor"].numbers(3, {1, 1, 1});
  for (double& c : sigma) c = c >= 1 ? 0 : std::min(-std::log(std::max(c, 1e-12)) / distance, 1e6);
  surface.parameters["sigma_a_per_m"] = manifest::Parameter(sigma);
}

void MaterialReader::read_losses(const Item& material) {
  for (const char* texture : {"normalTexture", "occlusionTexture", "emissiveTexture"})
    if (material[texture].there()) lose(material[texture], std::string("a ") + texture, "nothing of it");
  const std::vector<double> glow = material["emissiveFactor"].numbers(3, {0, 0, 0});
  if (glow[0] > 0 || glow[1] > 0 || glow[2] > 0)
    lose(material["emissiveFactor"], "surfaces that shine", "no light from them");
  const std::string alpha = material["alphaMode"].text("OPAQUE");
  if (alpha != "OPAQUE") lose(material["alphaMode"], "surfaces with holes in them", "surfaces without");
  for (const std::string& name : material["extensions"].keys()) {
    static const std::vector<std::string> known = {"KHR_materials_ior",      "KHR_materials_transmission",
                                                   "KHR_materials_volume",   "KHR_materials_clearcoat",
                                                   "KHR_materials_specular", "KHR_materials_anisotropy"};
    if (std::ranges::find(known, name) == known.end()) lose(material["extensions"][name], name, "a surface without it");
  }
}

// The surface `name` under glTF's clear coat, of index 1.5, where it has one.
std::string MaterialReader::coat(const Item& material, const std::string& name) {
  const Item entry = material["extensions"]["KHR_materials_clearcoat"];
  const double share = entry["clearcoatFactor"].number(0);
  if (!(share > 0)) return name;
  if (!same(share, 1)) lose(entry["clearcoatFactor"], "part of a coat", "all of it");
  manifest::Surface over;
  over.model = "rough-coat";
  over.base = name;
  const double roughness = entry["clearcoatRoughnessFactor"].number(0);
  over.parameters["eta"] = 1.5;
  over.parameters["alpha"] = std::clamp(roughness * roughness, 0.0, 1.0);
  const std::string coated = free_name(name + "-coat");
  imported_.document.surfaces[coated] = std::move(over);
  return coated;
}

std::string MaterialReader::read(const Item& material) {
  const Item pbr = material["pbrMetallicRoughness"], extensions = material["extensions"];
  manifest::Surface surface;
  const double clear = extensions["KHR_materials_transmission"]["transmissionFactor"].number(0);
  const double metallic = pbr["metallicFactor"].number(1);
  if (!same(clear, 0) && !same(clear, 1)) lose(extensions, "a surface that is part glass", "the greater part alone");
  if (!same(metallic, 0) && !same(metallic, 1)) lose(pbr, "a surface that is part metal", "the greater part alone");
  const Item anisotropy = extensions["KHR_materials_anisotropy"];
  const double strength = anisotropy["anisotropyStrength"].number(0);
  if (clear >= 0.5) {
    read_glass(material, surface);
    if (const double across = surface.parameters["alpha"].value[0]; strength > 0 && across > 0) {
      const double along = across + (1 - across) * strength * strength;
      surface.parameters["alpha"] = along;
      surface.parameters["anisotropy"] = std::min(1.0, (1 - across / along) / 0.9);
      surface.parameters["azimuth_rad"] = std::remainder(anisotropy["anisotropyRotation"].number(0), 2 * pi);
    }
  } else if (metallic >= 0.5) {
    surface.model = "metal";
    read_colour(pbr["baseColorFactor"], pbr["baseColorTexture"], "f0", surface);
    read_roughness(pbr, surface);
  } else {
    read_matte(material, surface);
  }
  if (clear < 0.5 && strength > 0) lose(anisotropy, "anisotropic roughness of opaque surfaces", "an isotropic one");
  read_losses(material);
  manifest::Parameters all = surface.parameters;
  for (const auto& [parameter, file] : surface.textures) all[parameter] = 0.5;
  manifest::values_of(*manifest::find_model(manifest::Family::surface, surface.model), all, material.place());
  const std::string name = free_name(material["name"].text(""));
  imported_.document.surfaces[name] = std::move(surface);
  return clear < 0.5 ? coat(material, name) : name;
}

std::string MaterialReader::surface_of(const Item& index) {
  static const manifest::Value plain = manifest::Value::object();
  const Item material = index.there() ? source_.root().named("materials", index) : Item(&plain, source_.name(), "/");
  const auto [known, is_new] = known_.try_emplace(material.pointer());
  if (is_new) known->second = read(material);
  return known->second;
}

}  // namespace gonio::scene::gltf2
