// What look() says of volumes whose noise, edges and artefacts are known, because a simulator or a formula made them;
// and of recordings, against figures of others.
#include "volume/look.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "ct/scanner.h"
#include "data.h"
#include "volume/look_parts.h"

namespace gonio::volume {
namespace {

io::VolumeData empty_volume(std::size_t n, std::size_t slices = 0) {
  io::VolumeData v;
  v.head.size = {n, n, slices > 0 ? slices : n};
  v.head.type = io::VoxelType::f32;
  v.values.assign(v.head.voxels(), 0.f);
  return v;
}

// A ball of value 100 whose edge is smeared by `sd` voxels, and white noise.
io::VolumeData ball_volume(std::size_t n, double radius, double sd, double noise, std::uint64_t seed) {
  io::VolumeData v = empty_volume(n);
  Random random(seed);
  const double c = (static_cast<double>(n) - 1) / 2 + 0.21;
  for (std::size_t k = 0, at = 0; k < n; ++k)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i, ++at) {
        const double x = static_cast<double>(i) - c, y = static_cast<double>(j) - c, z = static_cast<double>(k) - c;
        const double out = std::sqrt(x * x + y * y + z * z) - radius;
        v.values[at] = static_cast<float>(50 * std::erfc(out / sd / std::sqrt(2.0)) + noise * random.normal());
      }
  return v;
}

void add_noise(io::VolumeData& v, double sd, std::uint64_t seed) {
  Random random(seed);
  for (float& x : v.values) x += static_cast<float>(sd * random.normal());
}

Look looked(io::VolumeData v) {
  return look(*io::source_of(std::move(v)));
}

ct::Scanner scanner(std::size_t voxels, std::size_t slices, ct::Imperfections imperfections = {}) {
  ct::Scanner s;
  s.voxels = voxels, s.slices = slices, s.imperfections = std::move(imperfections);
  return s;
}

TEST(Histogram, CodesOfEightBitsHaveABinEachAndOthersWholeNumbersOfCodes) {
  io::VolumeData v = empty_volume(4, 1);
  v.head.type = io::VoxelType::u8;
  v.values = {0, 0, 0, 0, 255, 255, 7, 7, 7, 1, 2, 3, 4, 5, 6, 8};
  const Histogram h = histogram(*io::source_of(v));
  ASSERT_EQ(h.counts.size(), 256u);
  EXPECT_EQ(h.counts[0], 4u);
  EXPECT_EQ(h.counts[7], 3u);
  EXPECT_EQ(h.counts[255], 2u);
  EXPECT_EQ(h.low, -0.5);
  EXPECT_EQ(h.high, 255.5);
  EXPECT_EQ(h.smallest, 0);
  EXPECT_EQ(h.largest, 255);
  v.head.type = io::VoxelType::u16;
  for (std::size_t k = 0; k < 16; ++k) v.values[k] = static_cast<float>(100 * k);
  const Histogram wide = histogram(*io::source_of(v), 500);  // 1501 codes: four a bin
  EXPECT_EQ(wide.counts.size(), 376u);
  EXPECT_EQ((wide.high - wide.low) / 376, 4);
}

// Normal heaps of known places, widths and shares with a mixed component between them: means within 4 standard errors
// would fail once in 16,000; shares within 0.01.
TEST(Mixture, FindsWhatAHistogramWasMadeOf) {
  Histogram h;
  h.low = -50, h.high = 250, h.counts.assign(1000, 0), h.smallest = -50, h.largest = 250;
  Random random(11);
  const auto add = [&](double value) {
    const double bin = (value + 50) / 0.3;
    if (bin >= 0 && bin < 1000) ++h.counts[static_cast<std::size_t>(bin)];
  };
  for (int k = 0; k < 600'000; ++k) add(0.5 + 6 * random.normal());
  for (int k = 0; k < 200'000; ++k) add(90 + 9 * random.normal());
  for (int k = 0; k < 40'000; ++k) add(180 + 5 * random.normal());
  for (int k = 0; k < 60'000; ++k) add(random.uniform(0.5, 90) + 6 * random.normal());
  const Mixture m = materials(h);
  ASSERT_EQ(m.materials.size(), 3u);
  EXPECT_NEAR(m.materials[0].mean, 0.5, 0.1);
  EXPECT_NEAR(m.materials[0].sd, 6, 0.15);
  EXPECT_NEAR(m.materials[1].mean, 90, 0.3);
  EXPECT_NEAR(m.materials[1].sd, 9, 0.3);
  EXPECT_NEAR(m.materials[2].mean, 180, 0.3);
  EXPECT_NEAR(m.materials[2].sd, 5, 0.2);
  EXPECT_NEAR(m.materials[0].share, 2 / 3.0, 0.01);
  EXPECT_NEAR(m.partial_share, 0.0667, 0.01);
  EXPECT_EQ(materials(h, 2).materials.size(), 2u);
}

// A slope within one material (cupping) is not two materials.
TEST(Mixture, ACupIsNotASecondMaterial) {
  Histogram h;
  h.low = -50, h.high = 200, h.counts.assign(1000, 0);
  Random random(12);
  for (int k = 0; k < 300'000; ++k) ++h.counts[static_cast<std::size_t>((50 + 5 * random.normal()) * 4)];
  for (int k = 0; k < 200'000; ++k)
    ++h.counts[static_cast<std::size_t>((50 + 100 * (1 + 0.15 * random.uniform()) + 5 * random.normal()) * 4)];
  EXPECT_EQ(materials(h).materials.size(), 2u);
}

// A top hat is two narrow heaps with what lies between them, to a mixture that knows no better.
TEST(Mixture, NoiseThatIsSpreadEvenlyIsOneMaterial) {
  Histogram h;
  h.low = 19850, h.high = 40150, h.counts.assign(4060, 0);
  Random random(13);
  const auto add = [&](double value) { ++h.counts[static_cast<std::size_t>((value - 19850) / 5)]; };
  for (int k = 0; k < 2'000'000; ++k) add(20000 + 300 * (random.uniform() - 0.5));
  for (int k = 0; k < 15'000; ++k) add(39770 + 300 * (random.uniform() - 0.5));
  for (int k = 0; k < 15'000; ++k) add(random.uniform(20000, 39800));
  const Mixture m = materials(h);
  ASSERT_EQ(m.materials.size(), 2u);
  EXPECT_NEAR(m.materials[0].mean, 20000, 10);
  EXPECT_NEAR(m.materials[1].mean, 39770, 60);
}

TEST(Mixture, OneValueIsSaidToBeOne) {
  const io::VolumeData v = empty_volume(8);
  const Look l = looked(v);
  EXPECT_EQ(l.mixture.materials.size(), 1u);
  EXPECT_EQ(l.noise_air, 0);
  EXPECT_THROW(materials(l.histogram, 2), Error);
}

// Rows are worked on many samples at a time: against every voxel's own neighbours, sizes that fill no register.
TEST(LookParts, MeansAndErosionAreWhatEveryVoxelsNeighboursSay) {
  Random random(14);
  Slab slab{21, 13, 0, 9, 2, {}};
  const std::size_t depth = slab.count + 2 * slab.margin, w = slab.width, h = slab.height;
  slab.values.resize(w * h * depth);
  Flags flags(slab.values.size());
  for (float& v : slab.values) v = static_cast<float>(random.uniform(-1, 1));
  for (auto& f : flags) f = random.uniform() < 0.97;
  const std::vector<float> means = box_means(slab);
  const auto held = [](std::ptrdiff_t x, std::size_t n) {
    return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(x, 0, static_cast<std::ptrdiff_t>(n) - 1));
  };
  const auto around = [&](std::size_t at, std::ptrdiff_t r, const auto& body) {
    const auto i = static_cast<std::ptrdiff_t>(at % w), j = static_cast<std::ptrdiff_t>(at / w % h),
               k = static_cast<std::ptrdiff_t>(at / (w * h));
    for (std::ptrdiff_t c = k - r; c <= k + r; ++c)
      for (std::ptrdiff_t b = j - r; b <= j + r; ++b)
        for (std::ptrdiff_t a = i - r; a <= i + r; ++a) {
          const std::size_t near = (held(c, depth) * h + held(b, h)) * w + held(a, w);
          body(near, held(a, w) == static_cast<std::size_t>(a) && held(b, h) == static_cast<std::size_t>(b) &&
                         held(c, depth) == static_cast<std::size_t>(c));
        }
  };
  for (std::size_t at = 0; at < slab.values.size(); ++at) {
    double sum = 0;
    around(at, 1, [&](std::size_t near, bool) { sum += slab.values[near] / 27.0; });
    ASSERT_NEAR(means[at], sum, 1e-6) << at;
  }
  for (const std::ptrdiff_t r : {1, 2, 4}) {
    const Flags left = eroded(slab, flags, static_cast<std::size_t>(r));
    for (std::size_t at = 0; at < flags.size(); ++at) {
      bool all = true;
      around(at, r, [&](std::size_t near, bool inside) { all = all && inside && flags[near] != 0; });
      ASSERT_EQ(left[at] != 0, all) << at << " " << r;
    }
  }
}

TEST(Look, NoiseIsWithinThreePercentOfWhatWasAdded) {
  for (const double sd : {2.0, 9.0}) {
    const Look l = looked(ball_volume(72, 22, 0.8, sd, 5));
    EXPECT_NEAR(l.noise_air, sd, 0.03 * sd);
    EXPECT_NEAR(l.noise_object, sd, 0.03 * sd);
    EXPECT_NEAR(l.noise_correlation, 0, 0.02);
    EXPECT_FALSE(l.cut_by_field);
    EXPECT_LT(l.ring, 0.05);
    EXPECT_LT(l.streak, 0.01);
    EXPECT_NEAR(l.cupping, 0, 0.01);
  }
}

// Photon noise of a scan, in air: against the difference from the same scan without noise, over the same voxels.
TEST(Look, NoiseOfAScanIsThatOfItsPhotons) {
  ct::Scanner s = scanner(72, 40);
  const ct::Phantom p = ct::hollow_sphere({72, s.voxel_m}, 6);
  const io::VolumeData clean = ct::scan(p, s);
  s.photons = 20000;
  io::VolumeData noisy = ct::scan(p, s);
  std::vector<double> rest;
  for (std::size_t v = 0; v < noisy.values.size(); ++v)
    if (clean.values[v] != 0 && std::abs(clean.values[v]) < 5) rest.push_back(noisy.values[v] - clean.values[v]);
  const double truth = robust_sd(rest);
  const Look l = looked(std::move(noisy));
  EXPECT_NEAR(l.noise_air, truth, 0.03 * truth);
}

// Eight bits: noise narrower than a code, as rounded to codes.
TEST(Look, NoiseOfEightBitsIsThatOfTheCodes) {
  io::VolumeData v = ball_volume(64, 20, 0.8, 1.5, 9);
  for (float& x : v.values) x += 40;
  const Look l = looked(ct::stored_as(v, io::VoxelType::u8, 1, 0));
  EXPECT_NEAR(l.noise_air, std::hypot(1.5, std::sqrt(1 / 12.0)), 0.03 * 1.53);
}

TEST(Look, EdgesAreAsWideAsTheyWereSmeared) {
  for (const auto& [sd, noise] : {std::pair{0.7, 0.0}, {1.0, 3.0}, {1.5, 3.0}}) {
    const Look l = looked(ball_volume(64, 21, sd, noise, 3));
    ASSERT_TRUE(l.edge_width_voxels);
    EXPECT_NEAR(*l.edge_width_voxels, 2.5631 * sd, 0.05 * 2.5631 * sd) << sd;
    EXPECT_LT(*l.sigma_edge_width, 0.03);
  }
}

// Near the rim of a disk and far inside it, as Abel's inversion has them (the simulator's own test holds it to them):
// here from the noise-free volume by true depths.
TEST(Look, CuppingIsThatOfTheMaterialByDepth) {
  ct::Scanner s = scanner(96, 80);
  const ct::Phantom p = ct::glass_block({96, s.voxel_m});
  io::VolumeData v = ct::scan(p, s);
  double rim = 0, rims = 0, deep = 0, deeps = 0, deepest = 0;
  std::vector<double> depth(v.values.size());
  for (std::size_t k = 0, at = 0; k < 80; ++k)
    for (std::size_t j = 0; j < 96; ++j)
      for (std::size_t i = 0; i < 96; ++i, ++at) {
        depth[at] = -p.distance_m(ct::place_of(s, double(i), double(j), double(k))) / s.voxel_m;
        deepest = std::max(deepest, depth[at]);
      }
  for (std::size_t at = 0; at < depth.size(); ++at) {
    if (depth[at] >= 3 && depth[at] < 5) rim += v.values[at], ++rims;
    if (depth[at] >= 0.9 * deepest) deep += v.values[at], ++deeps;
  }
  add_noise(v, 3, 8);
  const Look l = looked(std::move(v));
  const Sides sides = sides_of(l.mixture);
  const double truth = (rim / rims - deep / deeps) / sides.step();
  EXPECT_GT(truth, 0.05);
  EXPECT_NEAR(l.cupping, truth, 0.1 * truth);
}

TEST(Look, RingsGrowWithTheDetectorsGainsAndAreNoneWithout) {
  const ct::Phantom p = ct::glass_block({80, 1e-4});
  double last = -1;
  for (const double gain : {0.0, 0.002, 0.006}) {
    ct::Scanner s = scanner(80, 24, {{"ring", gain}});
    s.photons = 20000;
    const Look l = looked(ct::scan(p, s));
    EXPECT_LT(gain == 0 ? l.ring : 0, 0.12);
    EXPECT_GT(l.ring, last + 0.1 * (gain > 0)) << gain;
    last = l.ring;
  }
}

TEST(Look, StreaksGrowWithTheDetectorsFloorAndAreNoneWithout) {
  // Two dense balls in a ring of glass: photons starve along the line through both.
  const auto at = [](double x, double y) { return Vec3{x, y, 0} * 1e-4; };
  const ct::Phantom p{"pins",
                      {{"pins",
                        ct::united({ct::cylinder(at(-22, 3) - Vec3{0, 0, 1}, at(-22, 3) + Vec3{0, 0, 1}, 5e-4),
                                    ct::cylinder(at(21, -4) - Vec3{0, 0, 1}, at(21, -4) + Vec3{0, 0, 1}, 5e-4)}),
                        ct::iron()}},
                      {}};
  double last = -1;
  for (const double floor : {0.0, 0.03, 0.1}) {
    ct::Scanner s = scanner(80, 16, {{"streak", floor}, {"beam-hardening", 0}});
    s.spectrum = ct::mono(40);
    io::VolumeData v = ct::scan(p, s);
    add_noise(v, 60, 3);
    const Look l = looked(std::move(v));
    EXPECT_LT(floor == 0 ? l.streak : 0, 0.012);
    EXPECT_GT(l.streak, last + 0.003 * (floor > 0)) << floor;
    last = l.streak;
  }
}

TEST(Look, AnObjectThatLeavesTheVolumeIsSaidToBeCut) {
  io::VolumeData v = ball_volume(48, 18, 0.8, 2, 3);
  EXPECT_FALSE(looked(v).cut_by_field);
  io::VolumeData cut = empty_volume(48, 24);
  std::copy_n(v.values.begin() + 48 * 48 * 24, cut.values.size(), cut.values.begin());
  const Look l = looked(cut);
  EXPECT_TRUE(l.cut_by_field);
  EXPECT_NEAR(static_cast<double>(l.cut_voxels), pi * 18 * 18, 0.12 * pi * 18 * 18);
  // Beyond the scanner's circle.
  const ct::Scanner s = scanner(64, 12);
  const ct::Phantom wide{"wide", {{"wide", ct::cylinder({1.5e-3, 0, -1}, {1.5e-3, 0, 1}, 2.2e-3), ct::glass()}}, {}};
  EXPECT_TRUE(looked(ct::scan(wide, s)).cut_by_field);
}

TEST(Look, RecordingsAreLikeOthersSaw) {
  GONIO_NEEDS_DATA("ct/engine_block");
  GONIO_NEEDS_DATA("ct/tooth");
  const Look engine = look(*io::open_volume(tests::data("ct/engine_block/engine.nrrd")));
  EXPECT_EQ(std::floor(engine.otsu), 71);  // skimage: values above 71
  ASSERT_GE(engine.mixture.materials.size(), 2u);
  EXPECT_NEAR(engine.mixture.materials[engine.object].mean, 142, 3);  // the heap of the cast metal
  EXPECT_TRUE(engine.cut_by_field);                                   // the block stands on the first slice
  ASSERT_TRUE(engine.edge_width_voxels);
  EXPECT_GT(*engine.edge_width_voxels, 1);
  EXPECT_LT(*engine.edge_width_voxels, 4);
  const Look tooth = look(*io::open_volume(tests::data("ct/tooth/tooth.nrrd")));
  EXPECT_EQ(std::floor(tooth.otsu), 128);
  ASSERT_GE(tooth.mixture.materials.size(), 3u);  // air, dentine, enamel, and what lies beyond the circle
  EXPECT_GT(tooth.mixture.materials[tooth.air].share, 0.5);
}

TEST(Look, ARecordedPotIsFoundAmongItsTableAndSpecks) {
  GONIO_NEEDS_DATA("ct/boston_teapot_atlas.png");
  const Look pot = look(*io::open_volume(tests::data("ct/boston_teapot_atlas.png"), {.tiles = {{16, 16}}}));
  EXPECT_NEAR(pot.otsu, 40.5, 1);  // the data folder's threshold is 40
  EXPECT_NEAR(pot.mixture.materials[pot.object].mean, 112, 5);
  EXPECT_FALSE(pot.cut_by_field);
}

}  // namespace
}  // namespace gonio::volume
