// Which surface each face of a background mesh has, by photographs. World frame.
//
// 1. find_materials: where nobody says what there is, all pictures together do: one clustering, so that names mean the
//    same in every view.
// 2. label_picture: a photograph into regions of one material each. Shadow and highlight must not become borders:
//    what is compared is the light divided out where the scene's lights and the surfaces' models are known (a
//    classifier: which surface predicts the pixel under the light that reaches it, shadow or not), and chromaticity
//    where they are not; a random field joins what noise would scatter, and watershed (Meyer 1994) floods from where
//    pixels know to where they do not, with seeds by the user where given.
// 3. label_faces: votes of all views that see a face (depth, incidence, confidence weighted), faces that no view sees
//    take the label of the nearest that one does; faces at borders are split until they are smaller than a pixel sees
//    (the thesis, 2.E: micropolygons).
//
// What cannot be told apart: without `shading` greys of any lightness are one material, for a shadow makes one out of
// another; a picture in which lightness itself tells is given a constant shading.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "camera/camera_model.h"
#include "geom/rigid.h"
#include "io/image.h"
#include "io/ply.h"

namespace gonio::reassembly {

constexpr std::int32_t unlabelled = -1;

struct LabelPicture {
  int width = 0, height = 0;
  std::vector<std::int32_t> label;  // per pixel, an index into the surfaces' names; unlabelled: nobody knows
  std::vector<float> confidence;    // 0 to 1: probability that it is right
};
// What is known of one material: linear colour by which the light that falls in is multiplied (without shading only the
// ratios of its channels count). `spread`: relative sd of it over the material.
struct Material {
  std::string surface;
  Vec3 albedo;
  double spread = 0.05;
};
struct LabelWish {
  std::vector<Material> materials{};  // empty: as many as the picture shows, or as the seeds name
  int most_materials = 8;             // where they are not given
  // Per pixel and channel, what a white diffuse surface would send there under the scene's lights, shadows and all; 0
  // where the believed scene has nothing; empty: not known.
  io::Image shading{};
  // Its errors: relative sd, common to the channels, and what it may lack everywhere, as a share of its mean (light
  // that came by way of other surfaces).
  double shading_spread = 0.15, shading_lack = 0.03;
  // Highlights: what the materials' interfaces add, the glossiest's, likewise (the believed scene all black with that
  // interface); empty: not known, they may be anywhere.
  io::Image highlight{};
  std::vector<std::int32_t> seeds{};  // per pixel: an index into the materials, or unlabelled; empty: none
  // With seeds: a region holds a seed of its label (an object before a background). Else a material may show anywhere.
  bool from_seeds_only = false;
  double noise_gain = 0, noise_read = 0.002;  // variance v / gain + read^2 (gain 0: none)
};

// A photograph as find_materials sees it. Linear RGB; saturated pixels are those of `clipped` (null: none); `shading`
// as in LabelWish (null: not known; one picture without it and all are compared by chromaticity).
struct LitPicture {
  const io::Image* picture = nullptr;
  const std::vector<std::uint8_t>* clipped = nullptr;
  const io::Image* shading = nullptr;
};
// Surfaces are named m1, m2, ... by their share of the pictures, largest first. Their number is that of the Bayesian
// information criterion, at most `most`. Error(data) where no pixel tells a colour.
std::vector<Material> find_materials(std::span<const LitPicture> pictures, int most = 8);

// Linear RGB in (or Y); `clipped` empty: none. Error(data) where sizes disagree, where an albedo is not positive, or
// where a seed names no material.
LabelPicture label_picture(const io::Image& picture, const std::vector<std::uint8_t>& clipped, const LabelWish& wish);

// Seeds of a picture of width x height from an 8-bit file of any size (its pixels are repeated): code 0 is unlabelled,
// code n material n - 1. Error(no_input | data).
std::vector<std::int32_t> read_seeds(const std::filesystem::path& path, int width, int height, std::size_t materials);

// For a page, sRGB codes / 255: a colour for each label that the colour-blind tell from the others (Okabe & Ito 2008,
// darker and lighter from the ninth on), black where unlabelled; and the confidence by report/colour_map.h.
io::Image coloured_labels(const LabelPicture& labels);
io::Image coloured_confidence(const LabelPicture& labels);

struct LabelView {
  const LabelPicture* picture = nullptr;
  const camera::CameraModel* camera = nullptr;
  Rigid<frame::World, frame::Camera> world_from_camera;
};
struct LabelledMesh {
  io::TriangleMesh mesh;           // labels filled; finer at borders than what came in
  std::vector<float> confidence;   // per triangle: probability that its label is right at its middle
  std::vector<std::uint8_t> seen;  // per triangle: 1 where a view voted
  std::size_t split = 0;           // faces of the given mesh that were subdivided
};
struct FaceWish {
  double pixels = 1;  // border faces are split until no edge is longer than this in the views that see it
  int deepest = 16;   // halvings of a face; each halves one edge, so that two are a halving of its size
};
// Conforming: a split edge is split for both its faces, no crack and no T-junction arises. Error(data) where no view
// sees anything labelled.
LabelledMesh label_faces(const io::TriangleMesh& mesh, std::span<const LabelView> views, const FaceWish& wish);

}  // namespace gonio::reassembly
