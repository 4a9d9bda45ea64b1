// How right labels are, against the truth of label_scene.h.
#pragma once
#include <array>
#include <map>
#include <string>
#include <vector>

#include "reassembly/label_scene.h"

namespace gonio::tests {

// Of stated confidences in bins: how many, how many right, mean stated.
struct Reliability {
  static constexpr std::array<double, 8> edges{0, 0.5, 0.7, 0.85, 0.93, 0.97, 0.99, 1.0001};
  std::array<double, 7> count{}, right{}, stated{};
  void add(double confidence, bool is_right) {
    std::size_t bin = 0;
    while (bin + 1 < count.size() && confidence >= edges[bin + 1]) ++bin;
    ++count[bin];
    right[bin] += is_right;
    stated[bin] += confidence;
  }
  std::string words() const {
    std::string text;
    for (std::size_t b = 0; b < count.size(); ++b)
      if (count[b] > 0) {
        char part[80];
        std::snprintf(part, sizeof part, "%.3f->%.3f (%.0f)  ", stated[b] / count[b], right[b] / count[b], count[b]);
        text += part;
      }
    return text;
  }
};

struct FaceScore {
  std::size_t away = 0, away_right = 0, cloth_wrong = 0, seen = 0, seen_right = 0, unseen = 0, unseen_right = 0,
              faces = 0, split = 0;
  double area_right = 0, area = 0, away_area_right = 0, away_area = 0;  // of what is seen
  std::vector<double> border_px;  // of the middles of the label border's edges from the true one, sorted
  double quantile(double q) const {
    return border_px.empty() ? 0 : border_px[static_cast<std::size_t>(q * static_cast<double>(border_px.size() - 1))];
  }
};

// Away from borders: no part of the face comes nearer to one than a pixel sees.
inline FaceScore face_score(const LabelScene& s, const reassembly::LabelledMesh& labelled, Reliability& reliability) {
  FaceScore score;
  const io::TriangleMesh& mesh = labelled.mesh;
  score.split = labelled.split;
  score.faces = mesh.triangles.size();
  std::map<std::array<std::uint32_t, 2>, std::size_t> edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& f = mesh.triangles[t];
    const std::array<Vec3, 3> p{mesh.positions_m[f[0]], mesh.positions_m[f[1]], mesh.positions_m[f[2]]};
    const Vec3 middle = (p[0] + p[1] + p[2]) / 3;
    const bool right = mesh.labels[t] == s.label(middle);
    if (labelled.seen[t] == 0) {
      ++score.unseen;
      score.unseen_right += right;
      continue;
    }
    ++score.seen;
    score.seen_right += right;
    reliability.add(labelled.confidence[t], right);
    double reach = 0;
    for (const Vec3& corner : p) reach = std::max(reach, norm(corner - middle));
    const double area = norm(cross(p[1] - p[0], p[2] - p[0])) / 2;
    if (s.from_border_m(middle) > reach + s.pixel_m) {
      ++score.away;
      score.away_right += right;
      score.away_area += area;
      score.away_area_right += right ? area : 0;
      score.cloth_wrong += !right && s.on_cloth(middle);
    }
    score.area += area;
    score.area_right += right ? area : 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [low, high] = std::minmax(f[c], f[(c + 1) % 3]);
      const auto [found, fresh] = edges.try_emplace({low, high}, t);
      if (fresh || labelled.seen[found->second] == 0 || mesh.labels[found->second] == mesh.labels[t]) continue;
      score.border_px.push_back(s.from_border_m((mesh.positions_m[low] + mesh.positions_m[high]) / 2) / s.pixel_m);
    }
  }
  std::sort(score.border_px.begin(), score.border_px.end());
  return score;
}

inline std::string face_words(const FaceScore& s) {
  const auto share = [](std::size_t part, std::size_t all) { return all == 0 ? 100.0 : 100.0 * part / all; };
  char text[400];
  std::snprintf(text, sizeof text,
                "away %.2f %% of %zu (%zu wrong on cloth), by area %.2f %%; all seen %.2f %%, by area %.2f %%, unseen "
                "%.1f %% of %zu; border 50/95/99/max %% "
                "%.2f %.2f %.2f %.2f px; %zu split into %zu",
                share(s.away_right, s.away), s.away, s.cloth_wrong, 100 * s.away_area_right / s.away_area,
                share(s.seen_right, s.seen), 100 * s.area_right / s.area, share(s.unseen_right, s.unseen), s.unseen,
                s.quantile(0.5), s.quantile(0.95), s.quantile(0.99), s.quantile(1), s.split, s.faces);
  return text;
}

// Pixels: right of those labelled and labelled of all, two pixels and more from any border of the true picture.
inline std::string pixel_words(const LabelScene& s, const std::vector<reassembly::LabelPicture>& pictures) {
  double all = 0, labelled = 0, right = 0, inner = 0, inner_right = 0;
  for (std::size_t v = 0; v < pictures.size(); ++v) {
    const auto& p = pictures[v];
    for (int y = 2; y + 2 < p.height; ++y)
      for (int x = 2; x + 2 < p.width; ++x) {
        const auto at = [&](int dx, int dy) {
          return s.truth[v][static_cast<std::size_t>((y + dy) * p.width + x + dx)];
        };
        if (at(0, 0) < 0) continue;
        const auto label = p.label[static_cast<std::size_t>(y * p.width + x)];
        bool even = true;
        for (int dy = -2; dy <= 2; ++dy)
          for (int dx = -2; dx <= 2; ++dx) even = even && at(dx, dy) == at(0, 0);
        ++all;
        labelled += label >= 0;
        right += label == at(0, 0);
        inner += even;
        inner_right += even && label == at(0, 0);
      }
  }
  char text[200];
  std::snprintf(text, sizeof text, "labelled %.2f %%, right %.2f %% of all, %.2f %% two pixels from borders",
                100 * labelled / all, 100 * right / all, 100 * inner_right / inner);
  return text;
}

// Which true material each found one is: the nearest in log albedo (of chromaticity alone where lightness is unknown).
inline std::vector<std::int32_t> matching(const std::vector<reassembly::Material>& found,
                                          const std::vector<reassembly::Material>& truth, bool lightness) {
  std::vector<std::int32_t> names;
  const auto log = [](Vec3 v) { return Vec3{std::log(v.x), std::log(v.y), std::log(v.z)}; };
  for (const auto& f : found) {
    double least = 1e9;
    std::int32_t best = 0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      Vec3 d = log(f.albedo) - log(truth[k].albedo);
      if (!lightness) d = d - Vec3{1, 1, 1} * mean(d);
      if (norm(d) >= least) continue;
      least = norm(d);
      best = static_cast<std::int32_t>(k);
    }
    names.push_back(best);
  }
  return names;
}

inline void rename(reassembly::LabelPicture& picture, const std::vector<std::int32_t>& names) {
  for (std::int32_t& label : picture.label)
    if (label >= 0) label = names[static_cast<std::size_t>(label)];
}

}  // namespace gonio::tests
