// The manifests of the experiment: manifests.h.
#include "manifests.h"

#include <cmath>
#include <utility>

#include "glassware.h"
#include "mesh/mesh.h"
#include "render/looking_at.h"
#include "surface/surface.h"

namespace gonio::reassembly_experiment {
namespace {

using Pose = Rigid<frame::World, frame::Camera>;

Value list(Vec3 v) {
  return Value(std::vector<double>{v.x, v.y, v.z});
}
template <class To, class From>
Value motion(const Rigid<To, From>& m) {
  const Quaternion& q = m.rotation;
  return Value::object(
      {{"rotation", Value(std::vector<double>{q.w, q.x, q.y, q.z})}, {"translation_m", list(m.translation_m)}});
}

struct Card {
  const char* surface;
  Vec3 albedo;
  double sigma_rad, f0, alpha;
};
// Semi-matte cardboard, a white cloth with a sheen, blue satin bands, a dark stand: in the order of Material. Then the
// markers.
constexpr Card cards[] = {
    {"white-card", {0.78, 0.78, 0.76}, 0.1, 0.045, 0.30},  {"grey-card", {0.30, 0.31, 0.33}, 0.1, 0.045, 0.30},
    {"white-cloth", {0.72, 0.71, 0.68}, 0.45, 0.05, 0.38}, {"blue-cloth", {0.10, 0.20, 0.48}, 0.30, 0.09, 0.25},
    {"stand", {0.12, 0.10, 0.09}, 0.0, 0.05, 0.20},        {"marker", {0.02, 0.02, 0.02}, 0.0, 0.03, 0.35}};
constexpr std::int32_t materials = 5;  // of the background

surface::Values values_of(const Card& card) {
  surface::Values values;  // in the order of coated-diffuse: albedo, sigma_rad, f0, alpha
  values.v[0] = card.albedo;
  values.v[1] = {card.sigma_rad, card.sigma_rad, card.sigma_rad};
  values.v[2] = {card.f0, card.f0, card.f0};
  values.v[3] = {card.alpha, card.alpha, card.alpha};
  return values;
}

// 2 integral of albedo(c) c dc: what leaves of light that comes from everywhere alike.
Vec3 bihemispherical(const Card& card) {
  const surface::Model& model = *surface::find("coated-diffuse");
  const surface::Values values = values_of(card);
  Vec3 sum{};
  constexpr int steps = 64;
  for (int k = 0; k < steps; ++k) {
    const double c = (k + 0.5) / steps;
    sum += model.albedo(values, {std::sqrt(1 - c * c), 0, c}) * (2 * c / steps);
  }
  return sum;
}

Value camera(int width, int height, double focal_px) {
  return Value::object({{"model", "pinhole"},
                        {"width_px", width},
                        {"height_px", height},
                        {"fx_px", focal_px},
                        {"fy_px", focal_px},
                        {"cx_px", 0.5 * (width - 1)},
                        {"cy_px", 0.5 * (height - 1)}});
}

Value image(const std::string& id, const std::string& camera, const Pose& pose) {
  return Value::object({{"id", id},
                        {"camera", camera},
                        {"world_from_camera", motion(pose)},
                        {"noise", Value::object({{"gain", 16000}, {"read", 0.0005}})}});
}

constexpr Vec3 target{0.015, 0, 0.045};
constexpr double focal_widths = 2.15;  // focal length over the picture's width

Vec3 around(double azimuth_deg, double elevation_deg, double distance_m) {
  const double a = azimuth_deg * pi / 180, e = elevation_deg * pi / 180;
  return Vec3{std::sin(a) * std::cos(e), -std::cos(a) * std::cos(e), std::sin(e)} * distance_m;
}

// A stereo rig on an arm: two cameras 0.2 m apart that toe in, at three stations.
std::vector<std::pair<std::string, Pose>> stations() {
  std::vector<std::pair<std::string, Pose>> all;
  constexpr double azimuths[] = {-42, 0, 40}, elevations[] = {26, 33, 29};
  for (int s = 0; s < 3; ++s) {
    const Vec3 middle = target + around(azimuths[s], elevations[s], 0.82);
    const double a = azimuths[s] * pi / 180;
    const Vec3 along{std::cos(a), std::sin(a), 0};
    all.push_back({"s" + std::to_string(s + 1) + "-left", render::looking_at(middle - along * 0.1, target)});
    all.push_back({"s" + std::to_string(s + 1) + "-right", render::looking_at(middle + along * 0.1, target)});
  }
  return all;
}

void room_light(const Laboratory& laboratory, Value& document) {
  document["files"]["room"]["path"] = "room.exr";
  document["lights"]["room"] = Value::object({{"model", "lat-long"}, {"file", "room"}});
  document["mechanisms"]["light.near-environment"]["nearness_per_m"] = laboratory.near_per_m;
  document["mechanisms"]["optics.vignetting"]["falloff"] = laboratory.falloff;
}

Rigid<frame::World, frame::Light> world_from_standing(const Standing& at) {
  return {quaternion_of_rotation_vector({0, 0, at.turn_rad}), {at.x_m, at.y_m, at.z_m}};
}
Rigid<frame::World, frame::Light> place_of(const Glassware& piece, const Table& table) {
  const bool pot = piece.name.starts_with("pot"), lid = piece.name.ends_with("lid");
  Standing at = pot ? table.pot : table.bowl;
  if (lid) at.x_m += 0.0002, at.y_m -= 0.0001, at.turn_rad += 0.3;  // lids have some play
  return world_from_standing(at);
}

}  // namespace

void add_background(Value& document, const std::string& stem) {
  for (std::int32_t m = 0; m < materials; ++m) {
    const std::string name = std::string("background-") + cards[m].surface;
    document["files"][name] = Value::object({{"path", stem + "-" + cards[m].surface + ".ply"}});
    document["meshes"][name] = Value::object({{"file", name}, {"normals", "smooth"}});
    document["objects"].push_back(Value::object({{"id", name}, {"mesh", name}, {"surface", cards[m].surface}}));
  }
}

void write_parts(const std::filesystem::path& folder, const std::string& stem, io::TriangleMesh mesh) {
  mesh.normals = mesh::averaged_normals(mesh.positions_m, mesh.triangles);
  for (std::int32_t m = 0; m < materials; ++m) {
    io::TriangleMesh part;
    std::vector<std::uint32_t> place(mesh.positions_m.size(), UINT32_MAX);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.labels[t] != m) continue;
      std::array<std::uint32_t, 3> corners = mesh.triangles[t];
      for (std::uint32_t& v : corners) {
        if (place[v] == UINT32_MAX) {
          place[v] = static_cast<std::uint32_t>(part.positions_m.size());
          part.positions_m.push_back(mesh.positions_m[v]), part.normals.push_back(mesh.normals[v]);
        }
        v = place[v];
      }
      part.triangles.push_back(corners);
    }
    io::write_ply(folder / (stem + "-" + cards[m].surface + ".ply"), part);
  }
}

