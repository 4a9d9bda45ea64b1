// A surface as it is: all of the topmost voxel that lies within the body.
#include "relief/microstructure.h"

namespace gonio::relief {
namespace {

class None final : public Microstructure {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{.family = manifest::Family::microstructure,
                                          .id = "none",
                                          .sentence = "As it is.",
                                          .source = "",
                                          .parameters = {}};
    return info;
  }
  ShareAt made(std::span<const double>, double, const MicrostructureFiles&, const std::string&) const override {
    return [](const SurfacePlace&) { return 1.0; };
  }
};

}  // namespace

namespace microstructures {
const Microstructure& none() {
  static const None structure;
  return structure;
}
}  // namespace microstructures

}  // namespace gonio::relief
