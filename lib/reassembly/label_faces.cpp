// Votes for the labels of faces, and faces split where they disagree.
//
// A face is asked at points spread over it, as far apart as pixels. At a point each view that sees it states
// probabilities, read between the four pixels around it, so that a border lies between pixels and not on their grid;
// their logarithms are added, weighted by the cosine of incidence. The face's probabilities are the mean over its
// points, for points of one face err together, and so do views: their sum is tempered by how many they are.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/union_find.h"
#include "mesh/adjacency.h"
#include "mesh/triangle_tree.h"
#include "reassembly/label_split.h"
#include "reassembly/label_visibility.h"

namespace gonio::reassembly {
namespace {

constexpr double least_share = 0.003;  // what a view grants a label that it does not see
constexpr double sure_enough = 0.75;   // points less sure divide no face
constexpr double least_patch_px = 6;   // pixels that a patch of one label covers at least
constexpr double edge_weight = 0.05;   // of a view that sees a point beside an edge of the shape
// Reading between pixels blunts what they say; set on simulated scenes so that confidence is a frequency.
constexpr double sharpen = 1.35;
constexpr double views_alike = 0.25;  // share of a view's evidence that the others have, too

struct Vote {
  std::int32_t label = unlabelled;
  float confidence = 0;
  bool mixed = false;     // its points do not agree
  double longest_px = 0;  // edge, in the views that see it
};

class Polling {
 public:
  Polling(const io::TriangleMesh& mesh, std::span<const LabelView> views, const FaceWish& wish)
      : views_(views), wish_(wish) {
    for (const LabelView& view : views)
      for (const std::int32_t label : view.picture->label) labels_ = std::max(labels_, label + 1);
    sights_.reserve(views.size());
    for (const LabelView& view : views) sights_.emplace_back(mesh, view);
  }
  std::int32_t labels() const { return labels_; }

  Vote ask(const io::TriangleMesh& mesh, std::size_t face) const {
    const auto& t = mesh.triangles[face];
    const Vec3 a = mesh.positions_m[t[0]], b = mesh.positions_m[t[1]], c = mesh.positions_m[t[2]];
    const Vec3 across = cross(b - a, c - a);
    Vote vote;
    if (!(norm(across) > 0)) return vote;
    const Vec3 normal = normalized(across);
    std::vector<std::size_t> facing;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const double edge_px = longest_px(v, a, b, c, normal);
      if (edge_px <= 0) continue;
      facing.push_back(v);
      vote.longest_px = std::max(vote.longest_px, edge_px);
    }
    if (facing.empty()) return vote;
    count(vote, a, b, c, normal, facing);
    return vote;
  }

 private:
  // In a view that may see the face; else 0.
  double longest_px(std::size_t v, Vec3 a, Vec3 b, Vec3 c, Vec3 normal) const {
    const auto pa = sights_[v].project(a), pb = sights_[v].project(b), pc = sights_[v].project(c);
    if (!pa || !pb || !pc) return sights_[v].sees((a + b + c) / 3, normal) ? 1e3 : 0;
    const camera::CameraModel& camera = *views_[v].camera;
    const auto [left, right] = std::minmax({pa->x, pb->x, pc->x});
    const auto [high, low] = std::minmax({pa->y, pb->y, pc->y});
    if (right < 0 || low < 0 || left > camera.width_px() || high > camera.height_px()) return 0;
    return std::max({norm(*pa - *pb), norm(*pb - *pc), norm(*pc - *pa)});
  }

  // Points: the middles of the face's n^2 equal parts; to a pixel, three pixels in large faces, of which a border shows
  // many points anyway.
  static int parts(double longest_px, double pixels) {
    const double fine = longest_px / pixels, coarse = std::max(8.0, longest_px / 3);
    return std::clamp(static_cast<int>(std::ceil(std::min(fine, coarse))), 1, 64);
  }

