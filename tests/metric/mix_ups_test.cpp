// Files that belong to other pictures of a set: exchanged, in a cycle, used twice, shifted; and sets of nearly the same
// views with errors of pose and lamp, where nothing may be said.
#include "metric/mix_ups.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "base/random.h"

namespace gonio::metric {
namespace {

constexpr int mix_side = 64;

// Radiance of a wall with shading and two blobs, seen from `at` (px) under a lamp at `lamp`.
double radiance(double x, double y, double at, double lamp) {
  const double u = x + at, stripes = 0.6 + 0.3 * std::sin(0.31 * u) * std::cos(0.23 * y + 0.1 * u);
  const double blob = std::exp(-0.01 * ((u - 40) * (u - 40) + (y - 25) * (y - 25)));
  return stripes * (0.3 + std::exp(-0.0008 * (x - lamp) * (x - lamp))) + blob;
}

struct View {
  double at = 0, lamp = 32;
};

struct Set {
  std::vector<std::vector<float>> recordings;
  std::vector<std::uint8_t> counts = std::vector<std::uint8_t>(mix_side * mix_side, 1);
  std::vector<PictureOfSet> pictures;
  Set(const std::vector<View>& recorded, const std::vector<View>& believed, double noise = 0.01) {
    for (std::size_t k = 0; k < recorded.size(); ++k) {
      Random random(7, k);
      std::vector<float>& picture = recordings.emplace_back();
      const double exposure = 0.5 + 0.3 * static_cast<double>(k);
      for (int y = 0; y < mix_side; ++y)
        for (int x = 0; x < mix_side; ++x)
          picture.push_back(static_cast<float>(exposure * radiance(x, y, recorded[k].at, recorded[k].lamp) +
                                               noise * random.normal()));
    }
    for (std::size_t k = 0; k < recorded.size(); ++k) {
      PictureOfSet p{.name = std::string(1, static_cast<char>('a' + k)),
                     .width = mix_side,
                     .height = mix_side,
                     .channels = 1,
                     .recording = recordings[k],
                     .counts = counts,
                     .noise = {0, noise},
                     .view = static_cast<std::size_t>(believed[k].at),
                     .lights = "lamp-" + std::to_string(static_cast<int>(believed[k].lamp))};
      for (std::uint32_t i = 3; i < mix_side * mix_side; i += 5) {
        p.at.push_back(i);
        p.predicted.push_back(radiance(i % mix_side, i / mix_side, believed[k].at, believed[k].lamp));
      }
      pictures.push_back(p);
    }
  }
  std::vector<MixUp> found() const { return mix_ups(pictures); }
  std::vector<std::string> words() const { return mix_up_sentences(pictures, found()); }
};

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::pair<std::size_t, std::size_t>> places(const std::vector<MixUp>& found) {
  std::vector<std::pair<std::size_t, std::size_t>> list;
  for (const MixUp& m : found) list.emplace_back(m.image, m.shows);
  return list;
}

const std::vector<View> four = {{0}, {12}, {24}, {36}};

TEST(MixUps, FilesInTheirPlacesAreNotSuspected) {
  EXPECT_THAT(Set(four, four).found(), IsEmpty());
}

TEST(MixUps, TwoSwappedFilesAreFoundWithTheirErrors) {
  const Set set({{0}, {36}, {24}, {12}}, four);
  const std::vector<MixUp> found = set.found();
  ASSERT_THAT(places(found), ElementsAre(std::pair{1, 3}, std::pair{3, 1}));
  for (const MixUp& m : found) {
    EXPECT_LT(m.other, 0.1);
    EXPECT_GT(m.own, 3 * m.other);
    EXPECT_FALSE(m.in_place);
  }
  EXPECT_THAT(set.words(), ElementsAre(testing::AllOf(
                               testing::StartsWith("The file of image b fits what d should show (error "),
                               HasSubstr(" instead of "), testing::EndsWith(": are two file names swapped?"))));
}

TEST(MixUps, ThreeInACycle) {
  const Set set({{12}, {24}, {0}, {36}}, four);
  EXPECT_THAT(places(set.found()), ElementsAre(std::pair{0, 1}, std::pair{1, 2}, std::pair{2, 0}));
  EXPECT_THAT(set.words(), ElementsAre(testing::EndsWith(": are three file names mixed up?")));
}

TEST(MixUps, OneFileUsedTwice) {
  Set set({{12}, {12}, {24}, {36}}, four);
  set.recordings[0] = set.recordings[1];
  set.pictures[0].recording = set.recordings[0];
  ASSERT_THAT(places(set.found()), ElementsAre(std::pair{0, 1}));
  EXPECT_TRUE(set.found()[0].in_place);
  EXPECT_THAT(set.words(), ElementsAre(testing::EndsWith("so does the file of b itself: was one file used twice?")));
}

TEST(MixUps, NamesShiftedByOne) {
  const Set set({{12}, {24}, {36}, {60}}, four);
  EXPECT_THAT(places(set.found()), ElementsAre(std::pair{0, 1}, std::pair{1, 2}, std::pair{2, 3}));
  EXPECT_THAT(set.words(), ElementsAre(testing::EndsWith("not in this set: are the file names shifted?")));
}

TEST(MixUps, SwappedLampsAreCalledLamps) {
  const std::vector<View> believed = {{0, 10}, {0, 54}, {24, 10}, {24, 54}};
  const Set one({{0, 54}, {0, 10}, {24, 10}, {24, 54}}, believed);
  EXPECT_THAT(one.words(), ElementsAre(testing::EndsWith("names swapped, or their lights (lamp-10 and lamp-54)?")));
  const Set all({{0, 54}, {0, 10}, {24, 54}, {24, 10}}, believed);
  EXPECT_THAT(all.words(), ElementsAre(testing::AllOf(testing::StartsWith("In two views the file under lamp-10 fits"),
                                                      testing::EndsWith("lights lamp-10 and lamp-54 swapped?"))));
}

TEST(MixUps, PicturesOfAnotherSizeAreNotCompared) {
  Set set({{0}, {36}, {24}, {12}}, four);
  set.pictures[1].width = mix_side / 2, set.pictures[1].height = mix_side * 2;
  EXPECT_THAT(set.found(), IsEmpty());
}

// Sixty sets of views that stand closer than their poses are known: for many a file another one's prediction fits
// better than its own, and nothing is said.
TEST(MixUps, NearlyTheSameViewsStaySilent) {
  std::size_t better = 0;
  for (std::uint64_t draw = 0; draw < 60; ++draw) {
    Random random(11, draw);
    std::vector<View> recorded, believed;
    for (int k = 0; k < 5; ++k) {
      believed.push_back({0.4 * k, 32});
      recorded.push_back({0.4 * k + 0.5 * random.normal(), 32 + 4 * random.normal()});
      better += std::abs(recorded.back().at - 0.4 * k) > 0.2;
    }
    const Set set(recorded, believed, draw % 2 ? 0.01 : 0.05);
    EXPECT_THAT(set.found(), IsEmpty()) << draw << ": " << set.words().front();
  }
  EXPECT_GT(better, 100u);
}

// An object that moved in one picture, and a lamp that was off, are other errors than a file in the wrong place.
TEST(MixUps, OtherErrorsAreNotMixUps) {
  EXPECT_THAT(Set({{0}, {12}, {29}, {36}}, four).found(), IsEmpty());
  EXPECT_THAT(Set({{0}, {12}, {24, 120}, {36}}, four).found(), IsEmpty());
}

// What things reflect need not be known: a factor for every surface.
TEST(MixUps, UnknownReflectancesDoNotHideASwap) {
  Set set({{0}, {36}, {24}, {12}}, four);
  for (PictureOfSet& p : set.pictures)
    for (std::size_t k = 0; k < p.at.size(); ++k) {
      p.label.push_back(p.at[k] % mix_side < 32 ? 0 : 1);
      p.predicted[k] *= p.label.back() == 0 ? 1 : 4;
    }
  EXPECT_THAT(places(set.found()), ElementsAre(std::pair{1, 3}, std::pair{3, 1}));
}

}  // namespace
}  // namespace gonio::metric
