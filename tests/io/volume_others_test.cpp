// Volumes that other programs wrote (tests/io/data/volumes/SOURCE.md): the values and places that went in.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "io/volume_fixtures.h"

namespace gonio::io {
namespace {

using testing::HasSubstr;

std::filesystem::path written(const char* name) {
  return std::filesystem::path(GONIO_SOURCE) / "tests/io/data/volumes" / name;
}

std::vector<float> ramp_of_seven() {
  std::vector<float> values;
  for (int n = 0; n < 60; ++n) values.push_back(static_cast<float>(7 * n % 251));
  return values;
}

void expect_near(const std::optional<Vec3>& is, Vec3 wanted, double within) {
  ASSERT_TRUE(is);
  for (int a = 0; a < 3; ++a) EXPECT_NEAR((*is)[a], wanted[a], within) << a;
}

void expect_columns(const std::optional<Mat3>& axes, std::array<double, 9> rows) {
  ASSERT_TRUE(axes);
  for (std::size_t n = 0; n < 9; ++n) EXPECT_NEAR(axes->m[n], rows[n], 1e-6) << n;
}

TEST(VolumesOfOthers, HaveTheirValues) {
  for (const char* name : {"c.npy", "fortran.npy", "nibabel_big.nii", "imagej.tif", "imagej_long.tif", "dicom",
                           "tiles.tif", "pillow.tif", "teem.nrrd", "teem_ascii.nrrd", "itk.mha", "itk.nrrd"}) {
    SCOPED_TRACE(name);
    const VolumeData volume = read_volume(written(name));
    EXPECT_EQ(volume.head.size, (std::array<std::size_t, 3>{5, 4, 3}));
    EXPECT_EQ(volume.values, ramp_of_seven());
    // Slice by slice, backwards too.
    const auto source = open_volume(written(name));
    std::vector<float> slice(20);
    for (const std::size_t k : {0, 1, 2, 0, 2, 1}) {
      source->read(k, 1, slice);
      EXPECT_EQ(slice[7], static_cast<float>(7 * (20 * k + 7) % 251)) << k;
    }
  }
}

TEST(VolumesOfOthers, NumPysInBothOrders) {
  EXPECT_EQ(read_volume(written("c.npy")).head.type, VoxelType::u16);
  const VolumeHead fortran = read_volume(written("fortran.npy"), {.spacing_m = Vec3{1e-4, 1e-4, 1e-4}}).head;
  EXPECT_EQ(fortran.type, VoxelType::i32);
  EXPECT_EQ(fortran.spacing_m->y, 1e-4);
  EXPECT_FALSE(fortran.axes);
}

TEST(VolumesOfOthers, NiBabelsPlacesAndScales) {
  const VolumeData scaled = read_volume(written("nibabel.nii.gz"));
  for (std::size_t n = 0; n < 60; ++n) EXPECT_EQ(scaled.values[n], 2 * ramp_of_seven()[n] - 100);
  EXPECT_EQ(scaled.head.format, "NIfTI-1, gzip");
  expect_near(scaled.head.spacing_m, {0.3e-3, 0.4e-3, 0.8e-3}, 1e-10);
  expect_near(scaled.head.origin_m, {0.01, -0.02, 0.03}, 1e-10);
  expect_columns(scaled.head.axes, {0, -1, 0, 1, 0, 0, 0, 0, 1});  // sform
  const VolumeHead big = read_volume(written("nibabel_big.nii")).head;
  EXPECT_EQ(big.type, VoxelType::f32);
  expect_near(big.spacing_m, {20e-6, 20e-6, 25e-6}, 1e-12);  // microns
  expect_near(big.origin_m, {1e-6, 2e-6, 3e-6}, 1e-12);
  expect_columns(big.axes, {0, 0, 1, 1, 0, 0, 0, 1, 0});  // qform: a quaternion
}

// A volume turned by a quarter about z: rows of TransformMatrix and vectors of space directions are axes.
TEST(VolumesOfOthers, ItksPlaces) {
  for (const char* name : {"itk.mha", "itk.nrrd"}) {
    SCOPED_TRACE(name);
    const VolumeHead head = read_volume(written(name)).head;
    EXPECT_EQ(head.type, VoxelType::i16);
    expect_near(head.spacing_m, {0.3e-3, 0.4e-3, 0.8e-3}, 1e-10);
    expect_near(head.origin_m, {-0.01, 0.02, 0.03}, 1e-10);  // left, posterior, superior
    expect_columns(head.axes, {0, 1, 0, -1, 0, 0, 0, 0, 1});
  }
}

TEST(VolumesOfOthers, DcmtksSeries) {
  const VolumeHead head = read_volume(written("dicom")).head;
  EXPECT_EQ(head.format, "DICOM, JPEG lossless");
  EXPECT_EQ(head.value, "hounsfield");
  EXPECT_EQ(head.files[0].filename(), "slice7.dcm");
  expect_near(head.spacing_m, {0.25e-3, 0.25e-3, 0.5e-3}, 1e-12);
  expect_near(head.origin_m, {0.01, 0.02, 0.03}, 1e-12);
}

TEST(VolumesOfOthers, TeemsUnits) {
  const VolumeHead head = read_volume(written("teem.nrrd")).head;
  expect_near(head.spacing_m, {0.5e-6, 0.5e-6, 0.25e-6}, 1e-15);
  expect_near(head.origin_m, {1e-6, 2e-6, 3e-6}, 1e-15);
  expect_columns(head.axes, {1, 0, 0, 0, 0, 1, 0, 1, 0});
  EXPECT_EQ(head.format, "NRRD, gzip");
}

TEST(VolumesOfOthers, TiffsOfMicroscopy) {
  const VolumeHead head = read_volume(written("imagej.tif")).head;
  expect_near(head.spacing_m, {0.25e-3, 0.25e-3, 0.4e-3}, 1e-9);
  EXPECT_EQ(read_volume(written("tiles.tif")).head.type, VoxelType::f32);
  EXPECT_FALSE(read_volume(written("tiles.tif")).head.spacing_m);
  expect_near(read_volume(written("imagej_long.tif")).head.spacing_m, {0.25e-6, 0.25e-6, 0.4e-6}, 1e-12);
  EXPECT_THAT(volume_refusal(written("imagej.tif"), {.spacing_m = Vec3{1e-3, 1e-3, 1e-3}}),
              HasSubstr("states a spacing of 0.25 x 0.25 x 0.4 mm"));
}

TEST(VolumesOfOthers, AnAtlas) {
  const auto file = written("tiles.png");
  const VolumeWish wish{.spacing_m = Vec3{1e-4, 1e-4, 2e-4}, .size = {{5, 4, 3}}, .tiles = {{2, 2}}};
  const VolumeData volume = read_volume(file, wish);
  EXPECT_EQ(volume.values, ramp_of_seven());
  EXPECT_EQ(volume.head.spacing_m->z, 2e-4);
  const VolumeData whole = read_volume(file, {.tiles = {{2, 2}}});
  EXPECT_EQ(whole.head.size[2], 4u);
  EXPECT_EQ(whole.at(4, 3, 3), 0);
  EXPECT_THAT(volume_refusal(file), HasSubstr("is one picture of 10 x 8 pixels"));
  EXPECT_THAT(volume_refusal(file, {.tiles = {{3, 2}}}), HasSubstr("10 x 8 pixels, which 3 x 2 tiles do not divide"));
  EXPECT_THAT(volume_refusal(file, {.tiles = {{0, 2}}}), HasSubstr("do not divide"));
  EXPECT_THAT(volume_refusal(file, {.size = {{5, 4, 5}}, .tiles = {{2, 2}}}), HasSubstr("--size says 5 x 4 x 5"));
}

TEST(VolumesOfOthers, TheTeapotsAtlasAsCounted) {
  GONIO_NEEDS_DATA("ct/boston_teapot_atlas.png");
  const VolumeData teapot = read_volume(tests::data("ct/boston_teapot_atlas.png"), {.tiles = {{16, 16}}});
  EXPECT_EQ(teapot.head.size, (std::array<std::size_t, 3>{256, 256, 256}));
  // NumPy and Pillow on the same file; the set's README: data in slices 2 to 175, and 644,678 voxels above 40 in the
  // largest of 117 components.
  std::size_t first = 256, last = 0, above = 0;
  double sum = 0, row = 0, column = 0;
  for (std::size_t n = 0; n < teapot.values.size(); ++n) {
    if (teapot.values[n] > 0) first = std::min(first, n >> 16), last = std::max(last, n >> 16);
    above += teapot.values[n] > 40;
    sum += teapot.values[n];
  }
  for (std::size_t n = 0; n < 256; ++n) row += teapot.at(n, 120, 100), column += teapot.at(99, n, 57);
  EXPECT_EQ(first, 2u);
  EXPECT_EQ(last, 175u);
  EXPECT_EQ(above, 656641u);
  EXPECT_EQ(sum, 74626577);
  EXPECT_EQ(row, 2918);
  EXPECT_EQ(column, 1996);
}

}  // namespace
}  // namespace gonio::io
