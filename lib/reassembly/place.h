// Where the pieces stand: their markers, known from a tomograph, found again in calibrated photographs.
//
//   outlines of many views -> ray bundles -> points with covariance -> pairs with the pieces' markers -> poses
//
// 1. Bundles. Two sightings belong together where their rays meet within their uncertainty (Sampson distance of the
//    epipolar constraint), where the half angles of their cones say one radius and one distance, and where every
//    further view that should see the marker agrees. A marker seen through glass, or in a mirror, is displaced
//    differently in each view: it finds no bundle, or one whose residuals are too large, and is said to be refracted.
// 2. Pairs. Distances between points are compared with distances between the piece's markers, each with its own
//    uncertainty; sets that agree grow (a search for the largest consistent set, missing and additional markers
//    allowed). The mirrored set is tried as well, so that a layout which fits only mirrored is named, not accepted.
// 3. Poses. Orthogonal Procrustes weighted by both covariances, reflection excluded, then one adjustment over all
//    pieces' poses, all markers' true places (prior: the tomograph's) and, where asked, the tomograph's scale, on the
//    rays themselves.
// What cannot be known from outlines: a piece that every view sees through one flat pane is displaced as a whole, and
// fits. Where some views see it past the glass, it fits twice, and is ambiguous.
// An answer that another one rivals is not given: `ambiguous`, with the candidates. World frame, metres, radians.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "geom/rigid.h"
#include "geom/vector.h"
#include "reassembly/outline.h"

namespace gonio::reassembly {

struct View {
  std::string image;  // its id
  Rigid<frame::World, frame::Camera> world_from_camera;
  std::array<double, 36> covariance{};  // of that pose: rotation vector, then place, both by a small motion in
                                        // the world at the camera's centre; zero: known exactly
  std::vector<Outline> outlines;
};

struct PieceMarker {
  std::string id;
  Vec3 centre_m;        // object frame
  double radius_m = 0;  // 0: not known
  Mat3 covariance_m2;
};
struct Piece {
  std::string object;
  std::vector<PieceMarker> markers;
};

struct Sighting {
  std::size_t view = 0, outline = 0;
  bool operator==(const Sighting&) const = default;
};
// One marker, as the views agree on it.
struct Bundle {
  std::vector<Sighting> sightings;  // at most one a view
  Vec3 centre_m;                    // world
  Mat3 covariance_m2;
  std::optional<double> radius_m{};
  double chi_square = 0;  // of the sightings about it,
  int degrees = 0;        // and its degrees of freedom
};
enum class Fate { bundled, alone, refracted, reflected };
struct Bundles {
  // Where there are few views, two bundles may share a sighting: at most one of such rivals is a marker, and which, the
  // epipolar constraint cannot tell; the layout can, and place() uses one of them at most. A bundle without sightings
  // is a point that was measured otherwise (a laser scanner): its centre and covariance are taken as they are.
  std::vector<Bundle> found;
  std::vector<std::vector<Fate>> fate;  // of every outline of every view
};

struct PlaceWish {
  std::optional<double> radius_m{};  // of all markers, where known and equal
  bool free_scale = false;           // one scale for all pieces' tomographs
  double false_alarm = 1e-4;         // of a pairing by chance that still counts
  int fewest_markers = 3;
  std::uint64_t seed = 0;
  // Ties that something else has broken (photographs, by rendering: tie_break.h): of this object's candidates the one
  // nearest to this pose is meant.
  std::vector<std::pair<std::string, Rigid<frame::World, frame::Object>>> meant{};
};
Bundles bundles(std::span<const View> views, const PlaceWish& wish);

struct Pair {
  std::size_t marker = 0, bundle = 0;  // of the piece, of Bundles::found
  double residual_m = 0;               // distance of the placed marker from the bundle's centre,
  double expected_m = 0;               // and the rms it should have by both covariances
  double residual_px = 0;              // rms over its sightings
  // By which the piece's markers would move (rms) without this one; infinite where the others would not hold it.
  double moves_m = 0;
  std::vector<Sighting> dropped{};  // of the bundle: contradict the rest (refracted, partly hidden)
};
enum class Verdict {
  placed,
  ambiguous,  // other pairings explain the points as well
  mirrored,   // only the mirror image fits: handedness of the volume, or left for right
  scaled,     // fits by another size only: `scale` says which (1000: mm for m)
  poor,       // too few markers, or all on a line
  lost        // nothing fits
};
struct Candidate {
  Rigid<frame::World, frame::Object> world_from_object;
  std::vector<std::array<std::size_t, 2>> pairs;  // marker, bundle
  double chi_square = 0;
  int degrees = 0;
};
struct Placed {
  std::string object;
  Verdict verdict = Verdict::lost;
  std::string why;                                       // in words; empty where placed
  Rigid<frame::World, frame::Object> world_from_object;  // of the piece after multiplication by `scale`
  // Of a small motion (rotation vector, place) in the world at the centroid of the paired markers, rad and m.
  std::array<double, 36> covariance{};
  Vec3 centroid_m;
  std::vector<Pair> pairs;
  std::vector<std::size_t> unseen;    // markers of the piece that no bundle shows
  std::vector<Candidate> candidates;  // where ambiguous: all that fit, best first; where poor: some
  double scale = 1;                   // by which the piece's lengths had to be multiplied (Verdict::scaled)
  double chi_square = 0;
  int degrees = 0;
};
struct Placement {
  std::vector<Placed> pieces;
  std::vector<std::size_t> left_over;  // bundles that belong to no piece: false markers, or an unknown piece
  std::vector<std::size_t> reflected;  // bundles that fit a placed piece mirrored: seen in a mirror
  // As Bundles::fate, with what the pieces' places tell: outlines displaced from a marker that their view does not
  // show otherwise are refracted, those of reflected bundles reflected.
  std::vector<std::vector<Fate>> fate;
  double scale = 1, sigma_scale = 0;  // of the tomograph, where it was free
};
// Error(data) where there is no piece at all, or neither view nor bundle; everything else is a verdict.
Placement place(std::span<const View> views, const Bundles& bundles, std::span<const Piece> pieces,
                const PlaceWish& wish);

}  // namespace gonio::reassembly