  void count(Vote& vote, Vec3 a, Vec3 b, Vec3 c, Vec3 normal, const std::vector<std::size_t>& facing) const {
    const int n = parts(vote.longest_px, wish_.pixels);
    std::vector<double> sum(static_cast<std::size_t>(labels_)), log(sum.size());
    std::int32_t first = unlabelled;
    double points = 0;
    const auto point = [&](double u, double v) {
      if (!log_shares(a + (b - a) * u + (c - a) * v, normal, facing, log)) return;
      const auto most = std::max_element(log.begin(), log.end());
      const auto label = static_cast<std::int32_t>(most - log.begin());
      double whole = 0;
      for (const double value : log) whole += std::exp(value - *most);
      if (whole * sure_enough < 1) {  // else it stands on a border, or nobody knows
        if (first == unlabelled) first = label;
        vote.mixed = vote.mixed || label != first;
      }
      for (std::size_t k = 0; k < log.size(); ++k) sum[k] += std::exp(log[k] - *most) / whole;
      ++points;
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        point((i + 1.0 / 3) / n, (j + 1.0 / 3) / n);
        if (i + j + 1 < n) point((i + 2.0 / 3) / n, (j + 2.0 / 3) / n);
      }
    if (points == 0) return;
    const auto most = std::max_element(sum.begin(), sum.end());
    vote.label = static_cast<std::int32_t>(most - sum.begin());
    vote.confidence = static_cast<float>(*most / points);
  }

  // Sum over views of the weighted logarithms; false where none sees the point, or none knows.
  bool log_shares(Vec3 point_m, Vec3 normal, const std::vector<std::size_t>& facing, std::vector<double>& log) const {
    std::fill(log.begin(), log.end(), 0);
    std::vector<double> shares(log.size());
    double voters = 0;
    for (const std::size_t v : facing) {
      const auto seen = sights_[v].sees(point_m, normal);
      if (!seen || !read(*views_[v].picture, seen->pixel, shares)) continue;
      const double weight = seen->cosine * (seen->at_edge ? edge_weight : 1);
      for (std::size_t k = 0; k < log.size(); ++k) log[k] += weight * std::log(shares[k]);
      voters += weight;
    }
    if (!(voters > 0)) return false;
    // One view counts in full whatever its incidence; many that err together for less than their number.
    const double temper = sharpen * std::max(1.0, voters) / voters / (1 + views_alike * std::max(0.0, voters - 1));
    for (double& value : log) value *= temper;
    return true;
  }

  bool read(const LabelPicture& picture, Vec2 pixel, std::vector<double>& shares) const {
    const double left = std::floor(pixel.x), top = std::floor(pixel.y);
    std::fill(shares.begin(), shares.end(), 0);
    double known = 0;
    const auto count = static_cast<double>(labels_);
    for (int dy = 0; dy < 2; ++dy)
      for (int dx = 0; dx < 2; ++dx) {
        const double weight =
            (dx == 0 ? 1 - (pixel.x - left) : pixel.x - left) * (dy == 0 ? 1 - (pixel.y - top) : pixel.y - top);
        const int x = std::clamp(static_cast<int>(left) + dx, 0, picture.width - 1);
        const int y = std::clamp(static_cast<int>(top) + dy, 0, picture.height - 1);
        const auto i =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x);
        const std::int32_t label = picture.label[i];
        if (label < 0) continue;
        const double sure = std::max(static_cast<double>(picture.confidence[i]), 1 / count);
        known += weight;
        for (std::int32_t k = 0; k < labels_; ++k)
          shares[static_cast<std::size_t>(k)] += weight * (k == label ? sure : (1 - sure) / std::max(1.0, count - 1));
      }
    if (!(known > 0.25)) return false;
    for (double& share : shares) share = std::max(share / known, least_share);
    return true;
  }

  std::span<const LabelView> views_;
  const FaceWish& wish_;
  std::int32_t labels_ = 0;
  std::vector<Visibility> sights_;
};

void poll(const Polling& polling, const io::TriangleMesh& mesh, const std::vector<std::uint8_t>& again,
          std::vector<Vote>& votes) {
  parallel_for(
      0, mesh.triangles.size(),
      [&](std::size_t t) {
        if (again[t] != 0) votes[t] = polling.ask(mesh, t);
      },
      256);
}

double area_of(const io::TriangleMesh& mesh, std::size_t t) {
  const auto& f = mesh.triangles[t];
  return norm(cross(mesh.positions_m[f[1]] - mesh.positions_m[f[0]], mesh.positions_m[f[2]] - mesh.positions_m[f[0]])) /
         2;
}

