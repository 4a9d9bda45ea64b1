// MetaImage, NIfTI-1, NumPy, TIFF stacks and raw samples: variants of heads, wishes, broken files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "io/little_endian.h"
#include "io/volume_fixtures.h"

namespace gonio::io {
namespace {

using testing::HasSubstr;

class VolumeHeads : public testing::Test {
 protected:
  void SetUp() override { std::iota(ramp_.begin(), ramp_.end(), 0.f); }
  std::filesystem::path file(const std::string& name, const std::string& bytes) {
    write_file(folder_ / name, bytes);
    return folder_ / name;
  }
  std::string refused(const std::string& bytes, const VolumeWish& wish = {}) {
    return volume_refusal(file("bad", bytes), wish);
  }
  static std::string mha(const std::string& more, const std::string& sizes = "5 4 3",
                         const std::string& type = "MET_UCHAR") {
    return "ObjectType = Image\nNDims = 3\nDimSize = " + sizes + "\nElementType = " + type + "\n" + more +
           "ElementDataFile = LOCAL\n";
  }
  tests::ScratchFolder folder_;
  std::vector<float> ramp_ = std::vector<float>(60);
};

TEST_F(VolumeHeads, MetaImageInEveryTypeAndOrder) {
  const auto read = [&](const std::string& type, const std::string& more, const std::string& samples) {
    return read_volume(file("v.mha", mha(more, "5 4 3", type) + samples)).values;
  };
  EXPECT_EQ(read("MET_UCHAR", "", stored<std::uint8_t>(ramp_)), ramp_);
  EXPECT_EQ(read("MET_CHAR", "", stored<std::int8_t>(ramp_)), ramp_);
  for (const bool big : {false, true}) {
    const std::string order =
        std::string(big ? "ElementByteOrderMSB" : "BinaryDataByteOrderMSB") + " = " + (big ? "True" : "False") + "\n";
    EXPECT_EQ(read("MET_SHORT", order, stored<std::int16_t>(ramp_, big)), ramp_);
    EXPECT_EQ(read("MET_USHORT", order, stored<std::uint16_t>(ramp_, big)), ramp_);
    EXPECT_EQ(read("MET_INT", order, stored<std::int32_t>(ramp_, big)), ramp_);
    EXPECT_EQ(read("MET_UINT", order, stored<std::uint32_t>(ramp_, big)), ramp_);
    EXPECT_EQ(read("MET_FLOAT", order, stored<float>(ramp_, big)), ramp_);
    EXPECT_EQ(read("MET_DOUBLE", order, stored<double>(ramp_, big)), ramp_);
  }
  EXPECT_EQ(
      read("MET_UCHAR", "CompressedData = True\nCompressedDataSize = 1\n", gzipped(stored<std::uint8_t>(ramp_), 15)),
      ramp_);
  EXPECT_EQ(read("MET_UCHAR", "HeaderSize = -1\n", "junk" + stored<std::uint8_t>(ramp_)), ramp_);
  std::string text;
  for (const float v : ramp_) text += std::to_string(static_cast<int>(v)) + " ";
  EXPECT_EQ(read("MET_SHORT", "BinaryData = False\n", text), ramp_);
}

TEST_F(VolumeHeads, MetaImagesDetachedFilesAndUnits) {
  const std::string bytes = stored<std::uint8_t>(ramp_);
  const std::string head = "NDims = 3\nDimSize = 5 4 3\nElementType = MET_UCHAR\n";
  file("all.raw", "four" + bytes);
  for (std::size_t k = 0; k < 3; ++k) file("s" + std::to_string(k + 1) + ".raw", bytes.substr(20 * k, 20));
  EXPECT_EQ(read_volume(file("v.mhd", head + "HeaderSize = 4\nElementDataFile = all.raw\n")).values, ramp_);
  EXPECT_EQ(read_volume(file("v.mhd", head + "HeaderSize = -1\nElementDataFile = all.raw\n")).values, ramp_);
  EXPECT_EQ(read_volume(file("v.mhd", head + "ElementDataFile = s%d.raw 1 3 1\n")).values, ramp_);
  EXPECT_EQ(read_volume(file("v.mhd", head + "ElementDataFile = LIST\ns1.raw\ns2.raw\ns3.raw\n")).values, ramp_);
  const VolumeHead list = open_volume(folder_ / "v.mhd")->head();
  EXPECT_EQ(list.files.size(), 4u);
  EXPECT_FALSE(list.spacing_m);
  const auto spacing = [&](const std::string& more) { return read_volume(file("v.mha", mha(more) + bytes)).head; };
  EXPECT_NEAR(spacing("ElementSpacing = 0.5 0.5 0.7\n").spacing_m->z, 7e-4, 1e-12);
  EXPECT_FALSE(spacing("ElementSpacing = 1 1 1\nOffset = 1 2 3\n").spacing_m) << "MetaIO's default";
  EXPECT_NEAR(spacing("ElementSpacing = 1 1 1\nDistanceUnits = um\nOffset = 1 2 3\n").origin_m->z, 3e-6, 1e-15);
  const VolumeData scaled = read_volume(
      file("v.mha", mha("ElementToIntensityFunctionSlope = 2\nElementToIntensityFunctionOffset = -3\n") + bytes));
  EXPECT_EQ(scaled.values[10], 17);
}

TEST_F(VolumeHeads, BrokenMetaImagesAreRefusedInALine) {
  const std::string bytes = stored<std::uint8_t>(ramp_);
  EXPECT_EQ(refused(mha("") + bytes), "none");
  EXPECT_THAT(refused(mha("") + bytes.substr(1)),
              HasSubstr("bad: has 59 bytes of data where 60 are promised: truncated"));
  EXPECT_THAT(refused(mha("", "5 4") + bytes), HasSubstr("has 2 sizes in DimSize"));
  EXPECT_THAT(refused(mha("", "5 4 -3") + bytes), HasSubstr("claims -3 voxels a side"));
  EXPECT_THAT(refused(mha("", "100000 100000 100000") + bytes), HasSubstr("more than 2^46 bytes"));
  EXPECT_THAT(refused(mha("", "5 4 3", "MET_LONG_LONG") + bytes), HasSubstr("samples of type \"MET_LONG_LONG\""));
  EXPECT_THAT(refused(mha("ElementSpacing = 0.5 0 1\n") + bytes), HasSubstr("states a spacing of 0 along j"));
  EXPECT_THAT(refused(mha("ElementSpacing = 0.5 -0.5 1\n") + bytes), HasSubstr("states a spacing of -0.5 along j"));
  EXPECT_THAT(refused(mha("TransformMatrix = 1 0 0 0.1 0.99499 0 0 0 1\n") + bytes),
              HasSubstr("axes i and j that are not"));
  EXPECT_THAT(refused(mha("TransformMatrix = 2 0 0 0 1 0 0 0 1\n") + bytes), HasSubstr("an axis of length 2"));
  EXPECT_THAT(refused(mha("ElementNumberOfChannels = 3\n") + bytes), HasSubstr("has 3 channels a voxel"));
  EXPECT_THAT(refused("ObjectType = Tube\nNDims = 3\nElementDataFile = LOCAL\n"), HasSubstr("object of type \"Tube\""));
  EXPECT_THAT(refused("NDims = 2\nDimSize = 5 4\nElementDataFile = LOCAL\n"), HasSubstr("has 2 axes"));
  EXPECT_THAT(refused("NDims = 3\nDimSize = 5 4 3\n"), HasSubstr("has no ElementDataFile"));
  EXPECT_THAT(refused("NDims = 3\nDimSize = 5 4 3\nElementType = MET_UCHAR\nElementDataFile = LIST\n"),
              HasSubstr("empty LIST"));
  EXPECT_THAT(refused("NDims = 3\nDimSize = 5 4 3\nElementType = MET_UCHAR\nElementDataFile = /etc/passwd\n"),
              HasSubstr("samples outside its folder, in \"/etc/passwd\""));
  EXPECT_THAT(refused(mha("CompressedData = True\n") + gzipped(bytes.substr(0, 59), 15)),
              HasSubstr("ends after 59 inflated"));
}

std::string nifti(std::vector<std::pair<std::size_t, std::string>> changes = {}) {
  std::string head(352, '\0');
  store_at<std::int32_t>(head, 0, 348);
  for (const auto& [at, n] :
       std::vector<std::pair<std::size_t, int>>{{40, 3}, {42, 5}, {44, 4}, {46, 3}, {70, 2}, {72, 8}})
    store_at<std::int16_t>(head, at, static_cast<std::int16_t>(n));
  for (std::size_t a = 0; a < 4; ++a) store_at<float>(head, 76 + 4 * a, a == 3 ? 0.5f : 1.f);
  store_at<float>(head, 108, 352);
  head[123] = 2;
  head.replace(344, 4, std::string("n+1\0", 4));
  for (const auto& [at, bytes] : changes) head.replace(at, bytes.size(), bytes);
  return head;
}
std::string f32(float v) {
  std::string bytes(4, '\0');
  store_at(bytes, 0, v);
  return bytes;
}
std::string i16(int v) {
  std::string bytes(2, '\0');
  store_at(bytes, 0, static_cast<std::int16_t>(v));
  return bytes;
}

TEST_F(VolumeHeads, BrokenNiftiIsRefusedInALine) {
  const std::string bytes = stored<std::uint8_t>(ramp_);
  const auto with = [&](std::vector<std::pair<std::size_t, std::string>> changes) {
    return refused(nifti(changes) + bytes);
  };
  EXPECT_EQ(with({}), "none");
  EXPECT_EQ(read_volume(folder_ / "bad").values, ramp_);
  EXPECT_NEAR(read_volume(folder_ / "bad").head.spacing_m->z, 0.5e-3, 1e-12);
  EXPECT_EQ(with({{123, std::string(1, '\0')}}), "none");
  EXPECT_FALSE(read_volume(folder_ / "bad").head.spacing_m) << "unit 0 is unknown";
  EXPECT_THAT(refused(nifti() + bytes.substr(1)), HasSubstr("has 59 bytes of data where 60 are promised"));
  EXPECT_THAT(refused(gzipped(nifti() + bytes.substr(1))), HasSubstr("ends after 411 inflated bytes"));
  EXPECT_THAT(with({{46, i16(-3)}}), HasSubstr("claims -3 voxels a side"));
  EXPECT_THAT(with({{40, i16(4)}, {48, i16(2)}}), HasSubstr("has 2 volumes along axis 4"));
  EXPECT_THAT(with({{40, i16(0)}}), HasSubstr("has 0 axes"));
  EXPECT_THAT(with({{70, i16(128)}}), HasSubstr("datatype 128"));
  EXPECT_THAT(with({{72, i16(16)}}), HasSubstr("uint8 samples of 16 bits"));
  EXPECT_THAT(with({{108, f32(1e30f)}}), HasSubstr("samples begin at byte 1"));
  EXPECT_THAT(with({{108, f32(100)}}), HasSubstr("begin at byte 100, and from 352"));
  EXPECT_THAT(with({{88, f32(0)}}), HasSubstr("states a spacing of 0 along k"));
  EXPECT_THAT(with({{80, f32(std::nanf(""))}}), HasSubstr("states a spacing of nan along i"));
  EXPECT_THAT(with({{252, i16(1)}, {256, f32(2)}}), HasSubstr("a quaternion in its qform that turns nothing"));
  EXPECT_THAT(with({{254, i16(1)}, {280, f32(1)}, {300, f32(1)}, {320, f32(0.6f)}}),
              HasSubstr("1 x 1 x 0.5 in pixdim and of 1 x 1 x 0.6 in its sform"));
  EXPECT_THAT(
      with({{254, i16(1)}, {280, f32(0.8f)}, {284, f32(0.6f)}, {296, f32(0.6f)}, {300, f32(0.8f)}, {320, f32(0.5f)}}),
      HasSubstr("axes i and j that are not orthogonal"));
  EXPECT_THAT(with({{0, "\x1c\x02\0\0"}}), HasSubstr("bad: "));
  EXPECT_THAT(volume_refusal(file("bad", nifti({{344, std::string("ni1\0", 4)}})), {}, Exit::no_input),
              HasSubstr("bad: has its samples in an .img, which is not beside it"));
}

TEST_F(VolumeHeads, NiftiOfTwoFiles) {
  const std::string bytes = stored<std::uint8_t>(ramp_);
  const auto head = file("pair.hdr", nifti({{344, std::string("ni1\0", 4)}, {108, f32(3)}}));
  file("pair.img", "abc" + bytes);
  const VolumeData volume = read_volume(head);
  EXPECT_EQ(volume.values, ramp_);
  EXPECT_EQ(volume.head.files.back().filename(), "pair.img");
  file("pair.img", "abc" + bytes.substr(1));
  EXPECT_THAT(volume_refusal(head), HasSubstr("pair.img: has 59 bytes of data where 60 are promised"));
}

TEST_F(VolumeHeads, RawSamplesAreWhatTheWishSays) {
  const std::string bytes = "head" + stored<std::uint16_t>(ramp_, true);
  const VolumeWish wish{.size = {{5, 4, 3}}, .type = VoxelType::u16, .big_endian = true, .skip_bytes = 4};
  EXPECT_EQ(read_volume(file("v.raw", bytes), wish).values, ramp_);
  EXPECT_THAT(refused(bytes),
              HasSubstr("begins like no volume that gonio reads; where it holds raw samples, say --size"));
  VolumeWish wrong = wish;
  wrong.size = {{5, 4, 4}};
  EXPECT_THAT(refused(bytes, wrong),
              HasSubstr("has 124 bytes, and 5 x 4 x 4 voxels of uint16 behind the 4 skipped are 160"));
  wrong = wish;
  wrong.skip_bytes = 2;
  EXPECT_THAT(refused(bytes, wrong), HasSubstr("are 120"));
  wrong = wish;
  wrong.skip_bytes = std::numeric_limits<std::size_t>::max();
  EXPECT_THAT(refused(bytes, wrong), HasSubstr("are 120"));
  wrong = wish;
  wrong.size = {{std::size_t{1} << 62, 4, 4}};
  EXPECT_THAT(refused(bytes, wrong), HasSubstr("voxels a side"));
  wrong.size = {{0, 4, 4}};
  EXPECT_THAT(refused(bytes, wrong), HasSubstr("claims 0 voxels a side"));
  EXPECT_THAT(refused("", wish), HasSubstr("begins like no volume"));
  EXPECT_THAT(volume_refusal(folder_.path()), HasSubstr("holds no slices of a volume"));
}

TEST_F(VolumeHeads, BrokenNumPyArraysAreRefusedInALine) {
  const auto npy = [&](const std::string& descr, const std::string& shape, const std::string& data) {
    std::string head = "{'descr': '" + descr + "', 'fortran_order': True, 'shape': " + shape + ", }";
    head.resize(117, ' ');
    return std::string("\x93NUMPY\x01\0\x76\0", 10) + head + "\n" + data;
  };
  const std::string bytes = stored<std::uint8_t>(ramp_);
  EXPECT_EQ(refused(npy("|u1", "(3, 4, 5)", bytes)), "none");
  EXPECT_THAT(refused(npy("|u1", "(3, 4, 6)", bytes)), HasSubstr("has 60 bytes of data where its head makes 72"));
  EXPECT_THAT(refused(npy("|u1", "(12, 5)", bytes)), HasSubstr("has 2 axes"));
  EXPECT_THAT(refused(npy("<i8", "(3, 4, 5)", bytes)), HasSubstr("NumPy's type i8"));
  EXPECT_THAT(refused(npy("|u1", "(0, 4, 5)", "")), HasSubstr("claims 0 voxels a side"));
  EXPECT_THAT(refused(npy("|u1", "(999999999, 999999999, 9)", bytes)), HasSubstr("more numbers than a file can hold"));
  EXPECT_THAT(refused("\x93NUMPY"), HasSubstr("is no NumPy array"));
}

std::string tiff_bytes(const std::vector<cv::Mat>& pages, int compression = 1) {
  const tests::ScratchFolder folder;
  cv::imwritemulti((folder / "t.tif").string(), pages, {cv::IMWRITE_TIFF_COMPRESSION, compression});
  return read_file(folder / "t.tif");
}

TEST_F(VolumeHeads, TiffPagesAndFoldersOfSlices) {
  std::vector<cv::Mat> pages;
  for (int k = 0; k < 3; ++k) pages.emplace_back(cv::Mat(4, 5, CV_32F, ramp_.data() + 20 * k));
  for (const int compression : {1, 5, 8, 32773})
    EXPECT_EQ(read_volume(file("v.tif", tiff_bytes(pages, compression))).values, ramp_);
  const std::string whole = tiff_bytes(pages);
  for (std::size_t length = 0; length < whole.size(); length += 5)
    EXPECT_NE(refused(whole.substr(0, length)), "none") << length << " of " << whole.size();
  EXPECT_THAT(refused(tiff_bytes({pages[0], cv::Mat(3, 5, CV_32F, cv::Scalar(1))})),
              HasSubstr("has a slice of 5 x 3 float32, and the first one has 5 x 4 float32"));
  EXPECT_THAT(refused(tiff_bytes({cv::Mat(4, 5, CV_8UC3, cv::Scalar(1, 2, 3))})), HasSubstr("has pages in colours"));
  EXPECT_THAT(refused(tiff_bytes({cv::Mat(16, 16, CV_8U, cv::Scalar(1))}, 7)),
              HasSubstr("compressed by JPEG, which has lost"));
  pages[1].at<float>(2, 3) = NAN;
  EXPECT_THAT(refused(tiff_bytes(pages)), HasSubstr("bad#slice 1: sample (3, 2) is no number"));

  const auto slices = folder_ / "slices";
  std::filesystem::create_directory(slices);
  for (int k = 0; k < 3; ++k) {
    cv::Mat codes(4, 5, CV_16U, cv::Scalar(1000 * k + 7));
    cv::imwrite((slices / ("cut_" + std::to_string(9 + k) + ".png")).string(), codes);
  }
  const VolumeData png = read_volume(slices);
  EXPECT_EQ(png.head.type, VoxelType::u16);
  EXPECT_EQ(png.at(4, 3, 2), 2007);
  EXPECT_EQ(png.at(0, 0, 0), 7) << "9 comes before 10";
  cv::imwrite((slices / "cut_13.png").string(), cv::Mat(4, 5, CV_16U, cv::Scalar(1)));
  EXPECT_THAT(volume_refusal(slices), HasSubstr("has no slice between cut_11.png and cut_13.png, where others are "
                                                "numbered in steps of 1"));
  std::filesystem::remove(slices / "cut_13.png");
  cv::imwrite((slices / "cut_12.png").string(), cv::Mat(4, 6, CV_16U, cv::Scalar(1)));
  EXPECT_THAT(volume_refusal(slices), HasSubstr("cut_12.png: has a slice of 6 x 4 uint16"));
  write_file(slices / "other.tif", whole);
  EXPECT_THAT(volume_refusal(slices), HasSubstr("holds TIFFs (other.tif) and other pictures"));
  EXPECT_THAT(refused("\xff\xd8\xff\xe0", {.tiles = {{2, 2}}}), HasSubstr("bad: "));
}

}  // namespace
}  // namespace gonio::io
