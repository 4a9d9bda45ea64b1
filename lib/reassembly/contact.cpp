// The soft mesh gives way to the hard one: what has to go where, by which of the two ways, and the proof that it is
// free.
#include "reassembly/contact.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "mesh/topology.h"
#include "mesh/triangle_tree.h"
#include "mesh/verdict.h"
#include "reassembly/contact_overlay.h"
#include "reassembly/contact_plane.h"
#include "reassembly/contact_plate.h"

namespace gonio::reassembly {
namespace {

using namespace contact;
using MeetingPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
constexpr std::size_t all_pairs = static_cast<std::size_t>(-1);

void check_sound(const io::TriangleMesh& mesh, const std::string& which, const std::string& place) {
  if (mesh.triangles.empty()) throw Error(Exit::data, place, "the " + which + " mesh has no triangle", "give another");
  for (std::size_t v = 0; v < mesh.positions_m.size(); ++v)
    if (!is_finite(mesh.positions_m[v]))
      throw Error(Exit::data, place, "vertex " + std::to_string(v) + " of the " + which + " mesh is not finite",
                  "write it again");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (v >= mesh.positions_m.size())
        throw Error(Exit::data, place,
                    "triangle " + std::to_string(t) + " of the " + which + " mesh names vertex " + std::to_string(v) +
                        " of " + std::to_string(mesh.positions_m.size()),
                    "write it again");
}

void check_closed(const io::TriangleMesh& hard, const std::string& place) {
  mesh::Mesh shape;
  shape.positions_m = hard.positions_m;
  shape.triangles = hard.triangles;
  const mesh::Topology topology = mesh::topology_of(shape);
  if (!topology.closed())
    throw Error(Exit::data, place,
                format("the hard mesh is not closed (%zu edges with one triangle, %zu whose two disagree, limit 0)",
                       topology.boundary_edges, topology.disagreeing_edges),
                "close it (ct-mesh-clean), or turn its triangles to one side");
  if (!(topology.volume_m3 > 0))
    throw Error(Exit::data, place, format("the hard mesh faces inwards (volume %.3g m^3)", topology.volume_m3),
                "turn its triangles round");
}

std::vector<std::uint32_t> numbers_of(const std::vector<std::uint8_t>& flags) {
  std::vector<std::uint32_t> set;
  for (std::uint32_t i = 0; i < flags.size(); ++i)
    if (flags[i] != 0) set.push_back(i);
  return set;
}

class Yielding {
 public:
  Yielding(const io::TriangleMesh& soft, const io::TriangleMesh& hard, const ContactWish& wish)
      : soft_(soft), hard_(hard), wish_(wish) {
    const double near_m = wish.near * extent_of(hard).diagonal;
    reach_m_ = wish.reach_m > 0 ? wish.reach_m : near_m;
    deepest_m_ = wish.deepest_m > 0 ? wish.deepest_m : near_m;
    near_ = near_parts(soft, hard, near_m, wish.down);
    result_.soft = soft;
  }

  Contact result() {
    const MeetingPairs met = mesh::intersections(soft_, hard_, all_pairs);
    result_.pairs_before = met.size();
    const bool known = near_.down.has_value();
    if (!known) near_.down = Vec3{0, 0, -1};  // what is inside does not depend on it
    result_.down = normalized(*near_.down);
    lay_out();
    std::vector<std::uint8_t> meets(soft_.triangles.size(), 0);
    for (const auto& [f, other] : met) meets[f] = 1;
    grip_ = grip_of(local_soft_, local_hard_, numbers_of(meets), deepest_m_);
    result_.inside_before = grip_.inside;
    if (met.empty() && grip_.inside == 0) return std::move(result_);
    if (!known)
      refuse("too little of the soft mesh is near the hard one's surface to say where down is; state it");
    else if (!grip_.stuck.empty())
      refuse(format("vertex %u of the soft mesh lies inside the hard one without a way out within %.3g mm along down%s",
                    grip_.stuck[0], 1e3 * deepest_m_, others(grip_.stuck.size() - 1).c_str()));
    else
      solve();
    return std::move(result_);
  }

