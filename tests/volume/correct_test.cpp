// Corrections on simulated volumes whose artefacts are known, and what they do to edges.
#include "volume/correct.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "ct/scanner.h"
#include "volume/look.h"
#include "volume/look_parts.h"

namespace gonio::volume {
namespace {

ct::Scanner slices_of(std::size_t voxels, std::size_t slices, ct::Imperfections imperfections = {}) {
  ct::Scanner s;
  s.voxels = voxels, s.slices = slices, s.imperfections = std::move(imperfections);
  return s;
}

io::VolumeData all_of(io::VolumeSource& source) {
  io::VolumeData v;
  v.head = source.head();
  v.values.resize(v.head.voxels());
  source.read(0, v.head.size[2], v.values);
  return v;
}

TEST(Cupping, APolynomialIsFoundAgain) {
  io::VolumeData v;
  v.head.size = {40, 44, 36};
  v.head.type = io::VoxelType::f32;
  for (std::size_t k = 0; k < 36; ++k)
    for (std::size_t j = 0; j < 44; ++j)
      for (std::size_t i = 0; i < 40; ++i) {
        const double x = 2 * double(i) / 39 - 1, y = 2 * double(j) / 43 - 1, z = 2 * double(k) / 35 - 1;
        const bool inside = i > 3 && i < 36 && j > 3 && j < 40 && k > 3 && k < 32;
        v.values.push_back(static_cast<float>(10 + (inside ? 90 * (0.95 + 0.1 * x * x + 0.05 * y - 0.04 * x * z) : 0)));
      }
  const auto source = io::source_of(v);
  const CuppingField field = fit_cupping(*source, 10, 100, 2);
  const auto truth = [](double x, double y, double z) { return 0.95 + 0.1 * x * x + 0.05 * y - 0.04 * x * z; };
  const double scale = field.at(v.head.size, 19.5, 21.5, 17.5) / truth(0, 0, 0);
  for (const std::size_t i : {8u, 20u, 31u})
    EXPECT_NEAR(field.at(v.head.size, double(i), 30, 12),
                scale * truth(2 * double(i) / 39 - 1, 60 / 43. - 1, 24 / 35. - 1), 1e-4);
  EXPECT_LT(field.after, 0.02 * field.before);
  EXPECT_GE(field.at(v.head.size, 0, 0, 0), field.lowest);  // it does not run away outside
  EXPECT_LE(field.at(v.head.size, 39, 43, 35), field.highest);
}

TEST(Cupping, OfAGlassBlockIsLessThanAFifthAfterwards) {
  ct::Scanner s = slices_of(96, 72);
  io::VolumeData v = ct::scan(ct::glass_block({96, s.voxel_m}), s);
  Random random(4);
  for (float& x : v.values) x += static_cast<float>(3 * random.normal());
  const auto source = io::source_of(v);
  const Look before = look(*source);
  const Sides sides = sides_of(before.mixture);
  const CuppingField field = fit_cupping(*source, sides.air, sides.object);
  CorrectWish wish;
  wish.cupping = &field;
  const auto flat = corrected(*source, wish);
  const Look after = look(*flat);
  EXPECT_GT(before.cupping, 0.05);
  EXPECT_LT(std::abs(after.cupping), before.cupping / 5);
  EXPECT_LT(field.after, field.before / 5);
  EXPECT_NEAR(after.mixture.materials.back().mean, before.mixture.materials.back().mean, 0.02 * sides.step());
  const EdgeChange change = edge_change(*source, *flat, sides.air, sides.object, 3);
  EXPECT_GT(change.edges, 100u);
  EXPECT_LT(std::abs(change.mean_shift_voxels), 0.1);
}

TEST(Rings, AreAThirdAtMostAfterwardsAndEdgesStay) {
  ct::Scanner s = slices_of(96, 20, {{"ring", 0.006}, {"blur", 0.5}});
  s.photons = 40000;
  // A tube that nearly stands round the axis: its walls must not be taken for rings.
  const ct::Phantom p = ct::glass_tube({96, s.voxel_m}, 12);
  const io::VolumeData v = ct::scan(p, s);
  const auto source = io::source_of(v);
  const Look before = look(*source);
  const Sides sides = sides_of(before.mixture);
  RingWish rings{.centre_i = 47.5, .centre_j = 47.5, .threshold = sides.half()};
  CorrectWish wish;
  wish.rings = &rings;
  const auto clean = corrected(*source, wish);
  const Look after = look(*clean);
  EXPECT_GT(before.ring, 0.3);
  EXPECT_LT(after.ring * after.noise_air, before.ring * before.noise_air / 3);
  EXPECT_LT(after.noise_air, before.noise_air);
  const EdgeChange change = edge_change(*source, *clean, sides.air, sides.object, before.noise_air);
  EXPECT_GT(change.edges, 50u);
  EXPECT_LT(std::abs(change.mean_shift_voxels), 0.05);
  EXPECT_LT(change.rms_shift_voxels, 0.1);
  // Without rings there is nothing to take off but noise.
  s.imperfections.erase("ring");
  const auto none = io::source_of(ct::scan(p, s));
  const Look bare = look(*none), still = look(*corrected(*none, wish));
  EXPECT_NEAR(still.noise_air, bare.noise_air, 0.06 * bare.noise_air);
}

class Denoising : public testing::TestWithParam<Denoise> {};

TEST_P(Denoising, TakesNoiseAndLeavesEdges) {
  ct::Scanner s = slices_of(64, 40, {{"blur", 0.6}});
  s.photons = 15000;
  const auto source = io::source_of(ct::scan(ct::hollow_sphere({64, s.voxel_m}, 9), s));
  const Look before = look(*source);
  const Sides sides = sides_of(before.mixture);
  CorrectWish wish;
  wish.denoise = GetParam(), wish.noise = before.noise_air;
  const auto smooth = corrected(*source, wish);
  const io::VolumeData whole = all_of(*smooth);
  const auto again = io::source_of(whole);
  const Look after = look(*again);
  EXPECT_LT(after.noise_air, 0.6 * before.noise_air);
  const EdgeChange change = edge_change(*source, *again, sides.air, sides.object, before.noise_air);
  std::printf("  noise %.2f -> %.2f, %zu edges: width %.3f -> %.3f, shift %.4f +- %.4f, rms %.3f\n", before.noise_air,
              after.noise_air, change.edges, change.width_before_voxels, change.width_after_voxels,
              change.mean_shift_voxels, change.sigma_mean_shift, change.rms_shift_voxels);
  EXPECT_GT(change.edges, 100u);
  EXPECT_LT(std::abs(change.mean_shift_voxels), 0.05);
  EXPECT_NEAR(change.width_after_voxels, change.width_before_voxels, 0.15 * change.width_before_voxels);
  // Read slice by slice it is the same volume.
  const auto slowly = corrected(*source, wish);
  std::vector<float> slice(64 * 64);
  for (const std::size_t k : {0u, 15u, 16u, 17u, 39u}) {
    slowly->read(k, 1, slice);
    for (std::size_t v = 0; v < slice.size(); v += 7) ASSERT_EQ(slice[v], whole.values[k * slice.size() + v]) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Both, Denoising, testing::Values(Denoise::anisotropic, Denoise::non_local),
                         [](const auto& info) {
                           return info.param == Denoise::non_local ? "NonLocal" : "Anisotropic";
                         });

// Blocks overlap by as much as a value depends on: a block seen with more around it is the same.
TEST(Correct, BlocksHaveNoSeams) {
  io::VolumeData v;
  v.head.size = {20, 20, 40};
  v.head.type = io::VoxelType::f32;
  Random random(6);
  for (std::size_t k = 0; k < v.head.voxels(); ++k)
    v.values.push_back(static_cast<float>((k / 400 > 18 && k % 20 > 8 ? 100 : 0) + 5 * random.normal()));
  for (const Denoise how : {Denoise::non_local, Denoise::anisotropic}) {
    CorrectWish wish;
    wish.denoise = how, wish.noise = 5;
    const auto source = io::source_of(v);
    const auto smooth = corrected(*source, wish);
    // The middle block (16 .. 31) of a volume shifted by 8 slices lies elsewhere in its blocks.
    io::VolumeData shifted = v;
    shifted.head.size[2] = 32;
    shifted.values.erase(shifted.values.begin(), shifted.values.begin() + 8 * 400);
    const auto other = io::source_of(shifted);
    const auto smooth_shifted = corrected(*other, wish);
    const io::VolumeData a = all_of(*smooth), b = all_of(*smooth_shifted);
    for (std::size_t k = 16; k < 24; ++k)
      for (std::size_t n = 0; n < 400; ++n)
        ASSERT_NEAR(a.values[k * 400 + n], b.values[(k - 8) * 400 + n], how == Denoise::non_local ? 1e-4 : 0.02);
  }
}

TEST(Correct, WithoutAWishNothingChanges) {
  io::VolumeData v;
  v.head.size = {4, 3, 2};
  v.head.type = io::VoxelType::f32;
  for (int k = 0; k < 24; ++k) v.values.push_back(static_cast<float>(k));
  const auto source = io::source_of(v);
  EXPECT_EQ(all_of(*corrected(*source, {})).values, v.values);
  CorrectWish wish;
  wish.denoise = Denoise::non_local;
  EXPECT_THROW(corrected(*source, wish), Error);
  EXPECT_THROW(fit_cupping(*source, 5, 5), Error);
  EXPECT_THROW(fit_cupping(*source, 0, 20), Error);  // too little of it
}

}  // namespace
}  // namespace gonio::volume
