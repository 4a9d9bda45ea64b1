// PLY: round trips in every encoding, damaged files, and the recorded bunny.
#include "io/ply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/random.h"
#include "data.h"

namespace gonio::io {
namespace {

TriangleMesh random_mesh(std::uint32_t vertices, std::uint32_t triangles, bool normals, bool texture) {
  Random random(vertices + triangles);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < vertices; ++i) {
    mesh.positions_m.push_back({random.normal() * 1e-3, random.normal(), random.normal() * 1e6});
    if (normals) mesh.normals.push_back(normalized(Vec3{random.normal(), random.normal(), random.normal()}));
    if (texture) mesh.texture.push_back({random.uniform(), random.uniform()});
  }
  for (std::uint32_t i = 0; i < triangles; ++i)
    mesh.triangles.push_back({random.below(vertices), random.below(vertices), random.below(vertices)});
  return mesh;
}

std::string refusal(std::string_view bytes) {
  try {
    parse_ply(bytes, "mesh.ply");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.problem();
  }
  ADD_FAILURE() << "accepted: " << bytes.substr(0, 300);
  return {};
}

TEST(Ply, RoundTripKeepsEveryBit) {
  const tests::ScratchFolder folder;
  for (const bool normals : {false, true})
    for (const bool texture : {false, true}) {
      const TriangleMesh mesh = random_mesh(200, 371, normals, texture);
      write_ply(folder / "a.ply", mesh);
      const TriangleMesh back = read_ply(folder / "a.ply");
      EXPECT_EQ(back.positions_m, mesh.positions_m);
      EXPECT_EQ(back.normals, mesh.normals);
      EXPECT_EQ(back.texture, mesh.texture);
      EXPECT_EQ(back.triangles, mesh.triangles);
    }
}

TEST(Ply, PropertiesAndLabelsThatWereAskedFor) {
  const tests::ScratchFolder folder;
  TriangleMesh mesh = random_mesh(50, 60, true, true);
  const PlyWish wish{.properties = {"roughness", "heat"}, .labels = true};
  mesh.properties.resize(2);
  Random random(3);
  for (int i = 0; i < 50; ++i)
    for (auto& property : mesh.properties) property.push_back(static_cast<float>(random.normal()));
  for (int i = 0; i < 60; ++i) mesh.labels.push_back(static_cast<std::int32_t>(random.below(9)) - 4);
  write_ply(folder / "a.ply", mesh, wish);
  const TriangleMesh back = read_ply(folder / "a.ply", wish);
  EXPECT_EQ(back.properties, mesh.properties);
  EXPECT_EQ(back.labels, mesh.labels);
  EXPECT_EQ(back.texture, mesh.texture);
  const TriangleMesh plain = read_ply(folder / "a.ply");
  EXPECT_TRUE(plain.properties.empty() && plain.labels.empty());
  EXPECT_EQ(plain.triangles, mesh.triangles);
  const TriangleMesh other = read_ply(folder / "a.ply", {.properties = {"cold", "heat"}});
  EXPECT_TRUE(other.properties[0].empty());
  EXPECT_EQ(other.properties[1], mesh.properties[1]);
}

constexpr std::string_view coloured =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty uchar wear\nproperty float heat\n"
    "element face 2\nproperty int label\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 0 0 1.5\n1 0 0 255 51 2.5\n1 1 0 128 255 3.5\n0 1 0 10 0 4.5\n"
    "7 4 0 1 2 3\n-2 3 0 1 2\n";

// The sRGB code 128 is 0.21586 linear (IEC 61966-2-1).
TEST(Ply, BytesAreSharesAndColoursLinear) {
  const TriangleMesh mesh = parse_ply(coloured, "mesh.ply", {.properties = {"red", "wear", "heat"}, .labels = true});
  EXPECT_EQ(mesh.properties[0][1], 1);
  EXPECT_NEAR(mesh.properties[0][2], 0.21586, 1e-5);
  EXPECT_FLOAT_EQ(mesh.properties[1][1], 0.2f);
  EXPECT_EQ(mesh.properties[2], (std::vector<float>{1.5f, 2.5f, 3.5f, 4.5f}));
  EXPECT_EQ(mesh.labels, (std::vector<std::int32_t>{7, 7, -2}));  // both halves of the square carry its label
}

TEST(Ply, LabelsAreIntegers) {
  std::string text(coloured);
  text.replace(text.find("int label"), 9, "float label");
  text.replace(text.rfind("-2 3"), 2, "0.5");
  try {
    parse_ply(text, "mesh.ply", {.properties = {}, .labels = true});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("face 1 of 2 has the label 0.5"));
  }
  EXPECT_EQ(parse_ply(text, "mesh.ply").triangles.size(), 3u);  // nobody asked
}

TEST(Ply, TruncationIsRefusedEverywhere) {
  const tests::ScratchFolder folder;
  write_ply(folder / "a.ply", random_mesh(100, 150, true, false));
  const std::string bytes = read_file(folder / "a.ply");
  for (std::size_t tenth = 0; tenth < 10; ++tenth) refusal(bytes.substr(0, bytes.size() * tenth / 10));
  refusal(bytes.substr(0, bytes.size() - 1));
}

constexpr const char* ascii_square = R"(ply
format ascii 1.0
comment a square with a colour and a polygon of four corners
element vertex 4
property float x
property float y
property double z
property uchar red
element patch 2
property list uchar float weights
element face 1
property list uchar int vertex_indices
end_header
0 0 0 255
1 0 0.1234567890123456 255
1 1 0 255
0 1 0 255
2 0.5 0.5
0
4 0 1 2 3
)";