Value measured_surfaces() {
  Value surfaces = Value::object();
  for (const Card& card : cards)
    surfaces[card.surface] = Value::object({{"model", "coated-diffuse"},
                                            {"albedo", list(card.albedo)},
                                            {"sigma_rad", card.sigma_rad},
                                            {"f0", card.f0},
                                            {"alpha", card.alpha}});
  return Value::object({{"surfaces", surfaces}});
}

Value lambertian_surfaces() {
  Value surfaces = Value::object();
  for (const Card& card : cards)
    surfaces[card.surface] = Value::object({{"model", "diffuse"},
                                            {"albedo", list(bihemispherical(card))},
                                            {"sigma_rad", Value()},
                                            {"f0", Value()},
                                            {"alpha", Value()}});
  return Value::object({{"surfaces", surfaces}});
}

Value poses(const Laboratory& laboratory, std::size_t voxels) {
  Value all = Value::object();
  for (const Glassware& piece : glassware())
    all[piece.name] = motion(place_of(piece, laboratory.table) * inverse(tomograph_from_standing(piece, voxels)));
  return all;
}

Value truth(const Laboratory& laboratory, std::size_t voxels) {
  Value document = Value::object({{"gonio", 1}});
  room_light(laboratory, document);
  const int width = laboratory.width_px, height = width * 3 / 4;
  document["cameras"]["photo"] = camera(3 * width, 3 * height, focal_widths * 3 * width);
  document["cameras"]["small"] = camera(width, height, focal_widths * width);
  document["cameras"]["tiny"] = camera(width / 2, height / 2, focal_widths * width / 2);
  for (const auto& [id, pose] : stations()) document["images"].push_back(image(id, "photo", pose));
  document["images"].push_back(image("front", "small", stations()[2].second));
  document["images"].push_back(image("held", "tiny", stations()[1].second));
  merge(document, measured_surfaces());
  add_background(document, "pressed");
  for (const Glassware& piece : glassware()) {
    document["files"][piece.name]["path"] = piece.name + "-true.ply";
    document["meshes"][piece.name] = Value::object({{"file", piece.name}});
    document["surfaces"][piece.surface] =
        Value::object({{"model", "dielectric"}, {"eta", piece.eta}, {"sigma_a_per_m", list(piece.absorption_per_m)}});
    const auto place = place_of(piece, laboratory.table);
    document["objects"].push_back(
        Value::object({{"id", piece.name},
                       {"mesh", piece.name},
                       {"surface", piece.surface},
                       {"world_from_object", motion(place * inverse(tomograph_from_standing(piece, voxels)))}}));
    document["meshes"][piece.name + "-marker"]["sphere"]["radius_m"] = piece.markers.front().radius;
    int number = 0;
    for (const ct::Ball& ball : piece.markers)
      document["objects"].push_back(
          Value::object({{"id", piece.name + "-marker-" + std::to_string(++number)},
                         {"mesh", piece.name + "-marker"},
                         {"surface", "marker"},
                         {"world_from_object", Value::object({{"rotation", Value(std::vector<double>{1, 0, 0, 0})},
                                                              {"translation_m", list(place * ball.centre)}})}}));
  }
  return document;
}

