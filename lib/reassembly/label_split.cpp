// Longest-edge bisection. An edge that is halved in one face is halved in its neighbour; a face with a halved edge has
// its longest edge halved, too, so that angles never fall below half of the smallest given one (Rosenberg & Stenger
// 1975). Which edges are halved spreads until nothing is added; then every face is cut by its one to three halved
// edges.
#include "reassembly/label_split.h"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "mesh/topology.h"

namespace gonio::reassembly {
namespace {

using Face = std::array<std::uint32_t, 3>;

std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
  return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
}

class Bisection {
 public:
  explicit Bisection(const io::TriangleMesh& mesh) : mesh_(mesh), weld_(mesh::welded(mesh.positions_m)) {
    edge_of_.resize(mesh.triangles.size());
    struct Side {
      std::uint64_t key;
      std::uint32_t face, corner;
    };
    std::vector<Side> sides;
    sides.reserve(3 * mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::uint32_t c = 0; c < 3; ++c)
        sides.push_back({edge_key(weld_[mesh.triangles[t][c]], weld_[mesh.triangles[t][(c + 1) % 3]]), t, c});
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return a.key != b.key ? a.key < b.key : a.face != b.face ? a.face < b.face : a.corner < b.corner;
    });
    for (const Side& side : sides) {
      if (starts_.empty() || key_ != side.key) {
        key_ = side.key;
        starts_.push_back(static_cast<std::uint32_t>(faces_.size()));
        const Vec3 along = mesh.positions_m[key_ >> 32] - mesh.positions_m[key_ & 0xffffffffu];
        length2_.push_back(dot(along, along));
      }
      edge_of_[side.face][side.corner] = static_cast<std::uint32_t>(starts_.size() - 1);
      faces_.push_back(side.face);
    }
    starts_.push_back(static_cast<std::uint32_t>(faces_.size()));
    halved_.assign(length2_.size(), 0);
  }

  void want(std::uint32_t face) {
    std::vector<std::uint32_t> todo;
    const auto halve = [&](std::uint32_t edge) {
      if (halved_[edge] != 0) return;
      halved_[edge] = 1;
      todo.insert(todo.end(), faces_.begin() + starts_[edge], faces_.begin() + starts_[edge + 1]);
    };
    halve(longest(face));
    while (!todo.empty()) {
      const std::uint32_t next = todo.back();
      todo.pop_back();
      halve(longest(next));
    }
  }

  Split cut() {
    Split result;
    result.mesh = mesh_;
    result.mesh.triangles.clear();
    result.mesh.labels.clear();
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) cut(result, static_cast<std::uint32_t>(t));
    return result;
  }

 private:
  // Of equal ones that with the smaller number, which both its faces agree on.
  std::uint32_t longest(std::uint32_t face) const {
    std::uint32_t best = edge_of_[face][0];
    for (const std::uint32_t edge : edge_of_[face])
      if (length2_[edge] > length2_[best] || (length2_[edge] == length2_[best] && edge < best)) best = edge;
    return best;
  }

  std::uint32_t middle(io::TriangleMesh& mesh, std::uint32_t a, std::uint32_t b) {
    const auto [found, fresh] =
        middles_.try_emplace(edge_key(a, b), static_cast<std::uint32_t>(mesh.positions_m.size()));
    if (!fresh) return found->second;
    const std::uint32_t low = std::min(a, b), high = std::max(a, b);  // the same sum from both sides
    mesh.positions_m.push_back((mesh.positions_m[low] + mesh.positions_m[high]) * 0.5);
    if (!mesh.normals.empty()) {
      const Vec3 sum = mesh.normals[low] + mesh.normals[high];
      mesh.normals.push_back(norm(sum) > 1e-12 ? normalized(sum) : mesh.normals[low]);
    }
    if (!mesh.texture.empty()) mesh.texture.push_back((mesh.texture[low] + mesh.texture[high]) * 0.5);
    for (auto& property : mesh.properties)
      if (!property.empty()) property.push_back((property[low] + property[high]) * 0.5f);
    return found->second;
  }

  void cut(Split& result, std::uint32_t t) {
    const Face& face = mesh_.triangles[t];
    const auto add = [&](Face part, bool changed) {
      result.mesh.triangles.push_back(part);
      if (!mesh_.labels.empty()) result.mesh.labels.push_back(mesh_.labels[t]);
      result.from.push_back(t);
      result.changed.push_back(changed ? 1 : 0);
    };
    const std::uint32_t first = longest(t);
    if (halved_[first] == 0) return add(face, false);  // then none is
    std::size_t c = 0;
    while (edge_of_[t][c] != first) ++c;
    // a - b is the longest edge, m its middle: halves (a, m, o) and (m, b, o), each cut again at its own given edge.
    const std::uint32_t a = face[c], b = face[(c + 1) % 3], o = face[(c + 2) % 3], m = middle(result.mesh, a, b);
    if (halved_[edge_of_[t][(c + 1) % 3]] != 0) {
      const std::uint32_t n = middle(result.mesh, b, o);
      add({m, b, n}, true);
      add({m, n, o}, true);
    } else {
      add({m, b, o}, true);
    }
    if (halved_[edge_of_[t][(c + 2) % 3]] != 0) {
      const std::uint32_t n = middle(result.mesh, o, a);
      add({m, o, n}, true);
      add({m, n, a}, true);
    } else {
      add({a, m, o}, true);
    }
  }

  const io::TriangleMesh& mesh_;
  std::vector<std::uint32_t> weld_;
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;
  std::uint64_t key_ = 0;                              // of the last edge while they are numbered
  std::vector<std::array<std::uint32_t, 3>> edge_of_;  // edge c leads from corner c to corner c + 1
  std::vector<std::uint32_t> starts_, faces_;          // of each edge, one list after the other
  std::vector<double> length2_;
  std::vector<std::uint8_t> halved_;
};

}  // namespace

Split bisect(const io::TriangleMesh& mesh, const std::vector<std::uint8_t>& wanted) {
  Bisection bisection(mesh);
  for (std::size_t t = 0; t < wanted.size(); ++t)
    if (wanted[t] != 0) bisection.want(static_cast<std::uint32_t>(t));
  return bisection.cut();
}

}  // namespace gonio::reassembly
