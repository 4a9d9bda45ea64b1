// Between the manifest and place.h: pieces out of the manifests that ct-mesh-clean wrote, views out of calibrated
// photographs, and what was found back into the manifest. World frame, metres, radians.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "manifest/document.h"
#include "manifest/pose.h"
#include "reassembly/detect.h"
#include "reassembly/place.h"

namespace gonio::reassembly {

// Takes the object that `other` describes into `into`, under the name `as` (empty: its own): its mesh, surface, volume
// and markers with the files that they name, all of them renamed with it. Returns the name. Error(data) at the place in
// `other` where it has no object with markers, or several of which `object` (empty: any) names none; where `into` has
// an object of that name with another mesh; where a surface of one name is not the same in both.
std::string take_in(manifest::Document& into, const manifest::Document& other, const std::string& object,
                    const std::string& as);

// The objects of the manifest that have markers, in the order of `objects`. Error(data): a marker of an object that is
// not there, without a covariance and so on; none at all.
std::vector<Piece> pieces_of(const manifest::Document& document);

// The camera of an image. Error(data) where the manifest has several and the image names none.
camera::CameraModel camera_of(const manifest::Document& document, std::size_t image);

// Images that have a camera, a pose and a picture: with the outlines that they show. `images`: which (empty: all of
// them); those without a pose are refused. Reads pictures, masks.
struct SeenViews {
  std::vector<View> views;                    // their outlines by detect_spheres()
  std::vector<std::vector<Refused>> refused;  // of each view
};
// `marker_radius_m` (0: not known) bounds the size of outlines where all cameras look at about one place: half to twice
// what a marker there has, unless `wish` bounds half angles itself.
SeenViews views_of(const manifest::Document& document, const std::vector<std::string>& images, const DetectWish& wish,
                   double marker_radius_m = 0);

// Objects get their poses, markers the images that show them, and `placements` an entry for every piece. What an
// earlier run said of the same pieces is replaced.
void enter(const Placement& placement, const std::vector<Piece>& pieces, const std::vector<View>& views,
           const Bundles& bundles, manifest::Document& document);

// Of a point that is fixed to a placed piece, world: m^2.
Mat3 covariance_at(const Placed& placed, Vec3 point_m);
// One standard deviation of the places of the piece's markers, rms over them and over x, y, z.
double placed_sigma_m(const Placed& placed, const Piece& piece);
// Of the pose of a piece: one standard deviation of a small rotation about each axis, and of the place of its origin.
manifest::PoseSigma pose_sigma(const Placed& placed);

}  // namespace gonio::reassembly