Value believed() {
  Value patch = Value::object({{"objects", Value::array()}});
  for (const Glassware& piece : glassware()) {
    patch["files"][piece.name] = patch["meshes"][piece.name] = Value();
    patch["meshes"][piece.name + "-marker"] = patch["surfaces"][piece.surface] = Value();
  }
  for (std::int32_t m = 0; m < materials; ++m) {
    const std::string name = std::string("background-") + cards[m].surface;
    patch["files"][name] = patch["meshes"][name] = Value();
  }
  patch["mechanisms"] = patch["renderings"] = patch["provenance"] = Value();
  return patch;
}

Value ball(const Laboratory& laboratory) {
  Value document = Value::object({{"gonio", 1}});
  room_light(laboratory, document);
  const int width = 3 * laboratory.width_px, height = width * 3 / 4;
  document["cameras"]["photo"] = camera(width, height, focal_widths * width);
  // The middle of the scene's box, about which the walls stand.
  Vec3 low{1e9, 1e9, 1e9}, high = -low;
  for (const Vec3& p : laboratory.table.pressed.positions_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 centre = (low + high) * 0.5;
  for (const double azimuth : {-75.0, 60.0})
    document["images"].push_back(image(azimuth < 0 ? "ball-left" : "ball-right", "photo",
                                       render::looking_at(centre + around(azimuth, 20, 0.7), centre)));
  document["meshes"]["ball"]["sphere"]["radius_m"] = ball_radius_m;
  document["surfaces"]["chrome"] =
      Value::object({{"model", "conductor"}, {"alpha", 0}, {"eta", list(ball_eta)}, {"k", list(ball_k)}});
  document["objects"].push_back(Value::object(
      {{"id", "ball"},
       {"mesh", "ball"},
       {"surface", "chrome"},
       {"world_from_object",
        Value::object({{"rotation", Value(std::vector<double>{1, 0, 0, 0})}, {"translation_m", list(centre)}})}}));
  return document;
}

void merge(Value& into, const Value& patch) {
  if (!patch.is_object()) {
    into = patch;
    return;
  }
  if (!into.is_object()) into = Value::object();
  for (const auto& [key, value] : patch.as_object()) {
    if (value.is_null()) {
      std::erase_if(into.as_object(), [&](const Value::Member& member) { return member.first == key; });
    } else {
      merge(into[key], value);
    }
  }
}

Value assembled(Value rig, const std::string& background, const Value& poses, const std::vector<Value>& pieces) {
  rig["objects"] = Value::array();
  add_background(rig, background);
  for (const Value& piece : pieces) {
    for (const char* section : {"files", "meshes", "surfaces"}) merge(rig[section], *piece.find(section));
    const std::string id = piece.find("objects")->as_array().front().find("id")->as_string();
    for (Value object : piece.find("objects")->as_array()) {
      object["world_from_object"] = *poses.find(id);
      rig["objects"].push_back(object);
    }
    const Value& motion = *poses.find(id);
    const auto numbers = [&](const char* key, std::size_t k) { return motion.find(key)->as_array()[k].as_number(); };
    const Rigid<frame::World, frame::Object> pose{
        {numbers("rotation", 0), numbers("rotation", 1), numbers("rotation", 2), numbers("rotation", 3)},
        {numbers("translation_m", 0), numbers("translation_m", 1), numbers("translation_m", 2)}};
    for (const Value& marker : piece.find("markers")->as_array()) {
      const auto& c = marker.find("centre_m")->as_array();
      const std::string& name = marker.find("id")->as_string();
      rig["meshes"][name]["sphere"]["radius_m"] = *marker.find("radius_m");
      rig["objects"].push_back(Value::object(
          {{"id", name},
           {"mesh", name},
           {"surface", "marker"},
           {"world_from_object", Value::object({{"rotation", Value(std::vector<double>{1, 0, 0, 0})},
                                                {"translation_m", list(pose * Vec3{c[0].as_number(), c[1].as_number(),
                                                                                   c[2].as_number()})}})}}));
    }
  }
  return rig;
}

}  // namespace gonio::reassembly_experiment
