// Values of air and of the material. See sites.h.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "explain/volumes/sites.h"
#include "stats/intervals.h"

namespace gonio::explain::volumes {
namespace {

constexpr std::size_t fewest = 100;
constexpr int half_box = 5;
constexpr double least_share = 0.02;

// Of boxes round the sites: what they have beyond air, over the share of the shape in them.
std::vector<double> material_of_boxes(const Sampled& sampled, const Body& body, const std::vector<Site>& sites,
                                      double air) {
  std::vector<double> result;
  for (std::size_t s = 0; s < sites.size(); s += std::max<std::size_t>(1, sites.size() / 400)) {
    if (!sampled.within(sites[s].at_m, half_box + 1)) continue;
    const Vec3 index = sampled.index_of(sites[s].at_m);
    const Vec3 middle{std::round(index.x), std::round(index.y), std::round(index.z)};
    double sum = 0, share = 0, count = 0;
    for (int k = -half_box; k <= half_box; ++k)
      for (int j = -half_box; j <= half_box; ++j)
        for (int i = -half_box; i <= half_box; ++i) {
          const Vec3 at =
              sampled.place_of(middle + Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
          sum += sampled.at(at) - air, share += body.at(at), count += 1;
        }
    if (share > least_share * count) result.push_back(air + sum / share);
  }
  return result;
}

}  // namespace

Values values_of(const Sampled& sampled, const Body& body, const std::vector<Site>& sites, const std::string& place) {
  const auto& n = sampled.volume().head.size;
  std::vector<double> inside, outside, differences;
  Random random(1, 0x76616c75);
  for (int k = 0; k < 200000; ++k) {
    const std::array<std::size_t, 3> i{random.below(static_cast<std::uint32_t>(n[0])),
                                       random.below(static_cast<std::uint32_t>(n[1])),
                                       random.below(static_cast<std::uint32_t>(n[2]))};
    if (i[0] + 2 >= n[0]) continue;
    const Vec3 at =
        sampled.place_of({static_cast<double>(i[0]) + 1, static_cast<double>(i[1]), static_cast<double>(i[2])});
    if (!sampled.within(at, 3)) continue;
    double least = 1, most = 0;
    for (const Vec3 way :
         {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
      const double share = body.at(at + way * (3 * sampled.voxel_m()));
      least = std::min(least, share), most = std::max(most, share);
    }
    if (least < 0.999 && most > 0.001) continue;
    const double a = sampled.volume().at(i[0], i[1], i[2]), b = sampled.volume().at(i[0] + 2, i[1], i[2]);
    (most > 0.5 ? inside : outside).push_back(a);
    differences.push_back((a - b) / std::sqrt(2.0));
  }
  if (outside.size() >= fewest && inside.size() < fewest) {
    inside = material_of_boxes(sampled, body, sites, stats::median(outside));
    if (inside.size() < fewest) inside.clear();
  }
  if (inside.size() < fewest || outside.size() < fewest)
    throw Error(Exit::data, place,
                "has " + std::to_string(inside.size()) + " of 200000 voxels in the believed shape and " +
                    std::to_string(outside.size()) + " outside of it (at least " + std::to_string(fewest) + " each)",
                "the shape's pose or unit is another, or its walls are thinner than two voxels");
  const Values values{stats::median(outside), stats::median(inside), stats::robust_sigma(differences)};
  if (!(std::abs(values.material - values.air) > 3 * values.noise))
    throw Error(Exit::data, place,
                "does not show the believed shape: voxels in it and outside of it differ by less than "
                "three widths of the noise",
                "give the object's pose in the volume");
  return values;
}

}  // namespace gonio::explain::volumes
