// See body.h.
#include "glass/body.h"

#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "io/obj.h"
#include "mesh/clean.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"
#include "mesh/verdict.h"

namespace gonio::glass {
namespace {

// Empty where the mesh bounds a body.
std::string fault_of(const io::TriangleMesh& mesh, CheckedBody& facts) {
  const mesh::Soundness sound = mesh::soundness(mesh);
  facts.components = sound.components, facts.genus = sound.genus_sum;
  if (mesh.triangles.size() > most_triangles) return format("has %zu triangles", mesh.triangles.size());
  if (sound.boundary_edges > 0) return format("is open along %zu edges", sound.boundary_edges);
  if (sound.disagreeing_edges > 0) return format("is not oriented: %zu edges disagree", sound.disagreeing_edges);
  if (!sound.manifold())
    return format("is not 2-manifold: %zu edges, %zu vertices", sound.crowded_edges, sound.pinched_vertices);
  if (sound.degenerate_triangles > 0) return format("has %zu triangles without area", sound.degenerate_triangles);
  if (!(mesh::topology_of(mesh::prepare(mesh, mesh::Shading::flat, "body")).volume_m3 > 0)) return "is inside out";
  if (const auto crossed = mesh::self_intersections(mesh, 1); !crossed.empty())
    return format("crosses itself at triangles %u and %u", crossed[0].first, crossed[0].second);
  return {};
}

}  // namespace

void stand(Body& body) {
  Vec3 low = body.mesh.positions_m.front(), high = low;
  for (const Vec3& p : body.mesh.positions_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const double scale = 1 / max_component(high - low);
  const Vec3 foot{(low.x + high.x) / 2, (low.y + high.y) / 2, low.z};
  for (Vec3& p : body.mesh.positions_m) p = (p - foot) * scale;
  if (body.filling)
    for (Vec3& p : body.filling->positions_m) p = (p - foot) * scale;
  body.wall_low *= scale, body.wall_high *= scale;
}

CheckedBody drawn_body(const Form& form, std::uint64_t seed, std::uint64_t number) {
  constexpr int most_draws = 20;
  std::string fault;
  for (int draw = 0; draw < most_draws; ++draw) {
    Random random(split_mix(seed) ^ number, static_cast<std::uint64_t>(draw));
    CheckedBody checked;
    checked.draws = draw + 1;
    try {
      checked.body = form.made(random);
    } catch (const Error& error) {
      fault = error.what();
      continue;
    }
    stand(checked.body);
    fault = fault_of(checked.body.mesh, checked);
    if (fault.empty() && checked.body.filling) {
      CheckedBody liquid;
      fault = fault_of(*checked.body.filling, liquid);
    }
    if (fault.empty()) return checked;
  }
  throw Error(
      Exit::internal, form.id(),
      format("body %llu: none of %d draws is fit; the last one ", static_cast<unsigned long long>(number), most_draws) +
          fault);
}

CheckedBody body_in(const std::filesystem::path& path) {
  CheckedBody checked;
  checked.body.mesh = io::read_mesh(path);
  io::TriangleMesh& mesh = checked.body.mesh;
  mesh.texture.clear(), mesh.labels.clear(), mesh.properties.clear();
  const std::vector<std::uint32_t> first = mesh::welded(mesh.positions_m);  // formats repeat vertices
  for (auto& triangle : mesh.triangles)
    for (std::uint32_t& v : triangle) v = first[v];
  mesh.normals.clear();
  if (mesh.triangles.empty()) throw Error(Exit::data, path.string(), "has no triangles");
  if (mesh.triangles.size() > most_triangles) mesh::decimate(mesh, most_triangles);
  stand(checked.body);
  if (const std::string fault = fault_of(mesh, checked); !fault.empty())
    throw Error(Exit::data, path.string(), fault + ": it bounds no body", "mend it: ct-mesh-clean, or leave it out");
  return checked;
}

}  // namespace gonio::glass
