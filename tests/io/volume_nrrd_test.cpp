// NRRD: what is written is read again; heads as others write them; wishes; broken ones; recorded volumes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "io/volume_fixtures.h"

namespace gonio::io {
namespace {

using testing::ElementsAreArray;
using testing::HasSubstr;

constexpr VoxelType all_types[] = {VoxelType::u8,  VoxelType::i8,  VoxelType::u16, VoxelType::i16,
                                   VoxelType::u32, VoxelType::i32, VoxelType::f32, VoxelType::f64};

TEST(VolumeNrrd, WhatIsWrittenIsReadAgain) {
  const tests::ScratchFolder folder;
  for (const VoxelType type : all_types)
    for (const bool gzip : {false, true}) {
      SCOPED_TRACE(std::string(name_of(type)) + (gzip ? ", gzip" : ""));
      VolumeData volume = random_volume(type);
      if (type == VoxelType::i8 || type == VoxelType::i16 || type == VoxelType::i32) volume.values[17] = -77;
      if (type == VoxelType::f32) volume.values[3] = 0.1f;
      volume.head.spacing_m = Vec3{1e-4, 2e-4, 3.5e-4};
      volume.head.origin_m = Vec3{0.01, -0.02, 0.03};
      volume.head.axes = Mat3{{0, -1, 0, 1, 0, 0, 0, 0, 1}};
      volume.head.value = "hounsfield";
      write_nrrd(folder / "v.nrrd", volume, gzip);
      const VolumeData back = read_volume(folder / "v.nrrd");
      EXPECT_EQ(back.head.size, volume.head.size);
      EXPECT_EQ(back.head.type, type);
      EXPECT_EQ(back.head.value, "hounsfield");
      EXPECT_EQ(back.head.format, gzip ? "NRRD, gzip" : "NRRD");
      EXPECT_EQ(back.values, volume.values);
      ASSERT_TRUE(back.head.spacing_m && back.head.origin_m && back.head.axes);
      for (int a = 0; a < 3; ++a) {
        EXPECT_NEAR((*back.head.spacing_m)[a], (*volume.head.spacing_m)[a], 1e-18);
        EXPECT_NEAR((*back.head.origin_m)[a], (*volume.head.origin_m)[a], 1e-17);
        for (int b = 0; b < 3; ++b) EXPECT_NEAR((*back.head.axes)(a, b), (*volume.head.axes)(a, b), 1e-15);
      }
    }
}

TEST(VolumeNrrd, SpacingAloneAndNothingAreKeptAsTheyAre) {
  const tests::ScratchFolder folder;
  VolumeData volume = random_volume(VoxelType::u16);
  write_nrrd(folder / "v.nrrd", volume);
  EXPECT_FALSE(read_volume(folder / "v.nrrd").head.spacing_m);
  volume.head.spacing_m = Vec3{1e-3, 1e-3, 1e-3};  // ones, but with a unit
  write_nrrd(folder / "v.nrrd", volume);
  const VolumeHead head = read_volume(folder / "v.nrrd").head;
  ASSERT_TRUE(head.spacing_m);
  EXPECT_DOUBLE_EQ(head.spacing_m->z, 1e-3);
  EXPECT_FALSE(head.axes);
  EXPECT_FALSE(head.origin_m);
}

TEST(VolumeNrrd, TheSameVolumeGivesTheSameBytesAndSlicesMayComeOneByOne) {
  const tests::ScratchFolder folder;
  const VolumeData volume = random_volume(VoxelType::u8, {64, 50, 20});
  write_nrrd(folder / "a.nrrd", volume, true);
  std::vector<std::size_t> asked;
  write_nrrd(
      folder / "b.nrrd", volume.head,
      [&](std::size_t k, std::span<float> to) {
        asked.push_back(k);
        for (std::size_t n = 0; n < to.size(); ++n) to[n] = volume.values[k * to.size() + n];
      },
      true);
  EXPECT_EQ(read_file(folder / "a.nrrd"), read_file(folder / "b.nrrd"));
  std::vector<std::size_t> row(20);
  std::iota(row.begin(), row.end(), std::size_t{0});
  EXPECT_EQ(asked, row);
}

TEST(VolumeNrrd, ValuesThatTheTypeDoesNotHoldAreRefusedAndNothingIsLeft) {
  const tests::ScratchFolder folder;
  const auto refusal_of = [&](VoxelType type, float value) -> std::string {
    VolumeData volume = random_volume(type);
    volume.values[23] = value;  // (3, 0, 1)
    try {
      write_nrrd(folder / "v.nrrd", volume);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      return error.what();
    }
    return "none";
  };
  EXPECT_THAT(refusal_of(VoxelType::u8, 256), HasSubstr("v.nrrd#slice 1: sample (3, 0) is 256, which uint8"));
  EXPECT_THAT(refusal_of(VoxelType::u8, -1), HasSubstr("is -1"));
  EXPECT_THAT(refusal_of(VoxelType::i16, 0.5f), HasSubstr("is 0.5, which int16 does not hold"));
  EXPECT_THAT(refusal_of(VoxelType::i16, 32768), HasSubstr("32768"));
  EXPECT_THAT(refusal_of(VoxelType::u32, 4294967296.0f), HasSubstr("4294967296"));
  EXPECT_THAT(refusal_of(VoxelType::f32, std::nanf("")), HasSubstr("is no number"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_EQ(refusal_of(VoxelType::i16, -32768), "none");
}

TEST(VolumeNrrd, ReadsSlicesForwardsAndBackAgain) {
  const tests::ScratchFolder folder;
  const VolumeData volume = random_volume(VoxelType::u16, {31, 17, 40}, 60000);
  for (const bool gzip : {false, true}) {
    write_nrrd(folder / "v.nrrd", volume, gzip);
    const auto source = open_volume(folder / "v.nrrd");
    std::vector<float> some(3 * 31 * 17);
    for (const std::size_t first : {0, 3, 20, 37, 5, 0}) {
      source->read(first, 3, some);
      const auto from = volume.values.begin() + static_cast<std::ptrdiff_t>(first * 31 * 17);
      EXPECT_TRUE(std::equal(some.begin(), some.end(), from)) << first;
    }
    EXPECT_THROW(source->read(38, 3, some), Error);
    EXPECT_THROW(source->read(0, 2, some), Error);
  }
  const auto source = source_of(volume);
  std::vector<float> one(31 * 17);
  source->read(39, 1, one);
  EXPECT_EQ(one.back(), volume.values.back());
}

// Heads as others write them, with 5 x 4 x 3 samples 0, 1, ... behind.
class NrrdHeads : public testing::Test {
 protected:
  std::vector<float> ramp_ = std::vector<float>(60);
  void SetUp() override { std::iota(ramp_.begin(), ramp_.end(), 0.f); }
  std::filesystem::path file(const std::string& head, const std::string& samples) {
    write_file(folder_ / "v.nrrd", "NRRD0004\n" + head + "\n" + samples);
    return folder_ / "v.nrrd";
  }
  static std::string head(const std::string& type, const std::string& more = {}) {
    return "type: " + type + "\ndimension: 3\nsizes: 5 4 3\nencoding: raw\n" + more;
  }
  std::string refused(const std::string& text, const VolumeWish& wish = {}) {
    return volume_refusal(file(text, stored<std::uint8_t>(ramp_)), wish);
  }
  tests::ScratchFolder folder_;
};

TEST_F(NrrdHeads, EverySpellingOfATypeAndBothOrders) {
  for (const char* type : {"unsigned char", "uchar", "uint8", "uint8_t"})
    EXPECT_EQ(read_volume(file(head(type), stored<std::uint8_t>(ramp_))).values, ramp_) << type;
  for (const char* type : {"signed char", "int8", "int8_t"})
    EXPECT_EQ(read_volume(file(head(type), stored<std::int8_t>(ramp_))).values, ramp_) << type;
  for (const bool big : {false, true}) {
    const std::string endian = big ? "endian: big\n" : "endian: little\n";
    for (const char* type : {"short", "short int", "signed short", "signed short int", "int16", "int16_t"})
      EXPECT_EQ(read_volume(file(head(type, endian), stored<std::int16_t>(ramp_, big))).values, ramp_) << type;
    for (const char* type : {"ushort", "unsigned  short", "unsigned short int", "uint16", "uint16_t"})
      EXPECT_EQ(read_volume(file(head(type, endian), stored<std::uint16_t>(ramp_, big))).values, ramp_) << type;
    for (const char* type : {"int", "signed int", "int32", "int32_t"})
      EXPECT_EQ(read_volume(file(head(type, endian), stored<std::int32_t>(ramp_, big))).values, ramp_) << type;
    for (const char* type : {"uint", "unsigned int", "uint32", "uint32_t"})
      EXPECT_EQ(read_volume(file(head(type, endian), stored<std::uint32_t>(ramp_, big))).values, ramp_) << type;
    EXPECT_EQ(read_volume(file(head("float", endian), stored<float>(ramp_, big))).values, ramp_);
    EXPECT_EQ(read_volume(file(head("double", endian), stored<double>(ramp_, big))).values, ramp_);
  }
  EXPECT_THAT(refused(head("long long")), HasSubstr("samples of type \"long long\""));
  EXPECT_THAT(refused(head("short")), HasSubstr("has no endian"));
}

TEST_F(NrrdHeads, LengthsCountAsStatedWhereTheirUnitIs) {
  const std::string bytes = stored<std::uint8_t>(ramp_);
  const auto spacing = [&](const std::string& more) { return read_volume(file(head("uint8", more), bytes)).head; };
  EXPECT_FALSE(spacing("spacings: 1 1 1\n").spacing_m);
  EXPECT_FALSE(spacing("spacings: 0.5 0.5 0.7\n").spacing_m);
  EXPECT_EQ(spacing("spacings: 0.5 0.5 0.7\n").spacing_note, "0.5 x 0.5 x 0.7 of no unit");
  EXPECT_FALSE(spacing("spacings: nan nan nan\n").spacing_m);
  EXPECT_NEAR(spacing("spacings: 0.5 0.5 0.7\nunits: \"mm\" \"mm\" \"mm\"\n").spacing_m->z, 7e-4, 1e-12);
  EXPECT_NEAR(spacing("spacings: 1 1 1\nunits: \"um\" \"um\" \"um\"\n").spacing_m->z, 1e-6, 1e-15);
  const std::string patient = "space: left-posterior-superior\nspace origin: (10,20,-30)\n";
  EXPECT_FALSE(spacing(patient + "space directions: (1,0,0) (0,1,0) (0,0,1)\n").spacing_m);
  const VolumeHead turned = spacing(patient + "space directions: (0,0.5,0) (-0.5,0,0) (0,0,2)\n");
  EXPECT_NEAR(turned.spacing_m->x, 5e-4, 1e-12);
  EXPECT_NEAR(turned.spacing_m->z, 2e-3, 1e-12);
  EXPECT_NEAR(turned.origin_m->z, -0.03, 1e-12);
  EXPECT_EQ((*turned.axes)(1, 0), 1);   // i goes along the frame's y,
  EXPECT_EQ((*turned.axes)(0, 1), -1);  // j against its x
  const VolumeHead microns = spacing(
      "space dimension: 3\nspace units: \"microns\" \"microns\" \"microns\"\nspace origin: (0,0,5)\n"
      "space directions: (20,0,0) (0,20,0) (0,0,25)\n");
  EXPECT_NEAR(microns.spacing_m->z, 25e-6, 1e-15);
  EXPECT_NEAR(microns.origin_m->z, 5e-6, 1e-15);
  EXPECT_THAT(refused(head("uint8", "spacings: 1 1 2\nunits: \"mm\" \"mm\" \"s\"\n")), HasSubstr("\"s\""));
  EXPECT_THAT(refused(head("uint8", "spacings: 1 1 2\nunits: \"mm\" \"mm\" \"m\"\n")), HasSubstr("different units"));
}

TEST_F(NrrdHeads, WishesAddToTheFileAndMayNotContradictIt) {
  const std::string bytes = stored<std::uint8_t>(ramp_);
  const auto with = [&](const std::string& more, Vec3 wish) {
    return read_volume(file(head("uint8", more), bytes), {.spacing_m = wish}).head;
  };
  EXPECT_EQ(with("spacings: 1 1 1\n", {1e-4, 1e-4, 3e-4}).spacing_m->z, 3e-4);
  // What the wish says of the spacing says the unit of the origin.
  const std::string bare = "space dimension: 3\nspace origin: (2,4,6)\nspace directions: (2,0,0) (0,2,0) (0,0,4)\n";
  const VolumeHead scaled = with(bare, {1e-4, 1e-4, 2e-4});
  EXPECT_NEAR(scaled.origin_m->z, 3e-4, 1e-15);
  EXPECT_THAT(refused(head("uint8", bare), {.spacing_m = Vec3{1e-4, 1e-4, 1e-4}}), HasSubstr("has other ratios"));
  const std::string stated = "spacings: 0.5 0.5 0.7\nunits: \"mm\" \"mm\" \"mm\"\n";
  EXPECT_NEAR(with(stated, {0.0005, 0.0005, 0.0007}).spacing_m->z, 7e-4, 1e-12);
  EXPECT_THAT(refused(head("uint8", stated), {.spacing_m = Vec3{5e-4, 5e-4, 8e-4}}),
              HasSubstr("states a spacing of 0.5 x 0.5 x 0.7 mm, and --voxel says 0.5 x 0.5 x 0.8 mm"));
  EXPECT_THAT(refused(head("uint8"), {.spacing_m = Vec3{1e-4, 0, 1e-4}}), HasSubstr("--voxel: states a spacing of 0"));
  EXPECT_THAT(refused(head("uint8"), {.size = {{5, 4, 4}}}),
              HasSubstr("has 5 x 4 x 3 voxels, and --size says 5 x 4 x 4"));
  EXPECT_THAT(refused(head("uint8"), {.type = VoxelType::u16}), HasSubstr("stores uint8, and --type says uint16"));
  EXPECT_THAT(refused(head("uint8"), {.skip_bytes = 4}), HasSubstr("says itself where its samples begin"));
  EXPECT_THAT(refused(head("uint8"), {.tiles = {{2, 2}}}), HasSubstr("has no tiles"));
  EXPECT_EQ(volume_refusal(file(head("uint8"), bytes), {.size = {{5, 4, 3}}, .type = VoxelType::u8}), "none");
  VolumeHead none = with("spacings: 0.5 0.5 0.7\n", {5, 5, 7});
  none.spacing_m.reset();
  try {
    stated_spacing(none);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("v.nrrd: does not say how far its voxels lie apart, but 0.5 x 0.5 x 0.7 of no "
                                        "unit; say it with --voxel 120um"));
  }
}

TEST_F(NrrdHeads, SkipsAsciiAndDetachedFiles) {
  const std::string bytes = stored<std::uint8_t>(ramp_);
  EXPECT_EQ(read_volume(file(head("uint8", "byte skip: 7\n"), "1234567" + bytes)).values, ramp_);
  EXPECT_EQ(read_volume(file(head("uint8", "byteskip: -1\n"), "anything" + bytes)).values, ramp_);
  EXPECT_EQ(read_volume(file(head("uint8", "line skip: 2\nbyte skip: 1\n"), "P5\n5 12\n!" + bytes)).values, ramp_);
  const std::string gzip = "type: uint8\ndimension: 3\nsizes: 5 4 3\nencoding: gzip\n";
  EXPECT_EQ(read_volume(file(gzip + "byte skip: 3\n", gzipped("abc" + bytes))).values, ramp_);
  EXPECT_EQ(read_volume(file(gzip, gzipped(bytes.substr(0, 20)) + gzipped(bytes.substr(20)))).values, ramp_);
  std::string text;
  for (const float v : ramp_) text += std::to_string(static_cast<int>(v)) + (v == 9 ? ",\n" : v == 20 ? "\t\t" : " ");
  EXPECT_EQ(read_volume(file("type: short\ndimension: 3\nsizes: 5 4 3\nencoding: ascii\n", text)).values, ramp_);
  EXPECT_THAT(volume_refusal(file("type: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: text\n", text + "300")), "none");
  text.replace(0, 1, "256");
  EXPECT_THAT(volume_refusal(file("type: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: text\n", text)),
              HasSubstr("v.nrrd#slice 0: sample 0, \"256\", is no uint8"));

  write_file(folder_ / "all.raw", "header" + bytes);
  EXPECT_EQ(read_volume(file(head("uint8", "byte skip: 6\ndata file: ./all.raw\n"), "")).values, ramp_);
  for (std::size_t k = 0; k < 3; ++k)
    write_file(folder_ / ("s" + std::to_string(10 + 2 * k) + ".raw.gz"), gzipped(bytes.substr(20 * k, 20)));
  const VolumeData row = read_volume(file(gzip + "data file: s%02d.raw.gz 10 14 2\n", ""));
  EXPECT_EQ(row.values, ramp_);
  EXPECT_EQ(row.head.files.size(), 4u);
  write_file(folder_ / "v.nhdr", "NRRD0005\r\n" + gzip + "data file: LIST\ns14.raw.gz\ns12.raw.gz\ns10.raw.gz\n");
  const auto source = open_volume(folder_ / "v.nhdr");
  std::vector<float> last(20);
  source->read(2, 1, last);
  EXPECT_THAT(last, ElementsAreArray(ramp_.begin(), ramp_.begin() + 20));
}

TEST_F(NrrdHeads, BrokenOnesAreRefusedInALine) {
  const std::string bytes = stored<std::uint8_t>(ramp_);
  const std::string gzip = "type: uint8\ndimension: 3\nsizes: 5 4 3\nencoding: gzip\n";
  const auto sized = [](const std::string& sizes, const std::string& type = "uint8") {
    return "type: " + type + "\ndimension: 3\nsizes: " + sizes + "\nencoding: raw\nendian: little\n";
  };
  EXPECT_EQ(refused(sized("5 4 3")), "none");
  EXPECT_THAT(refused(sized("5 4 4")), HasSubstr("v.nrrd: has 60 bytes of data where 80 are promised: truncated"));
  EXPECT_THAT(refused(sized("1000000 1000000 64")), HasSubstr("v.nrrd: has 60 bytes of data where 64000000000000"));
  EXPECT_THAT(refused(sized("1048576 1048576 1048576")), HasSubstr("more than 2^46 bytes"));
  EXPECT_THAT(refused(sized("4294967296 4294967296 1")), HasSubstr("claims 4294967296 voxels a side"));
  EXPECT_THAT(refused(sized("5 0 3")), HasSubstr("claims 0 voxels a side"));
  EXPECT_THAT(refused(sized("5 -4 3")), HasSubstr("claims -4 voxels a side"));
  EXPECT_THAT(refused(sized("5 4")), HasSubstr("has 2 sizes, and 3 belong there"));
  EXPECT_THAT(refused(sized("5 4 x")), HasSubstr("has \"x\" among its sizes"));
  EXPECT_THAT(refused(sized("5 4 99999999999999999999")), HasSubstr("among its sizes"));
  EXPECT_THAT(refused(sized("5 4 3") + "sizes: 5 4 3\n"), HasSubstr("\"sizes\" twice"));
  EXPECT_THAT(refused("dimension: 3\nsizes: 5 4 3\nencoding: raw\n"), HasSubstr("has no type"));
  EXPECT_THAT(refused("type: uint8\nsizes: 5 4 3\nencoding: raw\n"), HasSubstr("has no dimension"));
  EXPECT_THAT(refused("type: uint8\ndimension: 4\nsizes: 5 4 3 2\nencoding: raw\n"), HasSubstr("has 4 axes"));
  EXPECT_THAT(refused("type: uint8\ndimension: 3\nsizes: 5 4 3\nencoding: bzip2\n"), HasSubstr("encoded as \"bzip2\""));
  EXPECT_THAT(refused(sized("5 4 3") + "what is this\n"), HasSubstr("\"what is this\""));
  EXPECT_THAT(refused(head("uint8", "spacings: 1 0 1\n")), HasSubstr("states a spacing of 0 along j"));
  EXPECT_THAT(refused(head("uint8", "spacings: 1 1 -2\n")), HasSubstr("states a spacing of -2 along k"));
  EXPECT_THAT(refused(head("uint8", "spacings: 1 1 inf\n")), HasSubstr("states a spacing of inf along k"));
  EXPECT_THAT(refused(head("uint8", "space dimension: 3\nspace directions: (1,0,0) (0.1,1,0) (0,0,1)\n")),
              HasSubstr("has axes i and j that are not orthogonal (84.29 degrees"));
  EXPECT_THAT(refused(head("uint8", "space dimension: 3\nspace directions: (1,0,0) none (0,0,1)\n")),
              HasSubstr("where vectors belong"));
  EXPECT_THAT(refused(head("uint8", "data file: ../../etc/passwd\n")), HasSubstr("samples outside its folder"));
  EXPECT_THAT(refused(head("uint8", "data file: /dev/zero\n")), HasSubstr("samples outside its folder"));
  EXPECT_THAT(refused(head("uint8", "data file: s%s.raw 1 3 1\n")), HasSubstr("one %d or %03d is possible"));
  EXPECT_THAT(refused(head("uint8", "data file: s%d.raw 1 300000000 1\n")), HasSubstr("more than 1048576 files"));
  EXPECT_THAT(refused(head("uint8", "byte skip: -2\n")), HasSubstr("has a byteskip of -2"));
  EXPECT_THAT(refused(head("uint8", "line skip: 9\n")), HasSubstr("fewer lines"));
  EXPECT_THAT(volume_refusal(file(head("uint8", "data file: none.raw\n"), ""), {}, Exit::no_input),
              HasSubstr("none.raw: No such file"));
  const std::string whole = gzipped(bytes);
  EXPECT_THAT(volume_refusal(file(gzip, whole.substr(0, whole.size() - 9))),
              HasSubstr("v.nrrd: ends after 60 inflated"));
  EXPECT_THAT(volume_refusal(file(gzip, gzipped(bytes.substr(0, 30)))),
              HasSubstr("ends after 30 inflated bytes where its head promises 60"));
  std::string damaged = whole;
  damaged[damaged.size() - 7] ^= 1;  // of the checksum
  EXPECT_THAT(volume_refusal(file(gzip, damaged)),
              HasSubstr("is damaged after 60 inflated bytes (incorrect data check)"));
  EXPECT_THAT(volume_refusal(file(gzip, bytes)), HasSubstr("is damaged after 0 inflated bytes"));
  EXPECT_THAT(volume_refusal(file("type: uint8\ndimension: 3\nsizes: 512 512 512\nencoding: gzip\n", whole)),
              HasSubstr("more than they can hold"));
  std::vector<float> bad = ramp_;
  bad[33] = std::numeric_limits<float>::infinity();
  EXPECT_THAT(volume_refusal(file(sized("5 4 3", "float"), stored<float>(bad))),
              HasSubstr("v.nrrd#slice 1: sample (3, 2) is beyond a float's largest number"));
  bad[33] = std::nanf("");
  EXPECT_THAT(volume_refusal(file(sized("5 4 3", "double"), stored<double>(bad, false))),
              HasSubstr("v.nrrd#slice 1: sample (3, 2) is no number"));
  write_file(folder_ / "w.nrrd", "NRRD0009\n");
  EXPECT_THAT(volume_refusal(folder_ / "w.nrrd"), HasSubstr("NRRD0001 to NRRD0006"));
  EXPECT_THAT(volume_refusal(folder_ / "missing.nrrd", {}, Exit::no_input), HasSubstr("missing.nrrd"));
}

// An independent count: figures of SOURCE.md beside the set, by scikit-image and SciPy.
TEST(VolumeNrrd, EngineBlockAsPublished) {
  GONIO_NEEDS_DATA("ct/engine_block/engine.nrrd");
  const VolumeData engine = read_volume(tests::data("ct/engine_block/engine.nrrd"));
  EXPECT_EQ(engine.head.size, (std::array<std::size_t, 3>{256, 256, 128}));
  EXPECT_FALSE(engine.head.spacing_m) << "spacings: 1 1 1 without a unit is no spacing";
  EXPECT_EQ(engine.head.spacing_note, "1 x 1 x 1 of no unit");
  const auto above = [](const VolumeData& volume, float limit) {
    return std::count_if(volume.values.begin(), volume.values.end(), [&](float v) { return v > limit; });
  };
  EXPECT_EQ(above(engine, 71), 1156699);
  EXPECT_EQ(above(engine, 179), 87629);
}

TEST(VolumeNrrd, ToothAsPublished) {
  GONIO_NEEDS_DATA("ct/tooth/tooth.nrrd");
  const VolumeData tooth = read_volume(tests::data("ct/tooth/tooth.nrrd"), {.spacing_m = Vec3{1e-4, 1e-4, 1e-4}});
  EXPECT_EQ(tooth.head.size, (std::array<std::size_t, 3>{103, 94, 161}));
  EXPECT_EQ(tooth.head.spacing_m->x, 1e-4);
  ASSERT_TRUE(tooth.head.axes);
  const auto above = [&](float limit) {
    return std::count_if(tooth.values.begin(), tooth.values.end(), [&](float v) { return v > limit; });
  };
  EXPECT_EQ(above(128), 380692);
  EXPECT_EQ(above(118), 393902);
  EXPECT_EQ(above(193), 97842);
  EXPECT_FALSE(open_volume(tests::data("ct/tooth/tooth.nrrd"))->head().spacing_m);
}

}  // namespace
}  // namespace gonio::io
