// A cloud of the manifest, read; and which of its points are asked. Private to clouds/.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "explain/clouds/clouds_problem.h"
#include "manifest/sections/cloud.h"

namespace gonio::explain {

// Was it placed in the world by what its images say?
bool is_placed(const manifest::Document& document, const std::string& name, const manifest::Cloud& cloud);

// A projector has recorded nothing.
bool is_projector(const manifest::Document& document, const std::string& camera, const std::string& projection);

struct ReadCloud {
  std::vector<scan::ScanPoint> points;  // rig frame
  Rigid<frame::World, frame::Rig> world_from_rig;
  bool placed = false;                          // by its images; else the identity
  std::optional<double> temperature_K, time_s;  // means over its images, where all of them state it
};
ReadCloud read_one(const manifest::Document& document, const std::string& name, const manifest::Cloud& cloud,
                   const scan::Station& first);

// Temperatures where every cloud has one, else times, over the mean of all clouds.
void state_changes(std::span<const ReadCloud> clouds, std::span<CloudView> views);

// Points by the whole pixels that they stand at, those of a camera beside a projector.
class PointsByPixel {
 public:
  explicit PointsByPixel(std::span<const scan::ScanPoint> points);
  std::optional<std::size_t> at(long x, long y) const;
  // What white adds about a point. All zero where a neighbour has no point.
  equation::Neighbours brightness(Vec2 pixel) const;

 private:
  std::span<const scan::ScanPoint> points_;
  std::unordered_map<std::uint64_t, std::size_t> found_;
};

inline constexpr std::size_t tiles_a_side = 6, points_a_tile = 32;
// As many of each tile of the picture, evenly through its points: a part is enough, and a corner counts like the
// middle.
struct Chosen {
  std::size_t point = 0;
  std::uint32_t tile = 0;  // from 0, without gaps
};
std::vector<Chosen> chosen(std::span<const Vec2> pixels, std::size_t each = points_a_tile);

inline constexpr double far_sigmas = 8;  // robust, off the shape: of something else
// Places of the values within that reach of their median.
std::vector<std::size_t> near_median(std::span<const double> values);

}  // namespace gonio::explain
