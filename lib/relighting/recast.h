// Views of a scene whose objects stand a little otherwise: the sampled pixels' rays cast anew, with small lights and
// coarsely, at a few settings of each parameter of a mechanism of objects. The change of a prediction is interpolated
// between them; changes by several parameters are added up.
//   P(a) - P(0) = sum over parameters of  D+ (t + t^2) / 2 - D- (t - t^2) / 2,   t = a / step,  D = P(node) - P(0)
// within a step of neutral, and goes on with the slope there beyond. Steps move the picture by about a pixel:
// silhouettes pass over a pixel within that. Light by way of other surfaces is that of the unmoved scene.
#pragma once
#include "relighting/image_model.h"
#include "relighting/uses.h"

namespace gonio::relighting {

struct Recasts final : Prepared {
  struct Node {
    std::vector<ViewCache> views;
    std::vector<std::vector<float>> sums;            // [view]: facet_sums()
    std::vector<std::vector<std::uint8_t>> differs;  // [view][pixel]: 1 where anything is not that of the unmoved scene
  };
  Node unmoved;
  std::vector<double> step;       // one per parameter
  std::vector<Node> minus, plus;  // one per parameter
  bool exact = false;             // `plus[0]` is the scene at the very amounts of the state
};

// One use for each object that is not a plane and does not fill more than the pictures show.
std::vector<Use> object_uses(const Setting& setting, const mechanism::Mechanism& mechanism);
std::shared_ptr<const Prepared> prepare_recasts(const Setting& setting, const Use& use);
void add_recasts(const Use& use, const Frame& frame, std::span<double> radiance);
void recast_slopes(const Use& use, const Frame& frame, std::span<const std::size_t> numbers, std::span<double> columns);

// Light by way of surfaces for another cache of the same pixels: that of the same pixel's facet of the same surface,
// else of the one seen last.
void lend_indirect(const ViewCache& from, ViewCache& to);

// A term that moves objects.
Term recast_term(const mechanism::Mechanism& (*mechanism)(), std::vector<Use> (*candidates)(const Setting&));

}  // namespace gonio::relighting
