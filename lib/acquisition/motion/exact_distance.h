// The distance of two solids in place.
#pragma once
#include <memory>
#include <vector>

#include "acquisition/motion/body.h"

namespace gonio::acquisition {

class ExactDistances {
 public:
  explicit ExactDistances(const std::vector<Body>& bodies);  // keeps a reference
  ~ExactDistances();
  // 0 where they meet; closed meshes meet what is inside of them.
  double between(std::size_t a, const PlacedBody& at_a, std::size_t b, const PlacedBody& at_b) const;

 private:
  struct Shapes;
  std::unique_ptr<const Shapes> shapes_;
};

}  // namespace gonio::acquisition
