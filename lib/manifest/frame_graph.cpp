// Loops of the graph of frames and their closures: see frame_graph.h.
#include "manifest/frame_graph.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "linear/positive.h"

namespace gonio::manifest {
namespace {

constexpr double rounding_rad = 2e-6, rounding_m = 1e-6, rounding_share = 1e-6;

// Frames, and the strides that lead out of each of them.
class Forest {
 public:
  explicit Forest(std::span<const FrameEdge> edges) : edges_(edges) {}
  bool joined(const std::string& a, const std::string& b) { return root_of(a) == root_of(b); }
  void join(std::size_t edge) {
    const auto& [to, from] = std::pair{edges_[edge].to, edges_[edge].from};
    strides_[to].push_back({edge, true});
    strides_[from].push_back({edge, false});
    above_[root_of(to)] = root_of(from);
  }
  // Between frames that are joined.
  std::vector<Stride> way(const std::string& to, const std::string& from) const {
    std::map<std::string, Stride> came_by;
    std::vector<std::string> reached{to};
    for (std::size_t k = 0; k < reached.size() && !came_by.contains(from); ++k)
      for (const Stride& s : strides_.at(reached[k]))
        if (end_of(s) != to && came_by.try_emplace(end_of(s), s).second) reached.push_back(end_of(s));
    std::vector<Stride> taken;
    for (std::string at = from; at != to;) {
      const Stride& s = came_by.at(at);
      taken.push_back(s);
      at = s.along ? edges_[s.edge].to : edges_[s.edge].from;
    }
    std::ranges::reverse(taken);
    return taken;
  }

 private:
  const std::string& end_of(const Stride& s) const { return s.along ? edges_[s.edge].from : edges_[s.edge].to; }
  std::string root_of(std::string frame) {
    while (above_.try_emplace(frame, frame).first->second != frame) {
      std::string& next = above_[frame];
      next = above_[next];
      frame = next;
    }
    return frame;
  }
  std::span<const FrameEdge> edges_;
  std::map<std::string, std::vector<Stride>> strides_;
  std::map<std::string, std::string> above_;  // towards the one that stands for all that are joined
};

using Six = std::array<double, 36>;

// What a link's small motion, about the axes of a frame that is turned by `r` in the loop's, does to the loop's end,
// which lies at `lever` from where the motion turns: rows are turn and shift of the end.
Six carried(const Mat3& r, Vec3 lever) {
  Six j{};
  // r * (d x lever) = -r [lever]x d
  const Mat3 minus_cross{{0, lever.z, -lever.y, -lever.z, 0, lever.x, lever.y, -lever.x, 0}};
  const Mat3 moved = r * minus_cross;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const auto at = [&](int row, int column) -> double& { return j[static_cast<std::size_t>(6 * row + column)]; };
      at(a, b) = at(a + 3, b + 3) = r(a, b);
      at(a + 3, b) = moved(a, b);
    }
  return j;
}

void add_carried(Six& sum, const Six& j, const Six& covariance) {
  Six half{};
  for (std::size_t a = 0; a < 6; ++a)
    for (std::size_t b = 0; b < 6; ++b)
      for (std::size_t k = 0; k < 6; ++k) half[6 * a + b] += j[6 * a + k] * covariance[6 * k + b];
  for (std::size_t a = 0; a < 6; ++a)
    for (std::size_t b = 0; b < 6; ++b)
      for (std::size_t k = 0; k < 6; ++k) sum[6 * a + b] += half[6 * a + k] * j[6 * b + k];
}

}  // namespace

std::array<double, 36> covariance_of(const PoseSigma& sigma) {
  std::array<double, 36> c{};
  const auto put = [&](const std::vector<double>& s, std::size_t first) {
    for (std::size_t k = 0; k < 3 && !s.empty(); ++k) {
      const double one = s.size() < 3 ? s[0] : s[k];
      c[7 * (first + k)] = one * one;
    }
  };
  put(sigma.rotation_rad, 0);
  put(sigma.translation_m, 3);
  return c;
}

std::array<double, 36> with_rounding(const FrameEdge& edge) {
  std::array<double, 36> c = edge.covariance;
  const double turn = rounding_rad * rounding_rad;
  const double shift = rounding_m * rounding_m +
                       dot(edge.to_from.translation_m, edge.to_from.translation_m) * rounding_share * rounding_share;
  for (std::size_t k = 0; k < 6; ++k) c[7 * k] += k < 3 ? turn : shift;
  return c;
}

std::vector<FrameLoop> fundamental_loops(std::span<const FrameEdge> edges) {
  Forest forest(edges);
  std::vector<FrameLoop> loops;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (edges[i].to == edges[i].from) continue;
    if (forest.joined(edges[i].to, edges[i].from))
      loops.push_back({i, forest.way(edges[i].to, edges[i].from)});
    else
      forest.join(i);
  }
  return loops;
}

Closure closure_of(std::span<const FrameEdge> edges, const FrameLoop& loop) {
  const std::vector<Stride>& way = loop.way;
  std::vector<Motion> behind(way.size() + 1);  // what follows each stride
  for (std::size_t k = way.size(); k-- > 0;) {
    const Motion& step = edges[way[k].edge].to_from;
    behind[k] = (way[k].along ? step : inverse(step)) * behind[k + 1];
  }
  const FrameEdge& closing = edges[loop.closing];
  Closure closure{rotation_vector_of(normalized(closing.to_from.rotation * conjugate(behind[0].rotation))),
                  closing.to_from.translation_m - behind[0].translation_m, with_rounding(closing)};
  Motion before;  // what precedes each stride
  for (std::size_t k = 0; k < way.size(); ++k) {
    const FrameEdge& walked = edges[way[k].edge];
    const Motion& step = walked.to_from;
    const Motion until = before * (way[k].along ? step : inverse(step));
    // The link's uncertainty is about the axes of its `to`, and acts on what lies behind its `from`.
    const Vec3 lever =
        way[k].along ? step.rotate(behind[k + 1].translation_m) : behind[k + 1].translation_m - step.translation_m;
    const Motion& at = way[k].along ? before : until;
    add_carried(closure.covariance, carried(matrix_of(at.rotation), lever), with_rounding(walked));
    before = until;
  }
  return closure;
}

double Closure::chi_square() const {
  std::array<double, 36> weight{};
  if (!linear::positive_inverse<6>(covariance, weight)) return std::numeric_limits<double>::infinity();
  const std::array<double, 6> e{turn_rad.x, turn_rad.y, turn_rad.z, shift_m.x, shift_m.y, shift_m.z};
  double sum = 0;
  for (std::size_t a = 0; a < 6; ++a)
    for (std::size_t b = 0; b < 6; ++b) sum += e[a] * weight[6 * a + b] * e[b];
  return sum;
}

}  // namespace gonio::manifest
