// What each pixel says by itself: log densities of its colour under each label.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "reassembly/labels.h"

namespace gonio::reassembly {

using Tone = std::array<float, 3>;

// Colours of a picture with R, G, B or Y (thrice the same); pixels of the picture that is kept by reference.
class Tones {
 public:
  Tones() = default;
  // Error(data) at `place` where it has neither, or is not of width x height (0: any).
  Tones(const io::Image& picture, const char* place, int width = 0, int height = 0);
  Tone operator()(std::size_t pixel) const {
    const float* at = data_ + pixel * stride_;
    return {at[channel_[0]], at[channel_[1]], at[channel_[2]]};
  }
  bool known() const { return data_ != nullptr; }
  Tone mean() const;  // of the finite ones

 private:
  const float* data_ = nullptr;
  std::size_t stride_ = 0, pixels_ = 0;
  std::array<std::size_t, 3> channel_{};
};

// One colour of a label; a label may have several (a printed can).
struct LabelColour {
  Tone albedo;
  float spread = 0;
  std::int32_t label = 0;
};

struct Evidence {
  int width = 0, height = 0, labels = 0;
  std::vector<float> log;  // pixels x labels; the greatest of a pixel is 0, none is below `least`
  static constexpr float least = -12;
  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  float* of(std::size_t pixel) { return log.data() + pixel * static_cast<std::size_t>(labels); }
  const float* of(std::size_t pixel) const { return log.data() + pixel * static_cast<std::size_t>(labels); }
  std::int32_t best(std::size_t pixel) const;
};
Evidence evidence_of(const io::Image& picture, const std::vector<std::uint8_t>& clipped, const LabelWish& wish,
                     std::span<const LabelColour> colours, std::int32_t labels);

// A pixel on a border is a mixture of both sides, and looks like a third material where there is one between them: it
// gets the evidence of the side from which it has more.
void unmix(Evidence& evidence, const io::Image& picture, const LabelWish& wish);

// Clusters of the pixels that `counts` (empty: all); the work behind find_materials.
std::vector<Material> cluster(std::span<const LitPicture> pictures, int most,
                              const std::vector<std::uint8_t>& counts = {});

}  // namespace gonio::reassembly
