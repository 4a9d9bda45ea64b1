// What the refinement has to say, as files have it: a mesh, maps of every view, and how a renderer that knows nothing
// of the fit sees the body.
#pragma once
#include "glass/refine/refine.h"
#include "io/image.h"
#include "io/ply.h"

namespace gonio::glass {

// Closed, with the body's normals; metres, world.
io::TriangleMesh mesh_of(const SplineField& field);

// Of the view's (reduced) pixels, 0 where the body is missed, with the names that glass-net(1) has: mask; depth.Z (m,
// along the camera's axis); normal.X, .Y, .Z of the front and back_normal.X, .Y, .Z (unit, the world's frame);
// uncertainty.normal, uncertainty.back_normal (rad, that 68.3 % err by less than); thickness (m of glass along the
// straight ray, first to last surface).
//
// Where the body and a network contradict each other by more than `contradiction` of the network's deviations, the
// body cannot be as the network saw it, be it the mouth of a vessel or a bore that no outline shows: there the
// network's normal stands, with its own uncertainty.
inline constexpr double contradiction = 3;
io::Image maps_of(const Refined& refined, const Measuring& measuring, std::size_t view);

// The body of a stage as an object of the document: mesh file, surface of its index and absorption.
void enter_body(manifest::Document& document, const Stage& stage, double index_sigma, const std::string& id,
                const std::filesystem::path& mesh_file);

// Root of the mean square difference of s0, s1, s2 between a rendering (render --stokes) and the view's photograph,
// over its mask, as a share of the screen's mean.
double difference_from(const View& view, const io::Image& rendered);
// The document's image rendered with Stokes vectors.
io::Image rendered_with_stokes(const manifest::Document& document, std::size_t image, int spp, std::uint64_t seed,
                               const std::filesystem::path& checkpoint_beside);

}  // namespace gonio::glass
