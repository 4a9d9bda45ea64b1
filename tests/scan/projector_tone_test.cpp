// Projectors that show all above a level alike, or all below one: levels and exponents against those of the simulation,
// places against closed forms before and after. Seeds are fixed.
#include "scan/projector_tone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "scan/scan_world.h"

namespace gonio::scan {
namespace {

using tests::ScanWorld;

constexpr Axis columns[] = {Axis::column};

struct Case {
  double gamma, dark, bright;
};

Codes codes_of(const ScanWorld& w, const Sequence& sequence, bool levels) {
  DecodeRequest r;
  r.sequence = sequence, r.width = w.left.width, r.height = w.left.height, r.levels = levels;
  r.noise = manifest::Noise{w.gain, w.read};
  const tests::Recorder recorder(w, w.left, sequence);
  r.read = [&](std::size_t frame) { return recorder(frame); };
  return decode(r);
}

ScanWorld world_of(const Case& c) {
  ScanWorld w;
  w.gamma = c.gamma, w.dark = c.dark, w.bright = c.bright, w.left.width = 160;
  return w;
}

// Root mean square of errors over their sigmas.
double off_sigmas(const ScanWorld& w, const Codes& codes) {
  double squares = 0, told = 0;
  for (int y = 0; y < codes.height; ++y)
    for (int x = 0; x < codes.width; ++x) {
      const auto truth = tests::lit_by(w, w.left, x, y);
      const auto i = static_cast<std::size_t>(y * codes.width + x);
      if (!codes.told(i) || truth[0] < 2 || truth[0] > w.projector.width - 3) continue;
      squares += std::pow((codes.place[0][i] - truth[0]) / codes.sigma[0][i], 2), ++told;
    }
  EXPECT_GT(told, 0.9 * static_cast<double>(codes.refusal.size()));
  return std::sqrt(squares / told);
}

void expect_level(const std::optional<FlatLevel>& found, double level, double none) {
  ASSERT_EQ(found.has_value(), level != none);
  if (!found) return;
  EXPECT_NEAR(found->level, level, 3 * found->sigma);
  EXPECT_LT(found->sigma, 0.005);
}

TEST(ProjectorTone, LevelsAreFoundAndPhasesStraightened) {
  const double periods[] = {1, 6, 40};
  for (const Case& c : {Case{1, 0, 0.8}, Case{1, 0.2, 1}, Case{2.2, 0, 0.8}})
    for (const int shifts : {5, 9}) {
      const ScanWorld w = world_of(c);
      const Sequence sequence = cosine_sequence(480, 360, columns, periods, shifts);
      const Codes codes = codes_of(w, sequence, true);
      expect_level(codes.below, c.dark, 0), expect_level(codes.above, c.bright, 1);
      EXPECT_NEAR(codes.gamma, c.gamma, 3 * codes.gamma_sigma);
      const double before = off_sigmas(w, codes_of(w, sequence, false)), after = off_sigmas(w, codes);
      EXPECT_LT(after, before + 0.01) << c.gamma << " " << shifts;
      if (shifts > 5) continue;
      EXPECT_GT(before, 1.1) << c.gamma;
      EXPECT_LT(after * after - 1, 0.5 * (before * before - 1)) << c.gamma;
    }
}

// Those with three shifts, whose phases turn most, by what five of another number of periods tell.
TEST(ProjectorTone, ThreeShiftsAreStraightenedByWhatFiveTell) {
  const ScanWorld w = world_of({1, 0, 0.7});
  const double coarse[] = {1, 6}, fine[] = {20};
  Sequence s = cosine_sequence(480, 360, columns, coarse, 5);
  for (const Shown& frame : cosine_sequence(480, 360, columns, fine, 3).frames) s.frames.push_back(frame);
  EXPECT_GT(off_sigmas(w, codes_of(w, s, false)), 1.5);
  EXPECT_LT(off_sigmas(w, codes_of(w, s, true)), 1.15);
}

TEST(ProjectorTone, NothingIsSaidOfALinearOneOrByFewShifts) {
  const double periods[] = {1, 6, 40};
  for (const Case& c : {Case{1, 0, 1}, Case{0.7, 0, 1}, Case{1.5, 0, 1}, Case{2.2, 0, 1}})
    for (const int shifts : {5, 9}) {
      const Codes codes = codes_of(world_of(c), cosine_sequence(480, 360, columns, periods, shifts), true);
      EXPECT_FALSE(codes.below || codes.above) << c.gamma << " " << shifts;
    }
  for (const int shifts : {3, 4}) {
    const Codes codes = codes_of(world_of({1, 0, 0.8}), cosine_sequence(480, 360, columns, periods, shifts), true);
    EXPECT_FALSE(codes.below || codes.above) << shifts;
  }
}

// Closed form, without lenses; over 20 draws levels lie within one standard deviation as often as they should.
TEST(ProjectorTone, LevelsHaveTheErrorsThatTheyState) {
  const ProjectorTone truth{1.3, 0, FlatLevel{0.1, 0}, FlatLevel{0.85, 0}};
  double squares = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> phase(0, 2 * pi), light(0.2, 0.7);
    std::normal_distribution<double> noise(0, 0.01);
    ToneReadings seen;
    for (int k = 0; k < 7; ++k) seen.shifts_rad.push_back(2 * pi * k / 7);
    for (std::uint32_t i = 0; i < 1000; ++i) {
      const double theta = phase(random), white = light(random);
      for (const double s : seen.shifts_rad)
        seen.readings.push_back(
            static_cast<float>(0.05 + white * truth.light(0.5 + 0.5 * std::cos(theta - s)) + noise(random)));
      seen.sigmas.push_back(0.01f), seen.tiles.push_back(i % 64);
    }
    const auto found = flat_tone(seen, std::nullopt);
    ASSERT_TRUE(found && found->below && found->above);
    EXPECT_LT(found->above->sigma, 0.004);
    squares += std::pow((found->above->level - 0.85) / found->above->sigma, 2) +
               std::pow((found->below->level - 0.1) / found->below->sigma, 2);
  }
  EXPECT_NEAR(squares / 40, 1, 0.6);  // 40 squares: 0.22 by chance
}

}  // namespace
}  // namespace gonio::scan
