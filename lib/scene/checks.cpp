// Checks of scenes (scene/checks.h). Points are tested against bodies by winding numbers: a point is inside where the
// mesh goes around it at least half a time.
#include "scene/checks.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "mesh/inside.h"
#include "mesh/topology.h"
#include "scene/checks_body.h"

namespace gonio::scene {
namespace {

class Checker {
 public:
  explicit Checker(const Scene& scene) : scene_(scene) {
    for (const Instance& instance : scene.instances) bodies_.emplace_back(instance, surface_of(instance));
  }

  std::vector<Finding> findings() {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      check_mesh(i);
      check_texture(i);
    }
    check_overlaps();
    check_lights();
    for (std::size_t i = 0; i < scene_.views.size(); ++i) check_view(i);
    return std::move(found_);
  }

  std::vector<Finding> findings_of_lights() {
    check_lights();
    return std::move(found_);
  }

 private:
  const Surface& surface_of(const Instance& instance) const { return scene_.appearance.surfaces[instance.surface]; }
  static std::string object(std::size_t i) { return "/objects/" + std::to_string(i); }
  std::string quoted(std::size_t i) const { return "\"" + scene_.instances[i].id + "\""; }
  void find(std::string pointer, std::string what, std::string consequence) {
    found_.push_back({std::move(pointer), std::move(what), std::move(consequence)});
  }

  void check_mesh(std::size_t i) {
    const Body& body = bodies_[i];
    if (!body.mesh()) {
      if (body.transmits() && !body.closed())
        find(object(i), quoted(i) + " is a plane that bounds a medium", open_consequence());
      return;
    }
    const mesh::Topology& topology = body.topology();
    if (body.needs_volume() && topology.boundary_edges > 0)
      find(object(i), "the mesh of " + quoted(i) + " " + open_words(topology),
           body.transmits() ? open_consequence() : "light that scatters beneath its surface has no inside to stay in");
    if (topology.disagreeing_edges > 0)
      find(object(i),
           std::to_string(topology.disagreeing_edges) + " edges of " + quoted(i) +
               " join triangles that face opposite ways",
           "inside and outside change places there; normals of vertices near them are wrong");
    if (topology.crowded_edges > 0 && body.needs_volume())
      find(object(i),
           "more than two triangles meet at " + std::to_string(topology.crowded_edges) + " edges of " + quoted(i),
           "walls that touch or pass through each other count as interfaces of the medium");
    if (topology.collapsed_triangles > 0)
      find(object(i),
           std::to_string(topology.collapsed_triangles) + " triangles of " + quoted(i) +
               " have two corners at one place",
           "they show nothing; an edge that only they close is a hole");
    if (topology.closed() && topology.volume_m3 < 0)
      find(object(i), quoted(i) + " faces inwards (signed volume " + format("%.3g", topology.volume_m3) + " m^3)",
           body.transmits() ? "a cavity in glass instead of a body of glass; turn its triangles"
                            : "its normals point inwards in every picture of normals; turn its triangles");
    check_normals(i, *body.mesh());
  }

