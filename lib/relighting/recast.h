// Views of a scene whose objects stand otherwise: the sampled pixels' rays cast anew, with small lights and coarsely,
// at places of a lattice over the parameters of a mechanism of objects. About the nearest place c the change of a
// prediction is interpolated between a step to either side, and changes by several parameters are added up:
//   P(a) - P(0) = P(c) - P(0) + sum over parameters of  D+ (t + t^2) / 2 - D- (t - t^2) / 2,
//   t = (a - c) / step,  D = P(node) - P(c),  |t| <= 1/4: places are half a step apart.
// A step moves the picture by about a pixel: silhouettes pass over a pixel within that, and changes of six numbers that
// are added up must be small beside it. Places are cast where a fit looks, and what one holds depends on its amounts
// alone. Light by way of other surfaces is that of the unmoved scene.
#pragma once
#include "relighting/image_model.h"
#include "relighting/uses.h"

namespace gonio::relighting {

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
