// Step: is the mesh fit to be rendered as glass?
#include <utility>

#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "tools/ct-mesh-clean/work.h"

namespace gonio::tools::ct_mesh_clean {
namespace {

constexpr std::size_t distance_samples = 100000, rays = 20000;

// Beside a mesh of the same object from elsewhere.
void hold_against_reference(Work& work) {
  const std::string& path = work.call.text("reference");
  work.call.note_input(path);
  const io::TriangleMesh reference = io::read_ply(path);
  if (reference.triangles.empty()) throw Error(Exit::data, path, "has no triangles", "give a mesh with a surface");
  const mesh::Distance there = mesh::distance(work.mesh, reference, distance_samples, work.call.seed),
                       back = mesh::distance(reference, work.mesh, distance_samples, work.call.seed + 1);
  const mesh::RayBend bend = mesh::ray_bend(work.mesh, reference, work.asked.index, rays, work.call.seed);
  step(work, "reference", path).figures = {{"distance_rms_m", there.rms_m},
                                           {"distance_mean_signed_m", there.mean_signed_m},
                                           {"distance_largest_m", there.largest_m},
                                           {"distance_back_rms_m", back.rms_m},
                                           {"distance_back_largest_m", back.largest_m},
                                           {"normals_rms_rad", mesh::normals_rms_rad(work.mesh, reference)},
                                           {"ray_bend_rms_rad", bend.rms_rad},
                                           {"ray_bend_median_rad", bend.median_rad},
                                           {"ray_bend_p95_rad", bend.p95_rad},
                                           {"rays", static_cast<double>(bend.rays)},
                                           {"differing_paths", static_cast<double>(bend.differing_paths)}};
}

// What keeps the mesh from bounding glass, counted; empty: nothing.
std::string faults_of(const mesh::Soundness& sound, std::size_t crossings) {
  const std::pair<std::size_t, const char*> counted[] = {
      {sound.boundary_edges, "open edges"},
      {sound.crowded_edges, "edges of more than two triangles"},
      {sound.disagreeing_edges, "edges whose triangles face unlike ways"},
      {sound.pinched_vertices, "pinched vertices"},
      {sound.degenerate_triangles, "triangles without area"},
      {crossings, "pairs of triangles that cross"}};
  std::string words;
  for (const auto& [count, what] : counted)
    if (count > 0) words += (words.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  return words;
}

}  // namespace

void judge(Work& work) {
  const mesh::Soundness sound = mesh::soundness(work.mesh);
  const auto crossing = mesh::self_intersections(work.mesh);
  const mesh::Distance there = mesh::distance(work.mesh, work.data, distance_samples, work.call.seed),
                       back = mesh::distance(work.data, work.mesh, distance_samples, work.call.seed + 1);
  const double noise = mesh::normal_noise_rad(work.mesh);
  const mesh::RayBend bend = mesh::ray_bend_of_noise(work.mesh, noise, work.asked.index, rays, work.call.seed);
  const bool fit = sound.closed() && sound.manifold() && crossing.empty() && sound.degenerate_triangles == 0;
  // The surface bounds the solid: its Euler number is twice the solid's, which the voxels tell. Carving a marker off
  // may change it: said, not judged.
  const std::int64_t wanted = 2 * work.euler;
  std::string how = fit ? "closed, 2-manifold, oriented, without self-intersections"
                        : "not fit to be rendered as glass: " + faults_of(sound, crossing.size());
  if (sound.euler != wanted)
    how += "; Euler number " + std::to_string(sound.euler) + ", the volume's surface has " + std::to_string(wanted);
  if (work.cut_by_border) how += "; the volume's border cuts the object, where the mesh is capped, not measured";
  const Asked& a = work.asked;
  const double limit = a.limit_distance ? a.limit_distance->metres(work.voxel_m()) : 0;
  if (a.limit_distance && std::max(there.rms_m, back.rms_m) > limit) {
    how += format("; %.3g m from the data, limit %.3g m", std::max(there.rms_m, back.rms_m), limit);
    work.missed = true;
  }
  if (a.limit_bend_rad && bend.rms_rad > *a.limit_bend_rad) {
    how += format("; rays are bent wrongly by %.3g rad, limit %.3g rad", bend.rms_rad, *a.limit_bend_rad);
    work.missed = true;
  }
  work.sound = fit;
  if (!fit) work.missed = true;
  if (work.missed) log(LogLevel::warning, work.path + ": " + how);
  auto& entry = step(work, "verdict", how);
  entry.figures = {{"components", static_cast<double>(sound.components)},
                   {"boundary_edges", static_cast<double>(sound.boundary_edges)},
                   {"crowded_edges", static_cast<double>(sound.crowded_edges)},
                   {"disagreeing_edges", static_cast<double>(sound.disagreeing_edges)},
                   {"pinched_vertices", static_cast<double>(sound.pinched_vertices)},
                   {"self_intersections", static_cast<double>(crossing.size())},
                   {"euler", static_cast<double>(sound.euler)},
                   {"genus", static_cast<double>(sound.genus_sum)},
                   {"distance_rms_m", there.rms_m},
                   {"distance_largest_m", there.largest_m},
                   {"distance_back_rms_m", back.rms_m},
                   {"distance_back_largest_m", back.largest_m},
                   {"normal_noise_rad", noise},
                   {"ray_bend_rms_rad", bend.rms_rad},
                   {"ray_bend_p95_rad", bend.p95_rad},
                   {"triangles", static_cast<double>(work.mesh.triangles.size())}};
  if (work.call.given("reference")) hold_against_reference(work);
}

}  // namespace gonio::tools::ct_mesh_clean
