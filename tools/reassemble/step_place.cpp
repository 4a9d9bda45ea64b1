// Pieces, their markers in the photographs, and where they stand.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "manifest/image_list.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/volume.h"
#include "reassembly/frame_loops.h"
#include "reassembly/hidden.h"
#include "reassembly/mix_ups.h"
#include "reassembly/tie_break.h"
#include "tools/reassemble/work.h"

namespace gonio::tools::reassemble {
namespace {

using reassembly::Verdict;

double largest_radius_m(const Work& work) {
  double largest = 0;
  for (const reassembly::Piece& piece : work.pieces)
    for (const reassembly::PieceMarker& marker : piece.markers) largest = std::max(largest, marker.radius_m);
  return work.asked.marker_radius_m.value_or(largest);
}

void check_radii(const Work& work) {
  if (largest_radius_m(work) > 0) return;
  log(LogLevel::warning, "no marker has a radius_m: distances are found by the directions alone (--marker-radius)");
}

void judge(Work& work, const reassembly::Placed& placed, const reassembly::Piece& piece) {
  if (placed.verdict != reassembly::Verdict::placed) {
    work.complaints.push_back(placed.object + ": not placed: " + placed.why);
    return;
  }
  const double sigma = reassembly::placed_sigma_m(placed, piece);
  log(LogLevel::info, format("%s: placed by %zu of %zu markers, to %.3g mm", placed.object.c_str(), placed.pairs.size(),
                             piece.markers.size(), 1e3 * sigma));
  if (work.asked.max_error_m && sigma > *work.asked.max_error_m)
    work.complaints.push_back(
        format("%s: its markers are placed to %.3g mm (one standard deviation), limit %.3g mm; "
               "photograph it from more sides",
               placed.object.c_str(), 1e3 * sigma, 1e3 * *work.asked.max_error_m));
}

// Sightings through a piece's body are none of the marker's place. True where there were some.
bool take_out_hidden(Work& work) {
  const PlacedPieces pieces = placed_pieces(work);
  std::vector<reassembly::Sighting> hidden =
      reassembly::hidden_sightings(work.seen.views, work.bundles, work.placement, work.pieces, posed(pieces));
  std::ranges::sort(hidden, std::ranges::greater{}, &reassembly::Sighting::outline);  // later ones first
  for (const reassembly::Sighting& s : hidden) {
    auto& outlines = work.seen.views[s.view].outlines;
    const auto at = outlines.begin() + static_cast<std::ptrdiff_t>(s.outline);
    work.behind.push_back({s.view, *at});
    outlines.erase(at);
  }
  return !hidden.empty();
}

// Layouts that fit in several ways: photographs may know which. True where one more is known than before.
bool break_ties(Work& work, reassembly::PlaceWish& wish) {
  manifest::Document scene = work.call.document;
  for (const reassembly::Placed& placed : work.placement.pieces)
    for (manifest::Object& object : scene.objects)
      if (object.id == placed.object && placed.verdict == Verdict::placed) {
        object.world_from_object.emplace();
        static_cast<Rigid<frame::World, frame::Object>&>(*object.world_from_object) = placed.world_from_object;
      }
  bool broken = false;
  for (reassembly::Placed& placed : work.placement.pieces) {
    if (placed.verdict != Verdict::ambiguous || placed.candidates.size() < 2) continue;
    const reassembly::Tie tie = reassembly::break_tie(scene, placed.object, placed.candidates,
                                                      {.seed = work.call.seed, .folder = work.call.out});
    work.ties.push_back(placed.object + ": " + tie.words);
    log(LogLevel::info, work.ties.back());
    if (!tie.meant) continue;
    wish.meant.emplace_back(placed.object, placed.candidates[*tie.meant].world_from_object);
    broken = true;
  }
  return broken;
}

// The tomograph's scale, where it was fitted: lengths of meshes and markers are multiplied by it.
void scale_pieces(Work& work) {
  const double scale = work.placement.scale;
  if (!work.asked.place.free_scale || !(work.placement.sigma_scale > 0)) return;
  for (const reassembly::Placed& placed : work.placement.pieces) {
    if (placed.verdict != reassembly::Verdict::placed) continue;
    io::TriangleMesh mesh = mesh_of(work, placed.object);
    for (Vec3& p : mesh.positions_m) p = scale * p;
    enter_mesh(work, placed.object, mesh, {});
    for (manifest::Marker& marker : work.call.document.markers) {
      if (marker.object != placed.object) continue;
      for (double& x : marker.centre_m) x *= scale;
      if (marker.radius_m) *marker.radius_m *= scale;
      for (double& c : marker.covariance_m2) c *= scale * scale;
    }
  }
}

}  // namespace

void take_pieces(Work& work) {
  for (const AskedPiece& piece : work.asked.pieces) {
    work.call.note_input(piece.file);
    const manifest::Document own =
        manifest::read_document(piece.file, {.allow_outside = work.call.flag("allow-outside")});
    reassembly::take_in(work.call.document, own, piece.object, piece.name);
  }
  work.pieces = reassembly::pieces_of(work.call.document);
  check_radii(work);
}

void see(Work& work) {
  work.seen = reassembly::views_of(work.call.document, work.asked.images, work.asked.detect, largest_radius_m(work));
  for (std::size_t v = 0; v < work.seen.views.size(); ++v)
    for (const reassembly::Refused& r : work.seen.refused[v])
      log(LogLevel::debug, format("%s: what is at %.1f, %.1f, of radius %.1f px, ", work.seen.views[v].image.c_str(),
                                  r.centre_px.x, r.centre_px.y, r.radius_px) +
                               r.why);
  std::size_t outlines = 0;
  for (const reassembly::View& view : work.seen.views) outlines += view.outlines.size();
  log(LogLevel::info, format("%zu outlines of spheres in %zu photographs", outlines, work.seen.views.size()));
}

void put(Work& work) {
  reassembly::PlaceWish wish = work.asked.place;
  if (!wish.radius_m) {
    // Where all pieces state one radius within 5 %, that is the radius of a marker.
    double low = HUGE_VAL, high = 0, sum = 0, count = 0;
    for (const reassembly::Piece& piece : work.pieces)
      for (const reassembly::PieceMarker& m : piece.markers)
        low = std::min(low, m.radius_m), high = std::max(high, m.radius_m), sum += m.radius_m, ++count;
    if (low > 0 && high < 1.05 * low) wish.radius_m = sum / count;
  }
  work.bundles = reassembly::bundles(work.seen.views, wish);
  work.placement = reassembly::place(work.seen.views, work.bundles, work.pieces, wish);
  constexpr int rounds = 3;
  for (int round = 0; round < rounds && take_out_hidden(work); ++round) {
    work.bundles = reassembly::bundles(work.seen.views, wish);
    work.placement = reassembly::place(work.seen.views, work.bundles, work.pieces, wish);
  }
  if (break_ties(work, wish)) work.placement = reassembly::place(work.seen.views, work.bundles, work.pieces, wish);
  reassembly::enter(work.placement, work.pieces, work.seen.views, work.bundles, work.call.document);
  for (std::size_t p = 0; p < work.pieces.size(); ++p) judge(work, work.placement.pieces[p], work.pieces[p]);
  if (!work.complaints.empty()) {
    std::vector<std::string> cameras;
    for (const reassembly::View& view : work.seen.views)
      cameras.push_back(
          manifest::camera_of_image(work.call.document, *manifest::index_of_image(work.call.document, view.image)));
    const std::string wrong = reassembly::mix_up(work.seen.views, cameras, work.pieces, wish, work.placement);
    if (!wrong.empty()) work.complaints.insert(work.complaints.begin(), "it would fit if " + wrong);
  }
  if (!work.placement.left_over.empty())
    log(LogLevel::info, format("%zu spheres in the photographs belong to no piece", work.placement.left_over.size()));
  scale_pieces(work);
}

void check_frames(Work& work) {
  work.loops = reassembly::frame_loop_complaint(work.call.document);
  if (!work.loops.empty()) work.complaints.push_back(work.loops);
}

}  // namespace gonio::tools::reassemble