 private:
  static std::string others(std::size_t n) { return n == 0 ? "" : format(", as do %zu more", n); }
  void refuse(std::string why) {
    result_.refused = std::move(why);
    result_.pairs_after = result_.pairs_before;
  }
  void lay_out() {
    const Basis basis(result_.down);
    same_ = mesh::welded(soft_.positions_m);
    for (const Vec3& p : soft_.positions_m) local_soft_.at.push_back(basis.to_local(p));
    for (const auto& [a, b, c] : soft_.triangles) local_soft_.faces.push_back({same_[a], same_[b], same_[c]});
    for (const Vec3& p : hard_.positions_m) local_hard_.at.push_back(basis.to_local(p));
    local_hard_.faces = hard_.triangles;
  }

  // The thesis's pushes; along down only, and none up.
  std::vector<double> pushed() const {
    std::vector<double> u(soft_.positions_m.size(), 0);
    for (std::size_t k = 0; k < near_.soft.size(); ++k) {
      const std::uint32_t v = same_[near_.soft[k]];
      const double lack = local_hard_.at[near_.corner[k]].z + wish_.clearance_m - local_soft_.at[v].z;
      u[v] = std::max(u[v], lack);
    }
    return u;
  }

  // Vertices nearer than the reach to `parts`, which are triangles of `at`.
  std::vector<std::uint8_t> within_reach(const std::vector<Vec3>& at, const Faces& parts) const {
    const mesh::TriangleTree tree(at, parts);
    std::vector<std::uint8_t> free(soft_.positions_m.size(), 0);
    for (std::size_t v = 0; v < free.size(); ++v)
      free[v] = same_[v] == v && tree.nearest(local_soft_.at[v], reach_m_).distance_m <= reach_m_;
    return free;
  }
  std::vector<Row> hard_rows(const std::vector<std::uint8_t>& free, double clearance) const {
    return rows_below(local_soft_, local_hard_, {deepest_m_, clearance, free, grip_.captive, grip_.gripped});
  }
  // Within reach of the places that have to give way (of the faces round them would be a cell too far), and whatever
  // has to move to free these.
  std::vector<std::uint8_t> yielding() const {
    Faces gripped, places;
    for (std::size_t f = 0; f < grip_.gripped.size(); ++f)
      if (grip_.gripped[f] != 0) gripped.push_back(local_soft_.faces[f]);
    std::vector<Vec3> at;
    std::vector<std::uint32_t> corners;
    for (const Row& row : hard_rows(within_reach(local_soft_.at, gripped), 0))
      if (row.bound > 0) {
        const auto n = static_cast<std::uint32_t>(at.size());
        at.push_back(row.where(local_soft_.at));
        places.push_back({n, n, n});
        corners.insert(corners.end(), row.vertex.begin(), row.vertex.begin() + row.count);
      }
    std::vector<std::uint8_t> free = within_reach(at, places);
    for (const std::uint32_t v : corners) free[v] = 1;
    return free;
  }

  void solve() {
    const bool elastic = wish_.yield == Yield::elastic;
    // A push goes on through layers wherever they lie; what nothing pushes stays.
    const std::vector<double> start = elastic ? std::vector<double>(soft_.positions_m.size(), 0) : pushed();
    std::vector<std::uint8_t> free = elastic ? yielding() : std::vector<std::uint8_t>(soft_.positions_m.size(), 1);
    // What rounding leaves in touch gets twice the clearance, and so on; what holds a layer up is freed as well.
    constexpr int most_tries = 12;
    double clearance = wish_.clearance_m;
    for (int tried = 0; tried < most_tries; ++tried) {
      std::vector<Row> rows = hard_rows(free, clearance);
      const std::vector<Row> layers = rows_between_layers(local_soft_, free, 2 * deepest_m_, wish_.clearance_m);
      rows.insert(rows.end(), layers.begin(), layers.end());
      std::vector<double> u = start;
      if (elastic) u = bent(local_soft_, free, rows, 4 * reach_m_, clearance / 8);
      const auto needed = press(u, free, rows, clearance / 4);
      if (needed && needed->empty()) {
        if (done_with(u)) return;
        clearance *= 2;
      }
      for (const std::uint32_t v : needed.value_or(std::vector<std::uint32_t>{})) free[v] = 1;
      if (!needed) break;
    }
    refuse("no displacement along down frees the soft mesh: the hard one has walls along down through it, or cuts it");
  }

