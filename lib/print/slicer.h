// From bodies on the platform to the pictures of layers, one after another, from the platform on.
//
// A voxel is to be solid by its share (print/coverage.h) of the layer's height. Where a surface that faces the
// projector passes through it, a micro-structure (relief/microstructure.h) modulates what lies beneath that surface and
// leaves the rest: share - beneath (1 - structure), the structure's mean over the pixel at samples x samples places.
// Surfaces that face away are left as they are, or, on request, get what lies above them modulated alike: they cure
// without a layer to hold on to, and what comes out is less sure. Bodies that share a voxel add up.
//
// The printer's growth turns heights into grey values: whole numbers from 0 to 255, rounded.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "print/coverage.h"
#include "print/printer.h"
#include "relief/microstructure.h"

namespace gonio::print {

// What u and v of a micro-structure are: the platform's x and y; the mesh's texture coordinates times `texture_m`; or
// two axes at right angles to every face's normal, along which places are counted: those of geom/vector.h, or u along
// the part of `direction` that lies in the face and v = n x u, a tangent field over the body (where a face stands at
// right angles to `direction`: as faces).
enum class StructureAxes { platform, texture, faces, direction };

struct SlicedBody {
  std::string name;               // for messages
  std::vector<Vec3> positions_m;  // on the platform; closed, outward
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Vec2> texture;         // one per vertex, or empty
  std::vector<std::int32_t> labels;  // one per triangle, or empty
  relief::ShareAt structure{};       // empty: none
  std::map<std::int32_t, relief::ShareAt> by_label{};
  StructureAxes axes = StructureAxes::platform;
  double texture_m = 1;
  Vec3 direction{0, 0, 1};          // of any length
  bool structured_beneath = false;  // surfaces that face away, too
  bool structured() const { return structure || !by_label.empty(); }
};

// Corners nearer to the border of a layer than `tolerance` of its thickness are put on it: 32-bit numbers of an STL,
// by which a flat top would lie a nanometre within the next layer.
void snap_to_layers(SlicedBody& body, const Printer& printer, double bottom_m, double tolerance = 1e-3);

struct LayerPicture {
  std::size_t index = 0;
  double bottom_m = 0, top_m = 0;
  PixelBox box{};              // that of all bodies, of every layer; outside of it all is 0
  std::vector<float> share{};  // of the box's voxels, row by row: how much of their height is to be solid
  std::vector<std::vector<PixelRange>> changed{};  // of the box's rows: what may differ from the layer before
  double solid_m3 = 0;                             // what that adds up to
  double structured_m2 = 0;                        // area, seen from above, of the surfaces that were modulated
  double unreached_m3 = 0;                         // what white does not reach
  double excess = 0;                               // by which bodies overlap
};
// Grey values of one layer after another; what did not change is not reckoned again.
class GreyPicture {
 public:
  explicit GreyPicture(const Printer& printer) : printer_(printer) {}
  const std::vector<std::uint8_t>& of(const LayerPicture& layer);  // of the box; until the next call

 private:
  Printer printer_;
  std::vector<std::uint8_t> greys_;
  std::size_t next_ = 0;  // layer
  double thickness_m_ = 0;
};

class Slicer {
 public:
  // The bodies outlive it. Error(data) for a body that leaves the printer's picture or the platform.
  Slicer(const Printer& printer, const std::vector<SlicedBody>& bodies, int samples = 4, const Rays& rays = {});
  ~Slicer();
  std::size_t layers() const { return layers_; }  // up to the highest top
  PixelBox box() const;                           // of all bodies, within the picture
  // The next layer, until the next call; null after the last. The same bytes for any number of threads.
  const LayerPicture* next();

 private:
  struct Sweep;
  double modulate(Sweep& sweep) const;  // the body's own shares; area that was structured
  void add_up();
  Printer printer_;
  int samples_;
  std::vector<std::unique_ptr<Sweep>> sweeps_;
  std::size_t layers_ = 0;
  LayerPicture layer_;
  double shares_ = 0, unreached_ = 0;  // sums over the box
  double reach_ = 0;                   // share that white reaches
};

}  // namespace gonio::print
