// Mosaic photographs of a polarization camera against `render --stokes` behind its polarizers.
//
// Observations: samples of tiles (mosaic_light.h) where the simulated light changes by less than a fifth from pixel to
// pixel. Their noise is the recording's, at the mean of the samples behind the same polarizer around, and the
// simulation's own. The score is the relative RMSE. Groups: pictures, or with fewer than eight of them cells of their
// tiles; blocks: tiles, whose samples follow each other by polarizer.
//
// Base model: what the manifest states; the exposure, one factor for all pictures, and by how much each departs from it
// (1 %). Hypotheses: explain/polarization/terms, one file each.
#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "explain/domain.h"
#include "explain/engine.h"

namespace gonio::explain {

// Recordings of scenes with objects by a camera whose mosaic is "polarizers".
bool has_mosaics(const manifest::Document& document);
// Error(data) where a picture is no mosaic, or where mechanisms are on that act on readings in other ways.
void check_mosaics(const manifest::Document& document);
std::vector<std::unique_ptr<Problem>> polarization_problems(const manifest::Document& document,
                                                            const ProblemOptions& options);
std::vector<std::filesystem::path> mosaic_files(const manifest::Document& document);

}  // namespace gonio::explain
