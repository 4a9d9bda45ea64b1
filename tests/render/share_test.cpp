// Shares of pictures: files of sums come back as they were or are refused, and joined shares are the picture that one
// run renders, bit for bit, with every kind of layer.
#include "render/share.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "io/exr.h"
#include "made_up_integrator.h"
#include "manifest/sections/object.h"
#include "progressive_scene.h"
#include "render/film.h"

namespace gonio::render {
namespace {

namespace fs = std::filesystem;
using tests::made_up_identity;
using tests::made_up_passes;
using tests::MadeUpIntegrator;
using tests::rendered;
using tests::ScratchFolder;
using tests::small_scene;

bool same_sums(const PassSums& a, const PassSums& b) {
  const auto pa = a.parts(), pb = b.parts();
  for (std::size_t i = 0; i < pa.size(); ++i)
    if (!std::ranges::equal(pa[i], pb[i])) return false;
  return a.identity() == b.identity() && a.first_pass() == b.first_pass() && a.passes() == b.passes();
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data) << e.what();
    return e.what();
  }
  return "nothing was refused";
}

TEST(Sums, ComeBackFromTheirFile) {
  const ScratchFolder folder;
  const MadeUpIntegrator integrator;
  const PassSums sums = made_up_passes(integrator, 3, 5);
  write_sums(folder / "a.sums", sums, 12.5);
  EXPECT_TRUE(same_sums(read_sums(folder / "a.sums"), sums));
  const SumsHeader header = read_sums_header(folder / "a.sums");
  EXPECT_EQ(header.spent_s, 12.5);
  EXPECT_EQ(header.first_sample(), 12);
  EXPECT_EQ(header.end_sample(), 32);
}

// Every byte of the head and 60 of the sums, changed one at a time, and the file cut anywhere: refused with one line.
TEST(Sums, DamageIsNoticed) {
  const ScratchFolder folder;
  const MadeUpIntegrator integrator;
  write_sums(folder / "a.sums", made_up_passes(integrator, 0, 2), 0);
  const std::string whole = read_file(folder / "a.sums");
  const std::size_t head = whole.find('\n', whole.find('\n') + 1) + 1;
  Random random(1);
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < head; ++i) places.push_back(i);
  for (int i = 0; i < 60; ++i) places.push_back(head + random.below(static_cast<std::uint32_t>(whole.size() - head)));
  for (const std::size_t place : places) {
    std::string bytes = whole;
    bytes[place] = static_cast<char>(bytes[place] ^ (1 << random.below(8)));
    std::ofstream(folder / "b.sums", std::ios::binary) << bytes;
    EXPECT_THROW(read_sums(folder / "b.sums"), Error) << "byte " << place;
  }
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{5}, head - 1, head, whole.size() / 2, whole.size() - 1}) {
    write_file(folder / "b.sums", whole.substr(0, length));
    EXPECT_THROW(read_sums(folder / "b.sums"), Error) << length << " bytes";
  }
  write_file(folder / "b.sums", whole + "x");
  EXPECT_THROW(read_sums(folder / "b.sums"), Error);
}

TEST(Shares, ThatDoNotFitAreRefused) {
  const ScratchFolder folder;
  const MadeUpIntegrator integrator;
  const auto write = [&](const char* name, std::uint32_t first, std::uint32_t count, const auto& change) {
    PictureIdentity identity = made_up_identity(integrator);
    change(identity);
    PassSums sums(identity, first);
    add_passes(integrator, sums, count, nullptr);
    write_sums(folder / name, sums, 0);
    return fs::path(folder / name);
  };
  const auto plain = [](PictureIdentity&) {};
  const fs::path a = write("a.sums", 0, 2, plain), b = write("b.sums", 2, 3, plain), c = write("c.sums", 5, 1, plain);
  EXPECT_THAT(ordered_shares({c, a, b}), testing::ElementsAre(a, b, c));
  EXPECT_TRUE(same_sums(joined_shares({a, b, c}), made_up_passes(integrator, 0, 6)));
  EXPECT_THAT(refusal([&] { ordered_shares({a, c}); }), testing::HasSubstr("samples 8 to 19 are missing"));
  EXPECT_THAT(refusal([&] {
                ordered_shares({a, write("d.sums", 1, 4, plain)});
              }),
              testing::HasSubstr("holds some, too"));
  EXPECT_THAT(refusal([&] {
                ordered_shares({a, write("e.sums", 2, 1, [](auto& i) { i.seed = 9; })});
              }),
              testing::HasSubstr("seed 9"));
  EXPECT_THAT(refusal([&] {
                ordered_shares({a, write("f.sums", 2, 1, [](auto& i) { i.scene = "other"; })});
              }),
              testing::HasSubstr("another scene"));
  EXPECT_THAT(refusal([&] {
                ordered_shares({a, write("g.sums", 2, 1, [](auto& i) { i.samples_per_pass = 2; })});
              }),
              testing::HasSubstr("--spp"));
}

