// What half-pixel cells show at one state of the scene, summed over a pixel's square at any place. Places are first
// named (look_at), then all are shaded at once, then summed.
#pragma once
#include <optional>
#include <vector>

#include "relighting/fine_views.h"
#include "relighting/image_model.h"
#include "relighting/shifted_views.h"

namespace gonio::relighting {

class Sight {
 public:
  Sight(const FineView& view, const Places& places, const Frame& frame)
      : view_(view),
        places_(places),
        frame_(frame),
        onward_(frame.model, frame.state, frame.number),
        place_(static_cast<std::size_t>(view.tiles()), -1),
        known_(frame.cache.facets.size()) {}

  void look_at(Vec2 centre);
  void shade();

  struct Sum {
    Rgb radiance;  // before exposure
    double share = 0;
  };
  enum class Which { all, near, far };
  // About `centre`, with the light by way of other surfaces that the sampled pixel number `pixel` of the view has.
  Sum at(Vec2 centre, std::uint32_t pixel, Which which);

 private:
  struct Shaded {
    std::uint64_t wanted = 0;
    const FineTile* tile = nullptr;
    std::vector<Rgb> direct;  // by facet of the tile
  };
  // Of a surface with a white tint.
  Rgb onward(std::uint32_t pixel, std::uint32_t surface);
  Rgb onward_of(std::size_t facet);
  const FineView& view_;
  const Places& places_;
  const Frame& frame_;
  Onward onward_;
  std::vector<Shaded> tiles_;
  std::vector<std::int32_t> place_;        // tile of the view -> place in tiles_, or -1
  std::vector<std::optional<Rgb>> known_;  // by facet of the frame's cache: what it sends on
};

inline constexpr int block_px = 16;  // of Places::nearest
inline int blocks_across(int width_px) {
  return (width_px + block_px - 1) / block_px;
}

}  // namespace gonio::relighting
