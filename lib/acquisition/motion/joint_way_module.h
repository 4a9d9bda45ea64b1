// The module joint_way (base/loaded_library.h): OMPL's RRT-Connect, as joint_way.cpp asks for it.
#pragma once
#include <cstdint>
#include <vector>

#include "base/random.h"

namespace gonio::acquisition {

class SearchedSpace {  // of so many numbers, each within bounds
 public:
  virtual ~SearchedSpace() = default;
  virtual unsigned dimensions() const = 0;
  virtual double lower(unsigned k) const = 0;
  virtual double upper(unsigned k) const = 0;
  virtual double drawn(unsigned k, Random& random) const = 0;
  virtual bool open(const double* at) const = 0;
  virtual bool open(const double* from, const double* to) const = 0;
};

}  // namespace gonio::acquisition

extern "C" {
// Appends the places of a way through what is open to `way`; false where `tries` of the search find none.
bool gonio_joint_way(const gonio::acquisition::SearchedSpace& search, const std::vector<double>& from,
                     const std::vector<double>& to, std::uint64_t seed, int tries,
                     std::vector<std::vector<double>>& way);
}
