// Height maps in containers: ISO 25178-72 archives put together here byte by byte, OpenEXR and TIFF; forged and damaged
// ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <regex>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "io/exr.h"
#include "io/height_map.h"
#include "io/little_endian.h"
#include "io/md5.h"
#include "io/random_map.h"

namespace gonio::io {
namespace {

using testing::HasSubstr;

std::string refusal(const std::string& bytes, const HeightPicture& picture = {}) {
  try {
    parse_height_map(bytes, "t.x3p", picture);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data);
    return error.problem();
  }
  return "none";
}

template <class T>
std::string bytes_of(T value) {
  std::string bytes(sizeof value, '\0');
  store_at(bytes, 0, value);
  return bytes;
}
std::string u16(unsigned value) {
  return bytes_of(static_cast<std::uint16_t>(value));
}
std::string u32(std::size_t value) {
  return bytes_of(static_cast<std::uint32_t>(value));
}

std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = ~0u;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int k = 0; k < 8; ++k) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

// An archive of files as they are, nothing squeezed. `claims`: the size that the last one states instead of its own.
std::string archive(const std::vector<std::pair<std::string, std::string>>& files, std::size_t claims = 0) {
  std::string body, directory;
  for (const auto& [name, text] : files) {
    const std::size_t size = claims > 0 && &text == &files.back().second ? claims : text.size();
    const std::string head = u16(20) + u16(0) + u16(0) + u16(0) + u16(0x21) + u32(crc32(text)) + u32(text.size()) +
                             u32(size) + u16(static_cast<unsigned>(name.size())) + u16(0);
    directory += "PK\x01\x02" + u16(20) + head + u16(0) + u16(0) + u16(0) + u32(0) + u32(body.size()) + name;
    body += "PK\x03\x04" + head + name + text;
  }
  const auto n = static_cast<unsigned>(files.size());
  return body + directory + "PK\x05\x06" + u16(0) + u16(0) + u16(n) + u16(n) + u32(directory.size()) +
         u32(body.size()) + u16(0);
}

struct Parts {
  std::string type = "I", width = "3", height = "2", step = "2e-6",
              z = "<Increment>1e-9</Increment><Offset>5e-9</Offset>", sum{}, mask_name{};
};
std::string xml(const Parts& p) {
  return "<?xml version=\"1.0\"?><p:ISO5436_2 "
         "xmlns:p=\"http://www.opengps.eu/2008/ISO5436_2\"><Record1><FeatureType>SUR"
         "</FeatureType><Axes><CX><AxisType>I</AxisType><Increment>" +
         p.step +
         "</Increment></CX><CY><AxisType>I</AxisType><Increment> 3e-6 </Increment></CY><CZ><AxisType>A"
         "</AxisType><DataType>" +
         p.type + "</DataType>" + p.z + "</CZ></Axes></Record1><Record3><MatrixDimension><SizeX>" + p.width +
         "</SizeX><SizeY>" + p.height +
         "</SizeY><SizeZ>1</SizeZ></MatrixDimension><DataLink><PointDataLink>"
         "bindata/data.bin</PointDataLink><MD5ChecksumPointData>" +
         p.sum + "</MD5ChecksumPointData>" +
         (p.mask_name.empty() ? "" : "<ValidPointsLink>" + p.mask_name + "</ValidPointsLink>") +
         "</DataLink></Record3></p:ISO5436_2>";
}

template <class T>
std::string matrix(std::vector<T> values) {
  std::string bytes;
  for (const T v : values) bytes += bytes_of(v);
  return bytes;
}

TEST(Md5, OfTheRfc) {
  EXPECT_EQ(md5(""), "d41d8cd98f00b204e9800998ecf8427e");
  EXPECT_EQ(md5("message digest"), "f96b697d7cb7938d525a2f31aaf161d0");
  EXPECT_EQ(md5("12345678901234567890123456789012345678901234567890123456789012345678901234567890"),
            "57edf4a22be3c955ac49da2e2107b67a");
}

