// What is read off simulated volumes of the believed shape, where it was read off the recorded one. Private to
// volumes/.
#pragma once
#include <vector>

#include "explain/volumes/observed.h"
#include "explain/volumes/simulated_tomograph.h"
#include "explain/volumes/sites.h"

namespace gonio::explain::volumes {

// How edges are read: at every site within `reach` voxels.
std::vector<volume::Edge> edges_of(const Sampled& sampled, const std::vector<Site>& sites, const Values& values,
                                   double reach);

// Fills simulated, hardening, scatter, blur and markers of the rows and simulated_width; drops edges that the simulated
// volume does not show. Where the tomograph is not fine, edges are taken to be those of a plane wall.
void add_simulated(const Tomograph& tomograph, const Sampled& sampled, const Values& values,
                   const std::vector<Site>& sites, const std::vector<Ball>& markers, double reach,
                   std::vector<Row>& rows, Observed& observed);

}  // namespace gonio::explain::volumes