  void check_normals(std::size_t i, const mesh::Mesh& mesh) {
    if (mesh.normals.empty()) return;
    std::size_t against = 0;
    for (const auto& t : mesh.triangles) {
      const auto& p = mesh.positions_m;
      const Vec3 sum = mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]];
      against += dot(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]), sum) < 0;
    }
    if (2 * against > mesh.triangles.size())
      find(object(i),
           "the normals of " + quoted(i) + " point against " + std::to_string(against) + " of its " +
               std::to_string(mesh.triangles.size()) + " triangles",
           "shading as of a body turned inside out; turn the triangles, or set \"normals\": \"flat\"");
  }

  void check_texture(std::size_t i) {
    const Instance& instance = scene_.instances[i];
    const Surface& surface = surface_of(instance);
    if (!bodies_[i].mesh() || !bodies_[i].mesh()->texture.empty()) return;
    for (const Texture& texture : surface.textures)
      find("/surfaces/" + surface.id + "/textures/" + texture.name,
           "the mesh of " + quoted(i) + " has no texture coordinates",
           "one texel, that at (0, 0), everywhere on it; export the mesh with s, t");
  }

  void check_overlaps() {
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      for (std::size_t j = i + 1; j < bodies_.size(); ++j) {
        if (!bodies_[i].transmits() || !bodies_[j].transmits()) continue;
        if (scene_.instances[i].priority != scene_.instances[j].priority) continue;
        if (!bodies_[i].overlaps(bodies_[j]) && !bodies_[j].overlaps(bodies_[i])) continue;
        find(object(j) + "/priority",
             quoted(i) + " and " + quoted(j) + " overlap and let light through, with the same priority",
             "the one named first, " + quoted(i) + ", fills the common part; say which by \"priority\"");
      }
  }

  void check_lights() {
    for (const Light& light : scene_.appearance.lights) check_light(light);
  }

  void check_light(const Light& light) {
    const auto place = light.parameters.find("position_m");
    if (place == light.parameters.end()) return;
    const Vec3 at = place->second.vector();
    const auto size = light.parameters.find("radius_m");
    const bool ball = size != light.parameters.end() && !light.parameters.contains("direction");
    const double radius = ball ? size->second.scalar() : 0;
    const std::string pointer = "/lights/" + light.id, name = "the light \"" + light.id + "\"";
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const Body& body = bodies_[i];
      if (body.contains(at))
        find(pointer, name + " stands inside " + quoted(i),
             body.transmits() ? "its light leaves through the interface only: all of it is caustic, and noisy"
                              : "it is hidden: nothing outside is lit by it");
      else if (body.meets_ball(at, radius))
        find(pointer, format("the ball of %.3g m of ", radius) + name + " meets " + quoted(i),
             "a part of the lamp lies within the object; what is near it is too bright on one side and dark on the "
             "other");
    }
  }

  void check_view(std::size_t i) {
    const View& view = scene_.views[i];
    const std::string pointer = "/images/" + std::to_string(i), name = "image \"" + view.image + "\"";
    const Vec3 eye = view.world_from_camera.translation_m;
    for (std::size_t k = 0; k < bodies_.size() && !view.camera.orthographic(); ++k)
      if (bodies_[k].contains(eye))
        find(pointer + "/world_from_camera", "the camera of " + name + " stands inside " + quoted(k),
             bodies_[k].transmits() ? "it looks out through the interface, as a camera in that medium would"
                                    : "it sees the inside of the object, lit by nothing outside");
    if (view.lights.empty() && !scene_.appearance.ambient)
      find(pointer + "/light", "no light is on in " + name, "a black picture");
    if (!sees_something(view))
      find(pointer, name + " sees none of the objects", "an empty picture; check world_from_camera and its direction");
  }

  bool sees_something(const View& view) const {
    constexpr int rays = 9;
    for (const Body& body : bodies_)
      if (body.shows_in(view)) return true;
    for (int y = 0; y < rays; ++y)
      for (int x = 0; x < rays; ++x) {
        const camera::Ray ray = view.camera.ray(
            {(view.camera.width_px() - 1.0) * x / (rays - 1), (view.camera.height_px() - 1.0) * y / (rays - 1)});
        const Vec3 origin = view.world_from_camera * ray.origin_m;
        const Vec3 direction = view.world_from_camera.rotate(ray.direction);
        for (const Body& body : bodies_)
          if (body.met_by(origin, direction)) return true;
      }
    return false;
  }

  const Scene& scene_;
  std::vector<Body> bodies_;
  std::vector<Finding> found_;
};

}  // namespace

std::vector<Finding> check_scene(const Scene& scene) {
  return Checker(scene).findings();
}

std::vector<Finding> check_lights(const Scene& scene) {
  return Checker(scene).findings_of_lights();
}

void require_closed(const Scene& scene, const std::function<std::string(const std::string&)>& place) {
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Body body(instance, scene.appearance.surfaces[instance.surface]);
    if (!body.transmits() || body.closed()) continue;
    const std::string words =
        body.mesh() ? "the mesh of \"" + instance.id + "\" " + open_words(body.topology()) + ", and bounds a medium"
                    : "\"" + instance.id + "\" is a plane, and bounds a medium";
    throw Error(Exit::data, place("/objects/" + std::to_string(i)), words + ": " + open_consequence(),
                "close the mesh, or say --allow-open");
  }
}

}  // namespace gonio::scene
