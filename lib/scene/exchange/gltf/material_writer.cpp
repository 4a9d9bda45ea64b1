// Surfaces as materials of glTF 2.0 (scene/exchange/formats/gltf.cpp).
//
// Roughness is the root of alpha. Anisotropy of strength s has alpha along the tangent alpha + (1 - alpha) s^2 and
// alpha across it (KHR_materials_anisotropy). Absorption: what is left of white after attenuationDistance d is
// attenuationColor c = exp(-sigma_a d), with d the depth at which the band that is absorbed most falls to 1 / e.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "io/picture.h"
#include "io/raster.h"
#include "scene/exchange/gltf/gltf.h"

namespace gonio::scene::gltf2 {
namespace {

using manifest::Value;

Value list(Rgb v) {
  return Value(std::vector<double>{v.x, v.y, v.z});
}

Value factor(Rgb v) {
  const auto share = [](double c) { return std::clamp(c, 0.0, 1.0); };
  return Value(std::vector<double>{share(v.x), share(v.y), share(v.z), 1});
}

}  // namespace

int List::add(Value entry) {
  auto& all = entries_.as_array();
  const auto found = std::ranges::find(all, entry);
  const auto place = found - all.begin();
  if (found == all.end()) all.push_back(std::move(entry));
  return static_cast<int>(place);
}

void MaterialWriter::lose(const std::string& pointer, std::string what, std::string instead) {
  out_.losses.push_back({pointer, std::move(what), std::move(instead)});
}

Value& MaterialWriter::extension(Value& material, const char* name) {
  if (std::ranges::find(extensions_, name) == extensions_.end()) extensions_.emplace_back(name);
  Value& entry = material["extensions"][name];
  if (entry.is_null()) entry = Value::object();
  return entry;
}

// Colours as sRGB codes; alpha as the roughness that stands in the green channel.
Value MaterialWriter::texture(const Surface& surface, const Texture& texture) {
  const io::Image& from = *texture.picture;
  const std::size_t channels = from.channels.size();
  const bool colour = texture.name != "alpha";
  io::Image codes(from.width, from.height, {"R", "G", "B"});
  for (std::size_t i = 0; i < from.pixels(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const float v = from.data[i * channels + (channels < 3 || !colour ? 0 : c)];
      codes.data[3 * i + c] = colour ? io::srgb_from_linear(v) : c == 1 ? std::sqrt(std::max(v, 0.0f)) : 1.0f;
    }
  const std::string file = "pictures/" + file_stem(surface.id) + "-" + texture.name + ".png";
  out_.files.push_back({file, io::encode_raster_png(codes, 16)});
  lose("/surfaces/" + surface.id + "/textures/" + texture.name, "a texture of linear numbers",
       colour ? "16-bit sRGB codes" : "16-bit codes of its root");
  return Value::object(
      {{"index", textures_.add(Value::object({{"source", images_.add(Value::object({{"uri", file}}))}}))}});
}

void MaterialWriter::write_roughness(const Look& look, const Surface& surface, Value& material) {
  Value& model = material["pbrMetallicRoughness"];
  const double along = std::max(look.alpha_x, look.alpha_y), across = std::min(look.alpha_x, look.alpha_y);
  model["roughnessFactor"] = std::sqrt(across);
  if (const auto found = look.textures.find("alpha"); found != look.textures.end()) {
    model["roughnessFactor"] = 1;
    model["metallicRoughnessTexture"] = texture(surface, *found->second);
  } else if (along > across) {
    Value& entry = extension(material, "KHR_materials_anisotropy");
    entry["anisotropyStrength"] = std::sqrt((along - across) / (1 - across));
    entry["anisotropyRotation"] = look.azimuth_rad + (look.alpha_x < look.alpha_y ? pi / 2 : 0);
  }
}

void MaterialWriter::write_glass(const Look& look, const std::string& pointer, double size_m, Value& material) {
  extension(material, "KHR_materials_transmission")["transmissionFactor"] = 1;
  extension(material, "KHR_materials_ior")["ior"] = look.eta;
  Value& volume = extension(material, "KHR_materials_volume");
  volume["thicknessFactor"] = size_m;
  const Rgb sigma = look.medium.sigma_a_per_m;
  if (const double most = max_component(sigma); most > 0) {
    volume["attenuationDistance"] = 1 / most;
    volume["attenuationColor"] =
        list({std::exp(-sigma.x / most), std::exp(-sigma.y / most), std::exp(-sigma.z / most)});
  }
  if (look.medium.scatters()) lose(pointer + "/sigma_s_per_m", "scattering inside of a body", "absorption alone");
}

void MaterialWriter::write_kind(const Look& look, const std::string& pointer, double size_m, Value& material) {
  const bool metal = look.kind == Look::Kind::metal;
  material["pbrMetallicRoughness"] = Value::object({{"metallicFactor", metal ? 1 : 0}});
  const bool textured = look.textures.contains("albedo") || look.textures.contains("f0");
  if (!textured && look.kind != Look::Kind::glass)
    material["pbrMetallicRoughness"]["baseColorFactor"] = factor(look.colour);
  if (look.kind == Look::Kind::glass) {
    write_glass(look, pointer, size_m, material);
  } else if (look.kind == Look::Kind::matte) {
    extension(material, "KHR_materials_specular")["specularFactor"] = 0;
    material["doubleSided"] = true;
  } else if (!metal) {
    extension(material, "KHR_materials_ior")["ior"] = look.eta;
  }
  if (look.coat_eta > 0) {
    Value& coat = extension(material, "KHR_materials_clearcoat");
    coat["clearcoatFactor"] = 1;
    coat["clearcoatRoughnessFactor"] = std::sqrt(look.coat_alpha);
    if (std::abs(look.coat_eta - 1.5) > 1e-9) lose(pointer + "/eta", "the index of a coat", "a coat of index 1.5");
  }
}

void MaterialWriter::write_losses(const Look& look, const std::string& pointer) {
  using Kind = Look::Kind;
  if (look.sigma_rad > 0) lose(pointer + "/sigma_rad", "a rough matte", "Lambert's law");
  if (look.beckmann) lose(pointer, "Beckmann's slopes", "those of GGX of the same roughness");
  if (look.own_albedo && look.textures.contains("albedo"))
    lose(pointer + "/textures/albedo", "an albedo beneath the interface", "it as that seen through it, brighter");
  if (look.kind == Kind::coated || look.coat_eta > 0)
    lose(pointer, "light between a coat and its base", "a mix of base and gloss by the Fresnel factor");
  if (look.kind == Kind::metal && look.complex_index)
    lose(pointer, "the Fresnel factor of a complex index",
         "Schlick's rise from the same reflectance at normal incidence");
  if (look.kind == Kind::metal || (look.kind == Kind::glass && look.rough()))
    lose(pointer, "light that facets scatter twice", "a rough surface that loses it");
  if (look.kind == Kind::translucent)
    lose(pointer, "light beneath the surface", "a matte of the same reflectance within its interface");
}

int MaterialWriter::write(const Scene& scene, const Surface& surface, double size_m) {
  const std::string pointer = "/surfaces/" + surface.id;
  const Look look = look_of(scene.appearance, surface, out_.losses);
  Value material = Value::object({{"name", surface.id}});
  write_kind(look, pointer, size_m, material);
  if (look.kind != Look::Kind::matte) write_roughness(look, surface, material);
  for (const auto& [name, picture] : look.textures)
    if (name != "alpha") material["pbrMetallicRoughness"]["baseColorTexture"] = texture(surface, *picture);
  write_losses(look, pointer);
  materials_.push_back(std::move(material));
  return static_cast<int>(materials_.as_array().size()) - 1;
}

void MaterialWriter::finish(Value& root) const {
  for (const std::string& name : extensions_) root["extensionsUsed"].push_back(name);
  if (!materials_.as_array().empty()) root["materials"] = materials_;
  if (!textures_.empty()) root["textures"] = textures_.value();
  if (!images_.empty()) root["images"] = images_.value();
}

}  // namespace gonio::scene::gltf2
