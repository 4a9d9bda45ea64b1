// The last few shadings of every image: fits ask for one state several times over, and change what does not reach the
// shading (albedos, intensities, gains, the camera's chain) far more often than what does. Safe for several threads.
#pragma once
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "relighting/scene_state.h"
#include "relighting/shading.h"
#include "relighting/term.h"

namespace gonio::relighting {

struct Shaded {
  Shading plain;                   // of the surfaces and lamps alone
  std::optional<Shading> changed;  // by terms that shade, where one is in play
  const Shading& whole() const { return changed ? *changed : plain; }
};

// Every number of an edited state on which its shading depends. Without a term that shades that leaves out what scales
// light; with one, nothing but the numbers of terms that act later.
std::vector<double> shading_key(const SceneState& edited, std::span<const Use> uses);

// Every number of a surface; `any_albedo`: without the albedo, where all it does is scale the base.
void append_key(std::vector<double>& key, const SurfaceState& surface, bool any_albedo = false);
bool same_bits(const std::vector<double>& a, const std::vector<double>& b);  // a NaN equals itself

class ShadingMemo {
 public:
  explicit ShadingMemo(std::size_t images) : of_image_(images) {}
  // Null where it is not among the last few.
  std::shared_ptr<const Shaded> find(std::size_t image, const std::vector<double>& key,
                                     std::span<const std::uint32_t> picked) const;
  void keep(std::size_t image, std::vector<double> key, std::span<const std::uint32_t> picked,
            std::shared_ptr<const Shaded> shaded);

 private:
  struct Entry {
    std::vector<double> key;
    std::vector<std::uint32_t> picked;
    std::shared_ptr<const Shaded> shaded;
  };
  std::vector<std::vector<Entry>> of_image_;  // the last one first
  mutable std::mutex mutex_;
};

}  // namespace gonio::relighting