  // Moves, and says whether all is well, or refused for good.
  bool done_with(const std::vector<double>& u) {
    const double deepest = *std::ranges::max_element(u);
    if (deepest > deepest_m_ + wish_.clearance_m) {
      refuse(format("the soft mesh would have to go down by %.3g mm (limit %.3g mm): a wrong pose, or raise the limit",
                    1e3 * deepest, 1e3 * deepest_m_));
      return true;
    }
    io::TriangleMesh moved = soft_;
    std::vector<std::uint32_t> vertices;
    for (std::uint32_t v = 0; v < u.size(); ++v)
      if (const double by = u[same_[v]]; std::abs(by) > 1e-3 * wish_.clearance_m) {
        moved.positions_m[v] += by * result_.down;
        vertices.push_back(v);
      }
    if (!mesh::intersections(moved, hard_, 1).empty()) return false;
    const Basis basis(result_.down);
    Layered after{{}, local_soft_.faces};
    for (const Vec3& p : moved.positions_m) after.at.push_back(basis.to_local(p));
    if (grip_of(after, local_hard_, {}, deepest_m_).inside > 0) return false;
    describe(std::move(moved), std::move(vertices), u);
    return true;
  }

  void describe(io::TriangleMesh moved, std::vector<std::uint32_t> vertices, const std::vector<double>& u) {
    for (const std::uint32_t v : vertices) {
      result_.deepest_m = std::max(result_.deepest_m, u[same_[v]]);
      result_.mean_m += u[same_[v]] / static_cast<double>(vertices.size());
    }
    for (const auto& [a, b, c] : local_soft_.faces) {
      const Vec3 across = cross(local_soft_.at[b] - local_soft_.at[a], local_soft_.at[c] - local_soft_.at[a]);
      result_.volume_m3 += std::abs(across.z * (u[a] + u[b] + u[c])) / 6;
    }
    count_own(moved, u);
    if (!moved.normals.empty()) turn_normals(moved, vertices);
    result_.soft = std::move(moved);
    result_.moved = std::move(vertices);
  }

  // Faces of the soft mesh that meet each other, before and after, where one of the two moved.
  void count_own(const io::TriangleMesh& moved, const std::vector<double>& u) {
    const auto stirred = [&](std::uint32_t f) {
      const auto& [a, b, c] = local_soft_.faces[f];
      return u[a] != 0 || u[b] != 0 || u[c] != 0;
    };
    const auto count = [&](const io::TriangleMesh& m) {
      return static_cast<std::size_t>(
          std::ranges::count_if(mesh::self_intersections(m, all_pairs),
                                [&](const auto& pair) { return stirred(pair.first) || stirred(pair.second); }));
    };
    result_.self_before = count(soft_);
    result_.self_after = count(moved);
  }

  static void turn_normals(io::TriangleMesh& moved, const std::vector<std::uint32_t>& vertices) {
    std::vector<std::uint8_t> stirred(moved.positions_m.size(), 0), turned = stirred;
    for (const std::uint32_t v : vertices) stirred[v] = 1;
    for (const auto& f : moved.triangles)
      if (stirred[f[0]] != 0 || stirred[f[1]] != 0 || stirred[f[2]] != 0)
        turned[f[0]] = turned[f[1]] = turned[f[2]] = 1;
    const std::vector<Vec3> averaged = mesh::averaged_normals(moved.positions_m, moved.triangles);
    for (std::size_t v = 0; v < turned.size(); ++v)
      if (turned[v] != 0) moved.normals[v] = averaged[v];
  }

  const io::TriangleMesh &soft_, &hard_;
  const ContactWish& wish_;
  double reach_m_ = 0, deepest_m_ = 0;
  Near near_;
  std::vector<std::uint32_t> same_;  // per soft vertex the one that stands for all at its place
  Layered local_soft_, local_hard_;
  Grip grip_;
  Contact result_;
};

}  // namespace

Contact give_way(const io::TriangleMesh& soft, const io::TriangleMesh& hard, const ContactWish& wish,
                 const std::string& place) {
  check_sound(soft, "soft", place);
  check_sound(hard, "hard", place);
  check_closed(hard, place);
  return Yielding(soft, hard, wish).result();
}

}  // namespace gonio::reassembly
