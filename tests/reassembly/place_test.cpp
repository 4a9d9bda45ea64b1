// Where pieces stand, in simulated layouts with truth (marker_worlds.h). Here few; the whole with
//   GONIO_LAYOUTS=500 test_reassembly --gtest_filter='Place.RandomLayouts'   (GONIO_LAYOUT_SEED=501: the first seed)
#include "reassembly/place.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>

#include "base/parallel.h"
#include "linear/geom_matrices.h"
#include "linear/solve.h"
#include "reassembly/marker_worlds.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::reassembly {
namespace {

using tests::Clutter;
using tests::MarkerWorld;
using tests::SeenAs;
using tests::WorldWish;

std::uint64_t number_from(const char* name, std::uint64_t otherwise) {
  const char* asked = std::getenv(name);
  return asked ? std::strtoull(asked, nullptr, 10) : otherwise;
}

// Small motion from truth to answer at the centroid, squared by the stated covariance: chi-square of 6.
double pose_square(const Placed& p, const tests::WorldFromObject& truth) {
  const Quaternion turn = normalized(p.world_from_object.rotation * conjugate(truth.rotation));
  const Vec3 rotation = rotation_vector_of(turn);
  const Vec3 at = inverse(p.world_from_object) * p.centroid_m, shift = p.centroid_m - truth * at;
  Eigen::Matrix<double, 6, 1> d;
  d << rotation.x, rotation.y, rotation.z, shift.x, shift.y, shift.z;
  const Eigen::MatrixXd c = Eigen::Map<const Eigen::Matrix<double, 6, 6>>(p.covariance.data());
  return d.dot(linear::Ldlt(c).solve(Eigen::VectorXd(d)));
}

double largest_miss(const Placed& p, const tests::WorldFromObject& truth, const std::vector<Vec3>& centres) {
  double worst = 0;
  for (const Vec3 c : centres) worst = std::max(worst, norm(p.world_from_object * c - truth * c));
  return worst;
}

// Pairs whose bundle shows, in most of its sightings, another marker.
std::size_t wrong_pairs(const MarkerWorld& w, const Bundles& b, const Placed& p, std::size_t piece) {
  std::size_t wrong = 0;
  for (const Pair& pair : p.pairs) {
    std::size_t right = 0;
    const auto& sightings = b.found[pair.bundle].sightings;
    for (const Sighting& s : sightings) {
      const tests::Origin& o = w.origins[s.view][s.outline];
      right += (o.how == SeenAs::directly || o.how == SeenAs::refracted) && o.piece == piece && o.marker == pair.marker;
    }
    wrong += 2 * right < sightings.size();
  }
  return wrong;
}

struct Tally {
  int pieces = 0, unique = 0, right = 0, wrong = 0, refused = 0, covered = 0, unique_refused = 0, wrong_pair = 0;
  int apparent = 0;  // placed by what was seen through glass alone: nothing in the pictures tells
  std::map<Verdict, int> verdicts;
  double distance2 = 0, expected2 = 0, slowest_s = 0;
  int pairs = 0;
  std::vector<double> squares;
  std::array<long, 4> outlines{};  // by SeenAs
};
const char* name_of(Verdict v) {
  constexpr std::array names{"placed", "ambiguous", "mirrored", "scaled", "poor", "lost"};
  return names[static_cast<std::size_t>(v)];
}

void judge_world(std::uint64_t seed, Tally& t, bool speak) {
  const WorldWish wish = tests::random_wish(seed);
  const MarkerWorld w = make_world(wish, seed);
  for (const auto& view : w.origins)
    for (const tests::Origin& o : view) ++t.outlines[static_cast<std::size_t>(o.how)];
  const auto start = std::clock();
  const Bundles b = bundles(w.views, w.wish);
  const auto middle = std::clock();
  const Placement out = place(w.views, b, w.pieces, w.wish);
  const double s1 = static_cast<double>(middle - start) / CLOCKS_PER_SEC,
               s2 = static_cast<double>(std::clock() - middle) / CLOCKS_PER_SEC;
  t.slowest_s = std::max(t.slowest_s, s1 + s2);
  if (speak && s1 + s2 > 1)
    std::printf("seed %llu: %.2f s bundles, %.2f s place\n", static_cast<unsigned long long>(seed), s1, s2);
  for (std::size_t p = 0; p < w.pieces.size(); ++p) {
    const Placed& placed = out.pieces[p];
    const tests::Unique unique = unique_layout(w, p, 5e-4);
    const bool only = unique.only && unique.seen >= 4;
    ++t.pieces;
    t.unique += only;
    ++t.verdicts[placed.verdict];
    if (placed.verdict != Verdict::placed) {
      ++t.refused;
      t.unique_refused += only;
      if ((only || placed.verdict == Verdict::mirrored) && speak)
        std::printf("seed %llu piece %zu: %s though %zu of %zu seen (%zu views, clutter %d): %s\n",
                    static_cast<unsigned long long>(seed), p, name_of(placed.verdict), unique.seen,
                    w.pieces[p].markers.size(), w.views.size(), static_cast<int>(wish.clutter), placed.why.c_str());
      continue;
    }
    const double square = pose_square(placed, w.truth[p]), miss = largest_miss(placed, w.truth[p], w.centres[p]);
    const std::size_t mixed = wrong_pairs(w, b, placed, p);
    if (unique.seen < 3 && mixed == 0) {
      ++t.apparent;
      continue;
    }
    const bool bad = miss > 2e-3 && square > 100;
    t.right += only && !bad;
    t.wrong += bad;
    t.wrong_pair += mixed > 0;
    t.covered += square < stats::chi2_quantile(0.95, 6);
    t.squares.push_back(square);
    for (const Pair& pair : placed.pairs) {
      t.distance2 += pair.residual_m * pair.residual_m;
      t.expected2 += pair.expected_m * pair.expected_m;
      ++t.pairs;
    }
    if (speak && (bad || mixed > 0 || square > 30))
      std::printf(
          "seed %llu piece %zu: %s%zu wrong pairs of %zu, off by %.3f mm, square %.1f, chi2 %.1f/%d (%zu views, "
          "clutter %d, seen %zu%s)\n",
          static_cast<unsigned long long>(seed), p, bad ? "WRONG " : "", mixed, placed.pairs.size(), 1e3 * miss, square,
          placed.chi_square, placed.degrees, w.views.size(), static_cast<int>(wish.clutter), unique.seen,
          unique.only ? ", unique" : "");
  }
}

TEST(Place, RandomLayouts) {
  const std::uint64_t count = number_from("GONIO_LAYOUTS", 16), first = number_from("GONIO_LAYOUT_SEED", 1);
  const bool speak = count > 16;
  Tally t;
  for (std::uint64_t seed = first; seed < first + count; ++seed) judge_world(seed, t, speak);
  const int placed = t.verdicts[Verdict::placed] - t.apparent;
  const auto interval = stats::share_interval(t.covered, std::max(1, placed));
  std::printf(
      "%d pieces: %d unique, %d of them right, %d refused; %d wrong; with a wrong pair %d; through glass alone %d\n",
      t.pieces, t.unique, t.right, t.unique_refused, t.wrong, t.wrong_pair, t.apparent);
  for (const auto& [v, n] : t.verdicts) std::printf("  %s %d\n", name_of(v), n);
  std::printf("95 %% pose intervals cover %.1f %% (%.1f to %.1f), median square %.2f (5.35)\n",
              100.0 * t.covered / placed, 100 * interval.lower, 100 * interval.upper, stats::median(t.squares));
  std::printf("distance rms %.1f um, expected %.1f um; slowest %.2f s\n", 1e6 * std::sqrt(t.distance2 / t.pairs),
              1e6 * std::sqrt(t.expected2 / t.pairs), t.slowest_s);
  std::printf("outlines: %ld direct, %ld refracted, %ld reflected, %ld false\n", t.outlines[0], t.outlines[1],
              t.outlines[2], t.outlines[3]);
  EXPECT_EQ(t.wrong, 0);
  EXPECT_GE(t.right, 0.99 * t.unique - 1);
  EXPECT_GT(t.unique, t.pieces / 2);
}

// A piece that is not there, and cameras that are not where they are said to be: refused, and not by trying everything.
TEST(Place, NonsenseIsRefused) {
  double slowest = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    WorldWish wish;
    wish.views = seed % 2 ? 3 : 8;
    wish.pieces = 2;
    wish.markers = 12;
    wish.missing = wish.falsely = 0.3;
    wish.radius_known = seed % 3 != 0;
    MarkerWorld w = make_world(wish, seed);
    if (seed < 4)
      w.pieces = make_world(wish, seed + 100).pieces;
    else
      for (View& v : w.views)
        v.world_from_camera = {conjugate(v.world_from_camera.rotation), v.world_from_camera.translation_m * -1};
    const auto start = std::clock();
    const Placement out = place(w.views, bundles(w.views, w.wish), w.pieces, w.wish);
    slowest = std::max(slowest, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    for (const Placed& p : out.pieces) {
      EXPECT_TRUE(p.verdict == Verdict::lost || p.verdict == Verdict::poor) << seed << ": " << p.why;
      EXPECT_FALSE(p.why.empty());
    }
  }
  std::printf("nonsense is refused within %.2f s\n", slowest);
}

// As many views and outlines as a session has; what it costs is printed, not judged.
TEST(Place, FortyViews) {
  WorldWish wish;
  wish.views = number_from("GONIO_LAYOUTS", 0) > 0 ? 40 : 12;
  wish.pieces = 3;
  wish.markers = 14;
  wish.missing = wish.falsely = 0.3;
  wish.camera_m = wish.camera_rad = 5e-5;
  const MarkerWorld w = make_world(wish, 2);
  const auto start = std::clock();
  const Bundles b = bundles(w.views, w.wish);
  const auto middle = std::clock();
  const Placement out = place(w.views, b, w.pieces, w.wish);
  std::printf("%zu views, %zu bundles: %.2f s; place %.2f s\n", w.views.size(), b.found.size(),
              static_cast<double>(middle - start) / CLOCKS_PER_SEC,
              static_cast<double>(std::clock() - middle) / CLOCKS_PER_SEC);
  for (std::size_t p = 0; p < 3; ++p) {
    ASSERT_EQ(out.pieces[p].verdict, Verdict::placed) << out.pieces[p].why;
    EXPECT_EQ(wrong_pairs(w, b, out.pieces[p], p), 0u);
    EXPECT_LT(pose_square(out.pieces[p], w.truth[p]), stats::chi2_quantile(1 - 1e-4, 6));
  }
}

}  // namespace
}  // namespace gonio::reassembly