TEST(X3p, EveryTypeOfNumberAndTheMask) {
  const std::string integers = matrix<std::int16_t>({0, 1, -2, 300, 4, 5});
  const HeightMap i = parse_height_map(archive({{"main.xml", xml({.mask_name = "bindata/valid.bin"})},
                                                {"bindata/data.bin", integers},
                                                {"bindata/valid.bin", "\x2f"}}),
                                       "t");
  ASSERT_EQ(i.width, 3u);
  ASSERT_EQ(i.height, 2u);
  EXPECT_DOUBLE_EQ(i.step_x_m, 2e-6);
  EXPECT_DOUBLE_EQ(i.step_y_m, 3e-6);
  EXPECT_NEAR(i.at(2, 0), 3e-9, 1e-20);
  EXPECT_NEAR(i.at(0, 1), 305e-9, 1e-20);
  EXPECT_TRUE(std::isnan(i.at(1, 1)));  // bit 4 of 101111
  EXPECT_NEAR(i.at(2, 1), 10e-9, 1e-20);
  const auto read = [](const std::string& type, const std::string& points) {
    return parse_height_map(
        archive({{"main.xml", xml({.type = type, .z = "", .sum = md5(points)})}, {"bindata/data.bin", points}}), "t");
  };
  EXPECT_EQ(read("L", matrix<std::int32_t>({0, 0, 0, 0, 0, -7})).at(2, 1), -7);
  EXPECT_EQ(read("F", matrix<float>({0, 0, 0, 0.25f, 0, 0})).at(0, 1), 0.25);
  const HeightMap d = read("D", matrix<double>({1e-7, 0, std::nan(""), 0, 0, 0}));
  EXPECT_EQ(d.at(0, 0), 1e-7);
  EXPECT_TRUE(std::isnan(d.at(2, 0)));
}