// Crossings of borders by a straight way, for each metre of it: 2 length / (pi area) (Buffon, Crofton).
double crossings_per_m(const io::TriangleMesh& mesh, const std::vector<Vote>& votes) {
  const auto next = mesh::neighbours_of_faces(mesh.triangles, mesh.positions_m.size());
  double length = 0, area = 0;
  for (std::size_t t = 0; t < votes.size(); ++t) {
    if (votes[t].label < 0) continue;
    area += area_of(mesh, t);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t other = next[t][c];
      if (other == mesh::nobody || other < t || votes[other].label < 0 || votes[other].label == votes[t].label)
        continue;
      const auto& f = mesh.triangles[t];
      length += norm(mesh.positions_m[f[c]] - mesh.positions_m[f[(c + 1) % 3]]);
    }
  }
  return area > 0 ? 2 * length / (pi * area) : 0;
}

// Patches that are smaller than pixels show take the label beside which they have most of their border.
void absorb_specks(const io::TriangleMesh& mesh, std::vector<Vote>& votes) {
  const auto next = mesh::neighbours_of_faces(mesh.triangles, mesh.positions_m.size());
  UnionFind patches(votes.size());
  const auto patch = [&](std::size_t t) { return patches.group(static_cast<std::uint32_t>(t)); };
  const auto voted = [&](std::uint32_t t) { return t != mesh::nobody && votes[t].label >= 0; };
  for (std::uint32_t t = 0; t < votes.size(); ++t)
    for (const std::uint32_t other : next[t])
      if (voted(t) && voted(other) && votes[other].label == votes[t].label) patches.join(t, other);
  std::vector<double> area_px(votes.size());
  const auto edge_m = [&](std::size_t t, std::size_t c) {
    const auto& f = mesh.triangles[t];
    return norm(mesh.positions_m[f[c]] - mesh.positions_m[f[(c + 1) % 3]]);
  };
  for (std::size_t t = 0; t < votes.size(); ++t) {
    const double longest_m = std::max({edge_m(t, 0), edge_m(t, 1), edge_m(t, 2)});
    if (longest_m > 0) area_px[patch(t)] += area_of(mesh, t) * std::pow(votes[t].longest_px / longest_m, 2);
  }
  std::map<std::uint32_t, std::map<std::int32_t, double>> beside;
  for (std::uint32_t t = 0; t < votes.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c)
      if (voted(t) && area_px[patch(t)] < least_patch_px && voted(next[t][c]) && patch(next[t][c]) != patch(t))
        beside[patch(t)][votes[next[t][c]].label] += edge_m(t, c);
  std::vector<std::uint32_t> groups(votes.size());  // labels change below, groups do not
  for (std::size_t t = 0; t < votes.size(); ++t) groups[t] = patch(t);
  for (std::size_t t = 0; t < votes.size(); ++t) {
    const auto found = beside.find(groups[t]);
    if (found == beside.end()) continue;
    const auto most = std::max_element(found->second.begin(), found->second.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    votes[t].label = most->first;
    votes[t].confidence = std::max(0.5f, 1 - votes[t].confidence);
  }
}

// What no view sees takes the label of the nearest face that one does. It is as sure as a way of that length is to
// cross no border.
void fill_unseen(const io::TriangleMesh& mesh, const std::vector<Vote>& votes, std::int32_t labels,
                 LabelledMesh& result) {
  std::vector<std::array<std::uint32_t, 3>> seen;
  std::vector<std::size_t> which;
  for (std::size_t t = 0; t < votes.size(); ++t)
    if (votes[t].label >= 0) {
      seen.push_back(mesh.triangles[t]);
      which.push_back(t);
    }
  if (seen.size() == votes.size()) return;
  const double crossings = crossings_per_m(mesh, votes);
  const mesh::TriangleTree tree(mesh.positions_m, seen);
  parallel_for(
      0, votes.size(),
      [&](std::size_t t) {
        if (votes[t].label >= 0) return;
        const auto& f = mesh.triangles[t];
        const Vec3 middle = (mesh.positions_m[f[0]] + mesh.positions_m[f[1]] + mesh.positions_m[f[2]]) / 3;
        if (!is_finite(middle)) return;
        const auto nearest = tree.nearest(middle);
        const Vote& donor = votes[which[nearest.triangle]];
        const double even = 1.0 / std::max(1, labels), kept = std::exp(-crossings * nearest.distance_m);
        result.mesh.labels[t] = donor.label;
        result.confidence[t] = static_cast<float>(even + (static_cast<double>(donor.confidence) - even) * kept);
      },
      256);
}

void check_views(const io::TriangleMesh& mesh, std::span<const LabelView> views, const FaceWish& wish) {
  if (mesh.triangles.empty()) throw Error(Exit::data, "the mesh", "has no faces", "give another");
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t)
      if (v >= mesh.positions_m.size())
        throw Error(Exit::data, "the mesh",
                    "a face names vertex " + std::to_string(v) + " of " + std::to_string(mesh.positions_m.size()),
                    "write it again");
  for (const LabelView& view : views) {
    const LabelPicture& p = *view.picture;
    const std::size_t pixels =
        static_cast<std::size_t>(std::max(0, p.width)) * static_cast<std::size_t>(std::max(0, p.height));
    if (p.width != view.camera->width_px() || p.height != view.camera->height_px() || p.label.size() != pixels ||
        p.confidence.size() != pixels)
      throw Error(Exit::data, "a label picture",
                  "is of " + std::to_string(p.width) + " x " + std::to_string(p.height) + " pixels, its camera of " +
                      std::to_string(view.camera->width_px()) + " x " + std::to_string(view.camera->height_px()),
                  "label the photograph that the camera took");
  }
  if (!(wish.pixels > 0)) throw Error(Exit::data, "the size of faces", "is not positive", "1 is a pixel");
}

}  // namespace

