// Cells as tensors for learning: [cell, channel, row, column], 32-bit floats, one .npy file each, mapped into memory by
// numpy.load(path, mmap_mode="r") and torch.from_numpy without a copy.
//
// SHARE-NAME.npy, SHARE one of training, validation, test; cells by their number. Inputs, each for "bare" and "lit":
//   rgb-bare          3  linear, with the noise of a sensor without polarizers
//   stokes-bare       3  s0, s1, s2 as developed from the mosaic (photograph/polarizers.h), in the picture's frame
//   intensities-bare  4  behind 0, 45, 90, 135 degrees: the readings of a super-pixel, at each of its four pixels
// What is to be learnt:
//   mask              1  1 where the object is met
//   depth             1  m along the camera's axis; 0 outside
//   front, back       3  unit normals in the camera's frame (x right, y down, z forward); 0 outside. front: of the
//   first
//                        surface, towards the camera; back: outward, where the straight ray leaves the object
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "glass/set.h"
#include "io/npy_write.h"

namespace gonio::glass {

struct TensorName {
  const char* name;
  std::size_t channels;
};
const std::vector<TensorName>& tensor_names();

// Of a cell that is made: name -> channels x height x width. Error(data) where files are damaged or others.
std::map<std::string, std::vector<float>> tensors_of(const GlassSet& set, const Cell& cell);

// Share of the pixels that meet the object.
double coverage_of(const std::vector<float>& mask);

// One share's files, cell after cell.
class TensorFiles {
 public:
  TensorFiles(const std::filesystem::path& folder, Share share, std::size_t cells, int width_px, int height_px);
  void append(const std::map<std::string, std::vector<float>>& tensors);
  std::vector<std::filesystem::path> commit();

 private:
  std::vector<std::filesystem::path> paths_;
  std::map<std::string, std::unique_ptr<io::NpyWriter>> files_;
};

}  // namespace gonio::glass