TEST(X3p, ForgedAndDamagedArchivesAreRefusedInALine) {
  const std::string points = matrix<std::int16_t>({0, 1, -2, 300, 4, 5});
  const auto with = [&](const Parts& p) {
    return refusal(archive({{"main.xml", xml(p)}, {"bindata/data.bin", points}}));
  };
  EXPECT_EQ(with({}), "none");
  EXPECT_THAT(with({.type = "D"}), HasSubstr("has 12 bytes in bindata/data.bin where its points are 48"));
  EXPECT_THAT(with({.type = "X"}), HasSubstr("stores its heights as \"X\""));
  EXPECT_THAT(with({.width = "30000", .height = "30000"}), HasSubstr("where its points are 1800000000"));
  EXPECT_THAT(with({.width = "40000"}), HasSubstr("claims 40000 x 2 points"));
  EXPECT_THAT(with({.width = "-3"}), HasSubstr("points, between 2 and"));
  EXPECT_THAT(with({.step = "0"}), HasSubstr("no step between points along x"));
  EXPECT_THAT(with({.step = "two"}), HasSubstr("states \"two\" as its increment"));
  EXPECT_THAT(with({.sum = md5("other")}), HasSubstr("has points whose checksum is another"));
  EXPECT_THAT(with({.mask_name = "valid.bin"}), HasSubstr("has no file \"valid.bin\""));
  EXPECT_THAT(refusal(archive({{"main.xml", "<p:ISO5436_2>"}})), HasSubstr("no XML"));
  EXPECT_THAT(refusal(archive({{"main.xml", "<other/>"}})),
              HasSubstr("no Record1/Axes in its main.xml, whose root is \"other\""));
  EXPECT_THAT(refusal(archive({{"picture.png", "x"}})), HasSubstr("has no file \"main.xml\""));
  // what an archive claims is not allocated
  EXPECT_NE(refusal(archive({{"bindata/data.bin", points}, {"main.xml", xml({})}}, 0xfffffff0u)), "none");
  const std::string good = archive({{"main.xml", xml({})}, {"bindata/data.bin", points}});
  for (std::size_t length = 4; length < good.size(); length += 61)
    EXPECT_NE(refusal(good.substr(0, length)), "none") << length;
  std::string flipped = good;  // the archive's own checksum tells
  flipped[good.find("PK\x01\x02") - 5] ^= 1;
  EXPECT_THAT(refusal(flipped), HasSubstr("damaged"));
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

// What writers do differently and readers of theirs take: the same heights from each.
TEST(X3p, VariantsOfOneMap) {
  const std::string points = matrix<std::int16_t>({0, 1, -2, 300, 4, 5}), mask = "\x3f",
                    description = xml({.mask_name = "bindata/valid.bin"});
  const auto in = [&](const std::string& folder, const std::string& main) {
    return archive(
        {{folder + "bindata/data.bin", points}, {folder + "bindata/valid.bin", mask}, {folder + "main.xml", main}});
  };
  const std::vector<std::pair<std::string, std::string>> variants = {
      {"as it is", in("", description)},
      {"a top folder", in("scan 7/", description)},
      {"a deeper folder", in("a/b/", description)},
      {"beside copies deeper down", archive({{"old/main.xml", "<other/>"},
                                             {"main.xml", description},
                                             {"bindata/data.bin", points},
                                             {"bindata/valid.bin", mask}})},
      {"another prefix", in("", replaced(replaced(description, "p:ISO", "x:ISO"), "xmlns:p", "xmlns:x"))},
      {"a prefix everywhere", in("", std::regex_replace(description, std::regex("<(/?)([A-Z])"), "<$1n:$2"))},
      {"no prefix", in("", replaced(replaced(description, "p:ISO", "ISO"), "xmlns:p", "xmlns"))},
      {"root ISO5436", in("", replaced(description, "p:ISO5436_2", "ISO5436"))},
      {"root ISO25178-72", in("t/", replaced(description, "p:ISO5436_2", "iso:ISO25178-72"))},
      {"backslashes", in("", replaced(description, "bindata/", "bindata\\"))},
      {"names with backslashes",
       archive(
           {{"scan\\bindata\\data.bin", points}, {"scan\\bindata\\valid.bin", mask}, {"scan\\main.xml", description}})},
      {"links from the root", in("t/", replaced(description, "bindata/", "/bindata/"))},
      {"links from the root of the archive", in("t/", replaced(description, "bindata/", "t/bindata/"))},
      {"other letters", in("", replaced(description, "bindata/data.bin", "bindata/DATA.bin"))},
      {"no feature type", in("", replaced(description, "<FeatureType>SUR</FeatureType>", ""))}};
  for (const auto& [what, file] : variants) {
    SCOPED_TRACE(what);
    ASSERT_EQ(refusal(file), "none");
    const HeightMap map = parse_height_map(file, "t.x3p");
    ASSERT_EQ(map.z_m.size(), 6u);
    EXPECT_NEAR(map.at(0, 1), 305e-9, 1e-20);
    EXPECT_DOUBLE_EQ(map.step_y_m, 3e-6);
  }
  // Heights that are absolute have no increment: 0 is not their unit.
  const std::string metres = matrix<double>({1e-7, 0, 0, 0, 0, 2e-7});
  EXPECT_EQ(parse_height_map(archive({{"main.xml", xml({.type = "D", .z = "<Increment>0</Increment>"})},
                                      {"bindata/data.bin", metres}}),
                             "t")
                .at(2, 1),
            2e-7);
  EXPECT_THAT(refusal(in("", replaced(replaced(description, "<CZ><AxisType>A", "<CZ><AxisType>I"), "<Increment>1e-9<",
                                      "<Increment>0<"))),
              HasSubstr("step of height of 0"));
  EXPECT_THAT(refusal(in("", replaced(description, ">SUR<", ">PCL<"))), HasSubstr("cloud of points"));
  EXPECT_THAT(refusal(in("", replaced(description, ">SUR<", ">PRF<"))), HasSubstr("profile"));
  EXPECT_THAT(refusal(archive({{"not-main.xml", description}, {"bindata/data.bin", points}})),
              HasSubstr("has no file \"main.xml\""));
}

TEST(HeightMap, WhatIsWrittenIsReadAgain) {
  const tests::ScratchFolder folder;
  const HeightMap map = random_map();
  for (const char* name : {"m.x3p", "m.exr", "m.sur"}) {
    EXPECT_TRUE(writes_height_map(name));
    write_height_map(folder / name, map);
    const HeightMap back = read_height_map(folder / name);
    ASSERT_EQ(back.z_m.size(), 35u) << name;
    EXPECT_NEAR(back.step_x_m / 2e-6, 1, 1e-7);
    EXPECT_NEAR(back.step_y_m / 3e-6, 1, 1e-7);
    for (std::size_t i = 0; i < 35; ++i) {
      if (i == 8)
        EXPECT_TRUE(std::isnan(back.z_m[i])) << name;
      else
        EXPECT_NEAR(back.z_m[i], map.z_m[i], std::string_view(name) == "m.x3p" ? 0 : 2e-13) << name;
    }
  }
  EXPECT_TRUE(is_height_map(read_file(folder / "m.x3p").substr(0, height_map_beginning)));
  const std::string first = read_file(folder / "m.x3p");
  write_height_map(folder / "n.x3p", map);
  EXPECT_EQ(first, read_file(folder / "n.x3p"));
  EXPECT_THROW(write_height_map(folder / "m.opd", map), Error);
}

TEST(HeightMap, PicturesNeedTheirStepAndUnit) {
  cv::Mat floats(3, 4, CV_32F, cv::Scalar(0.5)), codes(3, 4, CV_16U, cv::Scalar(7));
  floats.at<float>(1, 2) = NAN;
  codes.at<std::uint16_t>(2, 3) = 65535;
  const auto tiff = [](const cv::Mat& m) {
    std::vector<unsigned char> bytes;
    cv::imencode(".tiff", m, bytes);
    return std::string(bytes.begin(), bytes.end());
  };
  const HeightMap f = parse_height_map(tiff(floats), "f.tif", {.step_x_m = 1e-6, .step_y_m = 2e-6, .unit_m = 1e-6});
  EXPECT_EQ(f.width, 4u);
  EXPECT_DOUBLE_EQ(f.at(0, 0), 0.5e-6);
  EXPECT_TRUE(std::isnan(f.at(2, 1)));
  const HeightMap c = parse_height_map(tiff(codes), "c.tif", {.step_x_m = 1e-6, .step_y_m = 1e-6, .unit_m = 1e-9});
  EXPECT_DOUBLE_EQ(c.at(3, 2), 65535e-9);
  EXPECT_THAT(refusal(tiff(codes)), HasSubstr("does not say what its numbers count"));
  EXPECT_THAT(refusal(tiff(codes), {.unit_m = 1e-6}), HasSubstr("how far its points lie apart"));
  EXPECT_THAT(refusal(tiff(cv::Mat(3, 4, CV_8U, cv::Scalar(1))), {.step_x_m = 1e-6, .step_y_m = 1e-6, .unit_m = 1}),
              HasSubstr("another kind"));
  EXPECT_THAT(refusal(tiff(codes).substr(0, 60), {.step_x_m = 1e-6, .step_y_m = 1e-6, .unit_m = 1}),
              testing::Ne("none"));
  Image rgb(4, 4, {"R", "G", "B"});
  const std::string exr = encode_exr(rgb);
  EXPECT_THAT(refusal(exr), HasSubstr("none named Z"));
  EXPECT_THAT(refusal(exr, {.channel = "G"}), HasSubstr("how far"));
  EXPECT_EQ(parse_height_map(exr, "e.exr", {.step_x_m = 1e-6, .step_y_m = 1e-6, .channel = "G"}).z_m.size(), 16u);
}

}  // namespace
}  // namespace gonio::io