TEST(Ply, AsciiWithUnknownElementsAndAPolygon) {
  const tests::ScratchFolder folder;
  write_file(folder / "a.ply", ascii_square);
  const TriangleMesh mesh = read_ply(folder / "a.ply");
  EXPECT_EQ(mesh.positions_m.size(), 4u);
  EXPECT_EQ(mesh.positions_m[1].z, 0.1234567890123456);
  EXPECT_TRUE(mesh.normals.empty());
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_THAT(mesh.triangles[0], testing::ElementsAre(0, 1, 2));
  EXPECT_THAT(mesh.triangles[1], testing::ElementsAre(0, 2, 3));
}

TEST(Ply, BigEndian) {
  const tests::ScratchFolder folder;
  std::string bytes =
      "ply\r\nformat binary_big_endian 1.0\r\nelement vertex 3\r\nproperty short x\r\nproperty float y\r\n"
      "property double z\r\nelement face 1\r\nproperty list ushort uint vertex_index\r\nend_header\r\n";
  const auto append = [&](auto value) {
    const auto raw = std::bit_cast<std::array<char, sizeof(value)>>(value);
    bytes.append(raw.rbegin(), raw.rend());
  };
  for (int i = 0; i < 3; ++i) {
    append(static_cast<std::int16_t>(-i));
    append(0.5f * static_cast<float>(i));
    append(0.1 * i);
  }
  append(std::uint16_t{3});
  for (std::uint32_t i = 0; i < 3; ++i) append(2 - i);
  write_file(folder / "a.ply", bytes);
  const TriangleMesh mesh = read_ply(folder / "a.ply");
  EXPECT_EQ(mesh.positions_m[2], (Vec3{-2, 1, 0.2}));
  EXPECT_THAT(mesh.triangles[0], testing::ElementsAre(2, 1, 0));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(Ply, RefusalsNameTheElementAndTheLimit) {
  const std::string square = ascii_square;
  using testing::HasSubstr;
  EXPECT_THAT(refusal(replaced(square, "vertex 4", "vertex 1000000000000")), HasSubstr("1000000000000"));
  EXPECT_THAT(refusal(replaced(square, "vertex 4", "vertex 18446744073709551615")), HasSubstr("cannot hold"));
  EXPECT_THAT(refusal(replaced(square, "vertex 4", "vertex 99999999999999999999")), HasSubstr("no number"));
  EXPECT_THAT(refusal(replaced(square, "vertex 4", "vertex -4")), HasSubstr("no number"));
  EXPECT_THAT(refusal(replaced(square, "vertex 4", "vertex 0")), HasSubstr("no vertices"));
  EXPECT_THAT(refusal(replaced(square, "1 1 0 255", "1 nan 0 255")), HasSubstr("vertex 2 of 4 has nan for y"));
  EXPECT_THAT(refusal(replaced(square, "1 1 0 255", "1 inf 0 255")), HasSubstr("inf"));
  EXPECT_THAT(refusal(replaced(square, "1 1 0 255", "1 one 0 255")), HasSubstr("'one'"));
  EXPECT_THAT(refusal(replaced(square, "0 1 2 3", "0 1 2 4")), HasSubstr("face 0 of 1 names vertex 4"));
  EXPECT_THAT(refusal(replaced(square, "0 1 2 3", "0 -1 2 3")), HasSubstr("vertex -1"));
  EXPECT_THAT(refusal(replaced(square, "4 0 1 2 3", "2 0 1")), HasSubstr("2 corners"));
  EXPECT_THAT(refusal(replaced(square, "4 0 1 2 3", "1e9 0 1 2 3")), HasSubstr("more than the file holds"));
  EXPECT_THAT(refusal(replaced(square, "float x", "float w")), HasSubstr("lacks x, y or z"));
  EXPECT_THAT(refusal(replaced(square, "float x", "half x")), HasSubstr("half"));
  EXPECT_THAT(refusal(replaced(square, "format ascii 1.0\n", "")), HasSubstr("no format"));
  EXPECT_THAT(refusal(replaced(square, "vertex_indices", "corners")), HasSubstr("vertex_indices"));
  EXPECT_THAT(refusal("solid square"), HasSubstr("not a PLY"));
  EXPECT_THAT(refusal(""), HasSubstr("not a PLY"));
}

TEST(Ply, DamagedBytesNeverHarm) {
  const tests::ScratchFolder folder;
  write_ply(folder / "a.ply", random_mesh(10, 12, true, true));
  const std::string binary = read_file(folder / "a.ply");
  Random random(11);
  for (const std::string& whole : {binary, std::string(ascii_square)})
    for (int k = 0; k < 2000; ++k) {
      std::string damaged = whole;
      for (int hit = 0; hit < 3; ++hit)
        damaged[random.below(static_cast<std::uint32_t>(damaged.size()))] = static_cast<char>(random.below(256));
      try {
        const TriangleMesh mesh = parse_ply(damaged, "damaged.ply");
        for (const auto& triangle : mesh.triangles)
          for (const auto index : triangle) EXPECT_LT(index, mesh.positions_m.size());
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), Exit::data);
      }
    }
}

TEST(Ply, TheRecordedBunny) {
  GONIO_NEEDS_DATA("recordings/bunny.ply");
  const TriangleMesh mesh = read_ply(tests::data("recordings/bunny.ply"));
  EXPECT_GT(mesh.positions_m.size(), 10000u);
  EXPECT_GT(mesh.triangles.size(), 20000u);
}

}  // namespace
}  // namespace gonio::io