class SessionShares : public testing::Test {
 protected:
  static std::string exr(const Rendered& picture) {
    return io::encode_exr(picture.picture, attributes_of(picture.facts, picture.picture));
  }
  fs::path share(const manifest::Document& document, SessionOptions options, const std::string& range) {
    options.samples = range;
    const fs::path path = folder_ / ("share-" + std::to_string(count_++) + ".exr");
    const Rendered part = rendered(document, options, 0, path);
    write_file(path, exr(part));
    write_sums(sums_path(path), *part.sums, 0);
    return path;
  }
  ScratchFolder folder_;

 private:
  int count_ = 0;
};

// Colours, Stokes vectors, wavelengths, single lights, caustics that come from the lamps, geometry: whatever the cuts.
TEST_F(SessionShares, JoinedAreThePictureOfOneRun) {
  const auto document = small_scene(tests::glass(), "[0.5, 0.3, 0.1]");
  SessionOptions options{.seed = 4, .spp = 6, .wavelengths_m = {450e-9, 500e-9, 550e-9, 600e-9}};
  options.transport.stokes = options.transport.per_light = true;
  const Rendered whole = rendered(document, options);
  ASSERT_EQ(whole.facts.samples(), 6);
  for (const char* channel : {"R", "variance.s2.G", "S0.600,0nm", "S3.450,0nm", "light.ambient.B", "id", "mask.A",
                              "back_normal.Z", "depth.Z"})
    EXPECT_GE(whole.picture.channel(channel), 0) << channel;
  const std::vector<std::vector<std::string>> splits = {
      {"0:3", "3:6"}, {"5:6", "0:1", "1:5"}, {"4:5", "3:4", "5:6", "1:2", "0:1", "2:3"}};
  for (const auto& split : splits) {
    std::vector<fs::path> shares;
    for (const std::string& range : split) shares.push_back(share(document, options, range));
    const auto by_image = shares_by_image(shares);
    ASSERT_EQ(by_image.size(), 1u);
    const Rendered merged = merge_shares(by_image.at("one"));
    EXPECT_TRUE(exr(merged) == exr(whole)) << split.size() << " shares";
    EXPECT_TRUE(same_sums(*merged.sums, *whole.sums));
  }
}

TEST_F(SessionShares, OfOtherGeometryOrAlone) {
  const auto document = small_scene();
  const fs::path first = share(document, {.spp = 4}, "0:2"), second = share(document, {.spp = 4}, "2:4");
  auto moved = document;
  moved.objects[0].world_from_object->translation_m.x += 0.01;
  const fs::path other = share(moved, {.spp = 4}, "2:4");
  EXPECT_THAT(refusal([&] { shares_by_image({first, other}); }), testing::HasSubstr("another scene"));
  // The picture of a share in the place of another's, beside sums that fit.
  fs::copy_file(other, second, fs::copy_options::overwrite_existing);
  EXPECT_THAT(refusal([&] {
                merge_shares(shares_by_image({first, second}).at("one"));
              }),
              testing::HasSubstr("other geometry"));
  fs::remove(sums_path(first));
  EXPECT_THROW(shares_by_image({first}), Error);
  EXPECT_THROW(shares_by_image({folder_ / "a.png"}), Error);
}

}  // namespace
}  // namespace gonio::render
