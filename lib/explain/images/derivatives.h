// An image at one state, and what of it can be kept where a little of the state changes: derivatives shade direct light
// anew only where a parameter reaches it, and cameras that treat each value by itself are passed by what they make of a
// small change.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "explain/images/bindings.h"
#include "explain/images/model.h"

namespace gonio::explain::images {

// What of an image has to be computed anew for a parameter.
struct Touched {
  Reach reach = Reach::record;
  std::vector<std::uint32_t> surfaces;
};
Touched touched_by(const std::vector<Place>& places, const SceneState& state, const std::vector<Use>& uses);

class Derivatives {
 public:
  Derivatives(const ImageModel& model, SceneState centre, std::size_t image, std::span<const std::uint32_t> picked);
  const SceneState& centre() const { return centre_; }
  // The image at another state, of which only what is touched differs from the centre.
  void at(const SceneState& raw, const Touched& touched, std::span<double> out) const;
  // Derivatives by numbers of a term that knows the slopes of what it adds, sent on through the camera.
  void slopes(const Use& use, std::span<const std::size_t> numbers, std::span<double> columns) const;

 private:
  void find_passing(const SceneState& now);
  void find_gains(const SceneState& now);
  void composed(const SceneState& now, const Touched& touched, std::span<double> out) const;

  const ImageModel& model_;
  SceneState centre_;
  std::size_t image_;
  std::span<const std::uint32_t> picked_;
  std::shared_ptr<const Shaded> shaded_;
  std::vector<double> composed_, added_;
  ImageModel::Additions additions_;
  bool recorded_ = false, pointwise_ = true;  // by terms that are not neutral; by such as ask a value alone
  std::vector<double> values_, gain_;         // as recorded, where pointwise
  std::vector<double> passing_;               // of what terms add, by those added anew; empty: all of it
};

}  // namespace gonio::explain::images
