// "tables": measurements, one row per observation.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "manifest/parameter.h"
#include "manifest/value.h"

namespace gonio::manifest {

struct Table {  // "tables": one row per observation, in a CSV file or inline
  std::string file;
  Value rows;                                                // inline rows [[...], ...] in the order of `columns`
  std::string model;                                         // forward model that predicts it: "camera", "surface", ...
  std::vector<std::pair<std::string, std::string>> columns;  // name -> unit, in the file's order
  std::vector<std::string> observed, sigma;
  std::string camera, board;       // model "camera": whose corners these are
  std::string surface{}, light{};  // models "surface", "light": what the base model believes
  std::string group{};             // column whose equal values belong together: held out together
  std::string block{};             // column whose equal values share their noise; left out: single rows
  std::string expression{};        // model "expression": the forward model over columns and parameters
  Parameters parameters{};         // of the forward model: expressions, gains
  Sigmas sigmas{};                 // beside fitted parameters
};

}  // namespace gonio::manifest