LabelledMesh label_faces(const io::TriangleMesh& mesh, std::span<const LabelView> views, const FaceWish& wish) {
  check_views(mesh, views, wish);
  const Polling polling(mesh, views, wish);
  LabelledMesh result;
  result.mesh = mesh;
  result.mesh.labels.clear();
  std::vector<Vote> votes(mesh.triangles.size());
  std::vector<std::uint32_t> root(mesh.triangles.size());
  std::iota(root.begin(), root.end(), 0u);
  std::vector<std::uint8_t> again(mesh.triangles.size(), 1);
  for (int round = 0;; ++round) {
    poll(polling, result.mesh, again, votes);
    std::vector<std::uint8_t> wanted(votes.size());
    for (std::size_t t = 0; t < votes.size(); ++t) wanted[t] = votes[t].mixed && votes[t].longest_px > wish.pixels;
    if (round >= wish.deepest || std::find(wanted.begin(), wanted.end(), 1) == wanted.end()) break;
    Split split = bisect(result.mesh, wanted);
    std::vector<Vote> kept(split.from.size());
    std::vector<std::uint32_t> roots(split.from.size());
    for (std::size_t t = 0; t < kept.size(); ++t) {
      kept[t] = votes[split.from[t]];
      roots[t] = root[split.from[t]];
    }
    result.mesh = std::move(split.mesh);
    again = std::move(split.changed);
    votes = std::move(kept);
    root = std::move(roots);
  }
  if (std::none_of(votes.begin(), votes.end(), [](const Vote& v) { return v.label >= 0; }))
    throw Error(Exit::data, "the label pictures", "no view sees a labelled face",
                "check poses (world_from_camera) and the mesh's frame and unit");
  absorb_specks(result.mesh, votes);
  std::vector<std::uint32_t> parts(mesh.triangles.size());
  for (const std::uint32_t r : root) ++parts[r];
  result.split = static_cast<std::size_t>(std::count_if(parts.begin(), parts.end(), [](auto n) { return n > 1; }));
  result.mesh.labels.assign(votes.size(), unlabelled);
  result.confidence.assign(votes.size(), 0);
  result.seen.assign(votes.size(), 0);
  for (std::size_t t = 0; t < votes.size(); ++t) {
    result.mesh.labels[t] = votes[t].label;
    result.confidence[t] = votes[t].confidence;
    result.seen[t] = votes[t].label >= 0 ? 1 : 0;
  }
  fill_unseen(result.mesh, votes, polling.labels(), result);
  return result;
}

}  // namespace gonio::reassembly
