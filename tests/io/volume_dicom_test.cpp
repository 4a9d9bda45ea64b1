// DICOM: recorded files against figures of pydicom with GDCM; series put together byte by byte; broken ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>

#include "io/csv.h"
#include "io/dicom_codec.h"
#include "io/dicom_pixels.h"
#include "io/little_endian.h"
#include "io/volume_fixtures.h"

namespace gonio::io {
namespace {

using testing::HasSubstr;

const std::filesystem::path recorded = tests::data("ct/dicom_format");

// Alone in a folder of its own: a file's series is taken from its folder.
VolumeData alone(const std::string& name) {
  const tests::ScratchFolder folder;
  std::filesystem::copy_file(recorded / name, folder / name);
  return read_volume(folder / name);
}

std::string refused_alone(const std::string& name) {
  const tests::ScratchFolder folder;
  std::filesystem::copy_file(recorded / name, folder / name);
  return volume_refusal(folder / name);
}

struct Expected {
  const char* name;
  std::array<std::size_t, 3> size;
  VoxelType type;
  double lowest, highest, mean;  // before slope and intercept
};

// JFIF 85.82 and Adobe's segment with a transform nobody knows: nothing that the pixels need.
TEST(VolumeDicom, WhatApplicationsPutIntoAJpegIsPassedOver) {
  const tests::ScratchFolder folder;
  const std::filesystem::path own = std::filesystem::path(GONIO_SOURCE) / "tests/io/data/volumes/dicom/slice5.dcm";
  std::string bytes = read_file(own);
  const std::size_t jfif = bytes.find(std::string("JFIF\0", 5));
  ASSERT_NE(jfif, std::string::npos);
  write_file(folder / "plain.dcm", bytes);
  const VolumeData plain = read_volume(folder / "plain.dcm");
  std::filesystem::remove(folder / "plain.dcm");
  bytes[jfif + 5] = 0x55, bytes[jfif + 6] = 0x52;
  write_file(folder / "jfif.dcm", bytes);
  EXPECT_EQ(read_volume(folder / "jfif.dcm").values, plain.values);
  std::filesystem::remove(folder / "jfif.dcm");
  // The segment of 16 bytes becomes Adobe's of 14 (12 after its length) and two bytes of fill.
  std::string adobe(
      "\xff\xee\0\x0e"
      "Adobe\0\x65\0\0\0\0\x7f",
      16);
  bytes.replace(jfif - 4, 18, adobe + "\xff\xff");
  write_file(folder / "adobe.dcm", bytes);
  EXPECT_EQ(read_volume(folder / "adobe.dcm").values, plain.values);
  std::filesystem::remove(folder / "adobe.dcm");
  bytes[jfif - 3] = 0;  // a marker that there is not
  write_file(folder / "none.dcm", bytes);
  EXPECT_EQ(read_volume(folder / "none.dcm").values, plain.values);
}

// expected.csv beside the set: python3-pydicom with GDCM.
TEST(VolumeDicom, EveryRecordedSyntaxHasThePixelsOfPydicom) {
  GONIO_NEEDS_DATA("ct/dicom_format/expected.csv");
  const Expected all[] = {{"CT_small.dcm", {128, 128, 1}, VoxelType::i16, 128, 2191, 904.9261},
                          {"MR_small.dcm", {64, 64, 1}, VoxelType::i16, 127, 2145, 518.8813},
                          {"MR_small_RLE.dcm", {64, 64, 1}, VoxelType::i16, 127, 2145, 518.8813},
                          {"MR_small_bigendian.dcm", {64, 64, 1}, VoxelType::i16, 127, 2145, 518.8813},
                          {"MR_small_expb.dcm", {64, 64, 1}, VoxelType::i16, 127, 2145, 518.8813},
                          {"MR_small_implicit.dcm", {64, 64, 1}, VoxelType::i16, 127, 2145, 518.8813},
                          {"MR_small_jp2klossless.dcm", {64, 64, 1}, VoxelType::i16, 127, 2145, 518.8813},
                          {"MR_small_jpeg_ls_lossless.dcm", {64, 64, 1}, VoxelType::i16, 127, 2145, 518.8813},
                          {"MR_small_padded.dcm", {64, 64, 1}, VoxelType::i16, 127, 2145, 518.8813},
                          {"J2K_pixelrep_mismatch.dcm", {512, 512, 1}, VoxelType::i16, -2000, 1896, -658.4368},
                          {"rtdose.dcm", {10, 10, 15}, VoxelType::u32, 795000, 1254000, 1013273.3333},
                          {"rtdose_rle.dcm", {10, 10, 15}, VoxelType::u32, 795000, 1254000, 1013273.3333}};
  std::vector<float> mr;
  for (const Expected& expected : all) {
    SCOPED_TRACE(expected.name);
    const VolumeData volume = alone(expected.name);
    EXPECT_EQ(volume.head.size, expected.size);
    EXPECT_EQ(volume.head.type, expected.type);
    double sum = 0, lowest = 1e30, highest = -1e30;
    for (const float value : volume.values) {
      const double stored = (value - volume.head.intercept) / volume.head.slope;
      sum += stored, lowest = std::min(lowest, stored), highest = std::max(highest, stored);
    }
    EXPECT_EQ(lowest, expected.lowest);
    EXPECT_EQ(highest, expected.highest);
    EXPECT_NEAR(sum / static_cast<double>(volume.values.size()), expected.mean, 5.1e-5);
    if (!std::string(expected.name).starts_with("MR_small")) continue;
    if (mr.empty()) mr = volume.values;
    EXPECT_EQ(volume.values, mr);
  }
}

TEST(VolumeDicom, SlopeInterceptAndMeaningOfACt) {
  GONIO_NEEDS_DATA("ct/dicom_format/CT_small.dcm");
  const VolumeData ct = alone("CT_small.dcm");
  EXPECT_EQ(ct.head.intercept, -1024);
  EXPECT_EQ(ct.head.value, "hounsfield");
  EXPECT_EQ(*std::min_element(ct.values.begin(), ct.values.end()), 128 - 1024);
  ASSERT_TRUE(ct.head.spacing_m);  // one slice, which states SpacingBetweenSlices
  EXPECT_NEAR(ct.head.spacing_m->x, 0.661468e-3, 1e-12);
  EXPECT_NEAR(ct.head.spacing_m->z, 5e-3, 1e-12);
  const VolumeData mr = alone("MR_small.dcm");
  EXPECT_FALSE(mr.head.spacing_m) << "a slice alone has no distance to the next";
  EXPECT_EQ(mr.head.spacing_note, "0.3125 x 0.3125 mm in its slices");
  EXPECT_EQ(mr.head.value, "");
  const VolumeData dose = alone("rtdose.dcm");
  ASSERT_TRUE(dose.head.spacing_m);  // GridFrameOffsetVector
  EXPECT_NEAR(dose.head.spacing_m->z, 5e-3, 1e-12);
  EXPECT_NEAR(dose.head.origin_m->z, -0.76187, 1e-9);
}

TEST(VolumeDicom, SlicesAreSortedByTheirPlaces) {
  GONIO_NEEDS_DATA("ct/dicom_format/98892001_CT5N_2062.dcm");
  const auto source = open_volume(recorded / "98892001_CT5N_2392.dcm");  // its series among all the others
  const VolumeHead& head = source->head();
  EXPECT_EQ(head.size, (std::array<std::size_t, 3>{16, 16, 5}));
  ASSERT_TRUE(head.spacing_m && head.origin_m && head.axes);
  EXPECT_NEAR(head.spacing_m->z, 2.5e-3, 1e-12);
  EXPECT_NEAR(head.spacing_m->x, 0.488281e-3, 1e-12);
  EXPECT_NEAR(head.origin_m->z, -1.2375e-3, 1e-12);
  const double means[] = {955.2734, 986.1055, 981.1719, 835.0781, 669.7148};  // from the lowest up, by name backwards
  std::vector<float> slice(256);
  for (std::size_t k = 0; k < 5; ++k) {
    source->read(k, 1, slice);
    EXPECT_NEAR(std::accumulate(slice.begin(), slice.end(), 0.0) / 256, means[k] - 1024, 1e-3) << k;
  }
  EXPECT_EQ(head.files[0].filename(), "98892001_CT5N_3353.dcm");
  EXPECT_EQ(head.value, "hounsfield");
}

TEST(VolumeDicom, AMissingSliceIsNotClosed) {
  GONIO_NEEDS_DATA("ct/dicom_format/77654033_CT2_17106.dcm");
  const auto file = recorded / "77654033_CT2_17136.dcm";
  const std::string words = volume_refusal(file);
  EXPECT_THAT(words, HasSubstr("has a gap of 202.5 mm between slices 1 and 2 (77654033_CT2_17106.dcm, "
                               "77654033_CT2_17136.dcm), where 1.25 mm are usual; add what is missing, or take the 3 "
                               "slices of the longest equal row with --accept-gap"));
  const VolumeData rest = read_volume(file, {.accept_gap = true});
  EXPECT_EQ(rest.head.size[2], 3u);
  EXPECT_NEAR(rest.head.spacing_m->z, 1.25e-3, 1e-12);
  EXPECT_NEAR(rest.head.origin_m->z, 0.10302, 1e-6);
}

TEST(VolumeDicom, RecordedFaultsAreRefusedInWords) {
  GONIO_NEEDS_DATA("ct/dicom_format/MR_truncated.dcm");
  EXPECT_THAT(refused_alone("MR_truncated.dcm"),
              HasSubstr("MR_truncated.dcm: has 8130 bytes of pixels where 8192 are stated: truncated"));
  EXPECT_THAT(refused_alone("meta_missing_tsyntax.dcm"), HasSubstr("names no transfer syntax (0002,0010)"));
  EXPECT_THAT(refused_alone("JPEG-lossy.dcm"), HasSubstr("is stored as JPEG extended, which loses what was measured"));
  EXPECT_THAT(refused_alone("JPEG2000.dcm"), HasSubstr("is stored as JPEG 2000, which loses what was measured"));
  EXPECT_THAT(refused_alone("ExplVR_BigEnd.dcm"), HasSubstr("has 3 samples a pixel (RGB)"));
  // Among its series, a truncated slice is not passed over; the folder holds many series; two slices at one place.
  EXPECT_THAT(volume_refusal(recorded / "MR_small.dcm"), HasSubstr(".dcm: "));
  const tests::ScratchFolder folder;
  for (const char* name : {"MR_small.dcm", "MR_small_RLE.dcm"})
    std::filesystem::copy_file(recorded / name, folder / name);
  EXPECT_THAT(volume_refusal(folder / "MR_small.dcm"),
              HasSubstr("has two slices at one place, MR_small.dcm and MR_small_RLE.dcm"));
  std::filesystem::copy_file(recorded / "CT_small.dcm", folder / "CT_small.dcm");
  EXPECT_THAT(volume_refusal(folder.path()), HasSubstr("holds 2 series: CT_small.dcm begins one of 1, MR_small.dcm"));
  EXPECT_EQ(volume_refusal(folder / "CT_small.dcm"), "none");
}

// Files put together here, explicit and little endian.
template <class T>
std::string number_bytes(T value) {
  std::string bytes(sizeof value, '\0');
  store_at(bytes, 0, value);
  return bytes;
}
std::string element(unsigned group, unsigned number, const std::string& type, std::string value) {
  if (value.size() % 2 == 1) value += type == "UI" ? '\0' : ' ';
  const std::string tag = number_bytes<std::uint16_t>(static_cast<std::uint16_t>(group)) +
                          number_bytes<std::uint16_t>(static_cast<std::uint16_t>(number)) + type;
  if (type == "OW" || type == "OB" || type == "SQ")
    return tag + std::string(2, '\0') + number_bytes<std::uint32_t>(static_cast<std::uint32_t>(value.size())) + value;
  return tag + number_bytes<std::uint16_t>(static_cast<std::uint16_t>(value.size())) + value;
}
std::string small(unsigned group, unsigned number, std::uint16_t value) {
  return element(group, number, "US", number_bytes(value));
}

struct Slice {
  double z = 0;
  std::string position{}, directions = "1\\0\\0\\0\\1\\0", spacing = "0.5\\0.25", slope = "2", series = "1.2.3";
  std::string syntax = "1.2.840.10008.1.2.1", more{};
  std::uint16_t rows = 3, columns = 4, bits = 16, stored = 12, sign = 0, samples = 1;
  std::uint16_t first = 0;  // pixels first, first + 1, ...
};
std::string dicom_bytes(const Slice& s) {
  std::string pixels;
  for (std::uint16_t n = 0; n < 12; ++n) pixels += number_bytes<std::uint16_t>(static_cast<std::uint16_t>(s.first + n));
  // A sequence of unknown length with an item of unknown length in it, to be passed over.
  const std::string sequence = std::string("\x08\x00\x40\x11SQ\0\0\xff\xff\xff\xff", 12) +
                               std::string("\xfe\xff\x00\xe0\xff\xff\xff\xff", 8) +
                               element(0x28, 0x10, "US", number_bytes<std::uint16_t>(77)) +
                               std::string("\xfe\xff\x0d\xe0\0\0\0\0", 8) + std::string("\xfe\xff\xdd\xe0\0\0\0\0", 8);
  return std::string(128, '\0') + "DICM" + element(2, 0x10, "UI", s.syntax) + sequence +
         element(0x20, 0x0e, "UI", s.series) +
         element(0x20, 0x32, "DS", s.position.empty() ? "10\\20\\" + std::to_string(s.z) : s.position) +
         (s.directions.empty() ? "" : element(0x20, 0x37, "DS", s.directions)) + small(0x28, 2, s.samples) +
         small(0x28, 0x10, s.rows) + small(0x28, 0x11, s.columns) + element(0x28, 0x30, "DS", s.spacing) +
         small(0x28, 0x100, s.bits) + small(0x28, 0x101, s.stored) +
         small(0x28, 0x102, static_cast<std::uint16_t>(s.stored - 1)) + small(0x28, 0x103, s.sign) +
         element(0x28, 0x1052, "DS", "-5") + element(0x28, 0x1053, "DS", s.slope) + s.more +
         element(0x7fe0, 0x10, "OW", pixels);
}

class DicomSeries : public testing::Test {
 protected:
  tests::ScratchFolder folder_;
  // Named against their order.
  std::string refused(std::vector<Slice> slices, const VolumeWish& wish = {}) {
    write(slices);
    return volume_refusal(folder_.path(), wish);
  }
  void write(const std::vector<Slice>& slices) {
    for (const auto& old : std::filesystem::directory_iterator(folder_.path())) std::filesystem::remove(old);
    for (std::size_t n = 0; n < slices.size(); ++n)
      write_file(folder_ / ("s" + std::to_string(9 - n) + ".dcm"), dicom_bytes(slices[n]));
  }
};

TEST_F(DicomSeries, IsPutTogether) {
  write({{.z = 1, .first = 100}, {.z = 1.5, .first = 200}, {.z = 2, .first = 4090}});
  const VolumeData volume = read_volume(folder_.path());
  EXPECT_EQ(volume.head.size, (std::array<std::size_t, 3>{4, 3, 3}));
  EXPECT_EQ(volume.head.type, VoxelType::u16);
  EXPECT_EQ(volume.at(1, 0, 0), 2 * 101 - 5);
  EXPECT_EQ(volume.at(0, 1, 1), 2 * 204 - 5);
  EXPECT_EQ(volume.at(2, 1, 2), 2 * 0 - 5) << "4096 is bit 12, which is not stored";
  EXPECT_NEAR(volume.head.spacing_m->x, 0.25e-3, 1e-12) << "the second of PixelSpacing lies between columns";
  EXPECT_NEAR(volume.head.spacing_m->y, 0.5e-3, 1e-12);
  EXPECT_NEAR(volume.head.spacing_m->z, 0.5e-3, 1e-12);
  EXPECT_NEAR(volume.head.origin_m->z, 1e-3, 1e-12);
  EXPECT_EQ(volume.head.value, "");
  // Columns along -y: the normal points along -z, and so do the slices.
  write({{.z = 1, .directions = "1\\0\\0\\0\\-1\\0", .first = 1},
         {.z = 2, .directions = "1\\0\\0\\0\\-1\\0", .first = 50}});
  const VolumeData down = read_volume(folder_.path());
  EXPECT_EQ(down.at(0, 0, 0), 2 * 50 - 5);
  EXPECT_NEAR(down.head.origin_m->z, 2e-3, 1e-12);
  EXPECT_EQ((*down.head.axes)(2, 2), -1);
  write({{.z = 1, .stored = 12, .sign = 1, .first = 2048}, {.z = 2, .sign = 1}});
  EXPECT_EQ(read_volume(folder_.path()).at(0, 0, 0), 2 * -2048 - 5);
  write({{.z = 1, .slope = "2"}, {.z = 2, .slope = "3"}});  // each its own
  const VolumeData scaled = read_volume(folder_.path());
  EXPECT_EQ(scaled.at(3, 0, 1), 3 * 3 - 5);
  EXPECT_EQ(scaled.head.slope, 1);
}

TEST_F(DicomSeries, WhatIsNoGridIsRefused) {
  const Slice a{.z = 1}, b{.z = 2}, c{.z = 3};
  EXPECT_EQ(refused({a, b, c}), "none");
  EXPECT_THAT(refused({a, b, c, {.z = 6}}),
              HasSubstr("has a gap of 3 mm between slices 3 and 4 (s7.dcm, s6.dcm), where "
                        "1 mm are usual"));
  EXPECT_THAT(refused({a, b, {.z = 2}}), HasSubstr("has two slices at one place, s7.dcm and s8.dcm"));
  EXPECT_THAT(refused({a, {.z = 2, .spacing = "0.5\\0.5"}}),
              HasSubstr("s9.dcm: has a spacing of pixels of 0.25 x 0.5 mm, and s8.dcm of its series 0.5 x 0.5 mm"));
  EXPECT_THAT(refused({a, {.z = 2, .directions = "0.8\\0.6\\0\\-0.6\\0.8\\0"}}),
              HasSubstr("has rows along (1, 0, 0), and s8.dcm of its series (0.8, 0.6, 0)"));
  EXPECT_THAT(refused({a, {.z = 2, .rows = 4, .columns = 3}}),
              HasSubstr("has pixels 4 x 3, and s8.dcm of its series 3 x 4"));
  EXPECT_THAT(refused({a, {.z = 2, .sign = 1}}), HasSubstr("has samples uint16, and s8.dcm of its series int16"));
  EXPECT_THAT(refused({a, {.z = 2, .series = "1.2.4"}}), HasSubstr("holds 2 series"));
  EXPECT_THAT(refused({a, {.position = "10\\20.3\\2"}, {.position = "10\\20.6\\3"}}), HasSubstr("a tilted gantry?"));
  EXPECT_THAT(refused({{.z = 1, .directions = "1\\0\\0\\0.6\\0.8\\0"}, {.z = 2, .directions = "1\\0\\0\\0.6\\0.8\\0"}}),
              HasSubstr("has axes i and j that are not orthogonal (53.13 degrees"));
  EXPECT_THAT(refused({a, {.z = 2, .directions = ""}}), HasSubstr("does not state its place and directions"));
  EXPECT_THAT(refused({a, {.z = 2, .spacing = "0\\0.25"}}), HasSubstr("spacing"));
  EXPECT_THAT(refused({{.z = 1, .spacing = "0\\0.25"}, {.z = 2, .spacing = "0\\0.25"}}),
              HasSubstr("states a spacing of 0 along j"));
  EXPECT_THAT(refused({{.z = 1, .syntax = "1.2.840.10008.1.2.4.91"}}), HasSubstr("JPEG 2000, which loses"));
  EXPECT_THAT(refused({{.z = 1, .syntax = "1.2.3.4"}}), HasSubstr("transfer syntax 1.2.3.4, which is not read"));
  EXPECT_THAT(refused({{.z = 1, .syntax = "1.2.840.10008.1.2.5"}}), HasSubstr("its pixels are not in fragments"));
  EXPECT_THAT(refused({{.z = 1, .more = element(0x28, 0x2110, "CS", "01")}}),
              HasSubstr("was compressed with loss before"));
  EXPECT_THAT(refused({{.z = 1, .rows = 300}}), HasSubstr("has 24 bytes of pixels where its head promises 2400"));
  EXPECT_THAT(refused({{.z = 1, .rows = 65535, .columns = 65535, .bits = 32}}), HasSubstr("promises 17179344900"));
  EXPECT_THAT(refused({{.z = 1, .samples = 3}}), HasSubstr("has 3 samples a pixel"));
  EXPECT_THAT(refused({{.z = 1, .bits = 12}}), HasSubstr("has pixels of 12 bits"));
  EXPECT_THAT(refused({{.z = 1, .stored = 17}}), HasSubstr("has 17 bits up to bit 16"));
  EXPECT_THAT(refused({{.z = 1, .slope = "0"}}), HasSubstr("a slope of 0"));
  EXPECT_THAT(refused({{.z = 1, .slope = "two"}}), HasSubstr("has \"two\" in (0028,1053), which are no numbers"));
  EXPECT_THAT(refused({{.z = 1, .more = element(0x28, 8, "IS", "0")}}), HasSubstr("claims 0 frames"));
  EXPECT_THAT(refused({a, b}, {.spacing_m = Vec3{1e-3, 1e-3, 1e-3}}),
              HasSubstr("states a spacing of 0.25 x 0.5 x 1 mm, and --voxel says 1 x 1 x 1 mm"));
  const std::string whole = dicom_bytes(a);
  for (std::size_t length = 140; length < whole.size(); length += 7) {
    write_file(folder_ / "s9.dcm", whole.substr(0, length));
    EXPECT_NE(volume_refusal(folder_ / "s9.dcm"), "none") << length;
  }
}

// Codecs say on the stream of errors what they think of a stream; the refusal is one line, ours.
TEST(VolumeDicom, ABrokenCompressedStreamIsRefusedWithoutAWordOfTheCodec) {
  DicomFile file;
  file.path = "x.dcm", file.rows = file.columns = 16, file.bits_allocated = file.bits_stored = 16;
  using namespace std::string_literals;
  const std::string zeros(64, '\0');
  const std::string broken[] = {"rubbish", "\xff\xd8\xff\xc3\x00\x0b\x10\x00\x10\x00\x10\x01\x01\x11\x00"s + zeros,
                                "\xff\xd8\xff\xf7\x00\x0b\x10\x00\x10\x00\x10\x01\x01\x11\x00"s + zeros,
                                "\xff\x4f\xff\x51\x00\x29\x00\x00\x00\x00\x00\x10\x00\x00\x00\x10"s + zeros,
                                "\x00\x00\x00\x0cjP  \x0d\x0a\x87\x0a"s + zeros};
  for (const DicomPixels pixels : {DicomPixels::jpeg_lossless, DicomPixels::jpeg_ls, DicomPixels::jpeg_2000})
    for (const std::string& stored : broken) {
      file.pixels = pixels;
      testing::internal::CaptureStderr();
      EXPECT_THROW(decode_by_gdcm(file, stored, 16, true), Error);
      EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << static_cast<int>(pixels);
    }
}

TEST(DicomRuns, AsTheStandardHasThem) {
  // PS3.5, G.3.1: n of 0 to 127 copies n + 1 bytes, -1 to -127 repeats the next 1 - n times, -128 does nothing.
  const auto head = [](std::uint32_t segments) {
    return number_bytes(segments) + number_bytes<std::uint32_t>(64) + number_bytes<std::uint32_t>(68) +
           std::string(52, '\0');
  };
  const std::string runs = head(2) + std::string("\x80\xfd\x01\x00", 4) +
                           std::string(
                               "\x03"
                               "abcd",
                               5);
  EXPECT_EQ(decode_run_lengths(runs, 4, 2, "t"), std::string("a\x01"
                                                             "b\x01"
                                                             "c\x01"
                                                             "d\x01",
                                                             8));
  EXPECT_THROW(decode_run_lengths(runs, 5, 2, "t"), Error);
  EXPECT_THROW(decode_run_lengths(runs, 4, 1, "t"), Error);
  EXPECT_THROW(decode_run_lengths(runs.substr(0, 70), 4, 2, "t"), Error);
}

}  // namespace
}  // namespace gonio::io
