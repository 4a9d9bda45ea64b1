// What was found, into the manifest.
#include <algorithm>
#include <cmath>

#include "manifest/sections/object.h"
#include "manifest/sections/placement.h"
#include "manifest/sections/volume.h"
#include "reassembly/piece_document.h"

namespace gonio::reassembly {
namespace {

std::string word_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::placed: return "placed";
    case Verdict::ambiguous: return "ambiguous";
    case Verdict::mirrored: return "mirrored";
    case Verdict::scaled: return "scaled";
    case Verdict::poor: return "poor";
    case Verdict::lost: break;
  }
  return "lost";
}

std::vector<double> three(Vec3 v) {
  return {v.x, v.y, v.z};
}

manifest::Pose<frame::World, frame::Object> pose_of(const Rigid<frame::World, frame::Object>& rigid,
                                                    std::optional<manifest::PoseSigma> sigma) {
  manifest::Pose<frame::World, frame::Object> pose;
  pose.rotation = rigid.rotation;
  pose.translation_m = rigid.translation_m;
  pose.sigma = std::move(sigma);
  return pose;
}

void enter_pairs(const Placed& placed, const Piece& piece, const std::vector<View>& views, const Bundles& bundles,
                 manifest::Placement& entry, manifest::Document& document) {
  double squares = 0, expected = 0;
  for (const Pair& pair : placed.pairs) {
    const Bundle& bundle = bundles.found[pair.bundle];
    manifest::MarkerPair own{.marker = piece.markers[pair.marker].id};
    std::vector<std::vector<double>> pixels;
    for (const Sighting& s : bundle.sightings) {
      own.images.push_back(views[s.view].image);
      const Vec2 centre = views[s.view].outlines[s.outline].centre_px;
      pixels.push_back({centre.x, centre.y});
    }
    own.world_m = three(bundle.centre_m);
    own.residual_m = pair.residual_m, own.expected_m = pair.expected_m;
    own.residual_px = pair.residual_px;
    if (std::isfinite(pair.moves_m)) own.moves_m = pair.moves_m;
    squares += pair.residual_m * pair.residual_m, expected += pair.expected_m * pair.expected_m;
    for (manifest::Marker& marker : document.markers)
      if (marker.id == own.marker) marker.seen_in = own.images, marker.pixel = pixels;
    entry.pairs.push_back(std::move(own));
  }
  if (placed.pairs.empty()) return;
  entry.rms_m = std::sqrt(squares / static_cast<double>(placed.pairs.size()));
  entry.expected_m = std::sqrt(expected / static_cast<double>(placed.pairs.size()));
}

}  // namespace

Mat3 covariance_at(const Placed& placed, Vec3 point_m) {
  // d point = t + w x r = t + A w with r from the centroid: A C_ww A' + A C_wt + C_tw A' + C_tt.
  const Vec3 r = point_m - placed.centroid_m;
  const double a[3][3] = {{0, r.z, -r.y}, {-r.z, 0, r.x}, {r.y, -r.x, 0}};
  const auto c = [&](int i, int j) { return placed.covariance[static_cast<std::size_t>(6 * i + j)]; };
  Mat3 out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double sum = c(3 + i, 3 + j);
      for (int k = 0; k < 3; ++k) {
        sum += a[i][k] * c(k, 3 + j) + c(3 + i, k) * a[j][k];
        for (int l = 0; l < 3; ++l) sum += a[i][k] * c(k, l) * a[j][l];
      }
      out(i, j) = sum;
    }
  return out;
}

double placed_sigma_m(const Placed& placed, const Piece& piece) {
  double sum = 0;
  for (const PieceMarker& marker : piece.markers) {
    const Mat3 c = covariance_at(placed, placed.world_from_object * marker.centre_m);
    sum += c(0, 0) + c(1, 1) + c(2, 2);
  }
  return std::sqrt(std::max(0.0, sum / static_cast<double>(3 * piece.markers.size())));
}

manifest::PoseSigma pose_sigma(const Placed& placed) {
  const Mat3 origin = covariance_at(placed, placed.world_from_object.translation_m);
  manifest::PoseSigma sigma;
  for (int i = 0; i < 3; ++i) {
    sigma.rotation_rad.push_back(std::sqrt(std::max(0.0, placed.covariance[static_cast<std::size_t>(7 * i)])));
    sigma.translation_m.push_back(std::sqrt(std::max(0.0, origin(i, i))));
  }
  return sigma;
}

void enter(const Placement& placement, const std::vector<Piece>& pieces, const std::vector<View>& views,
           const Bundles& bundles, manifest::Document& document) {
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const Placed& placed = placement.pieces[p];
    std::erase_if(document.placements, [&](const manifest::Placement& e) { return e.object == placed.object; });
    for (manifest::Marker& marker : document.markers)
      if (marker.object == placed.object) marker.seen_in.clear(), marker.pixel.clear();
    manifest::Placement entry{.object = placed.object, .evidence = "markers", .verdict = word_of(placed.verdict)};
    entry.why = placed.why;
    entry.chi_square = placed.chi_square, entry.degrees = placed.degrees;
    for (const std::size_t m : placed.unseen) entry.unseen.push_back(pieces[p].markers[m].id);
    for (const Candidate& candidate : placed.candidates)
      entry.candidates.push_back(pose_of(candidate.world_from_object, {}));
    if (placed.verdict == Verdict::scaled) entry.scale = placed.scale;
    const bool stands = placed.verdict == Verdict::placed;  // else it stays where it was believed to be
    if (stands) {
      if (placement.sigma_scale > 0) entry.scale = placement.scale, entry.sigma["scale"] = {placement.sigma_scale};
      entry.covariance.assign(placed.covariance.begin(), placed.covariance.end());
      entry.centroid_m = three(placed.centroid_m);
      entry.world_from_object = pose_of(placed.world_from_object, pose_sigma(placed));
      enter_pairs(placed, pieces[p], views, bundles, entry, document);
    }
    for (manifest::Object& object : document.objects)
      if (stands && object.id == placed.object) object.world_from_object = entry.world_from_object;
    document.placements.push_back(std::move(entry));
  }
}

}  // namespace gonio::reassembly
