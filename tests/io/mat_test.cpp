// MATLAB and NumPy files: round trips, files of other programs, and damaged ones.
#include "io/mat.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <functional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "io/npz.h"

namespace gonio::io {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Kind = MatVariable::Kind;

MatVariable numbers(std::vector<std::size_t> size, std::vector<double> values) {
  MatVariable v;
  v.size = std::move(size);
  v.values = std::move(values);
  return v;
}

MatFile example() {
  MatFile file;
  file["a"] = numbers({2, 3}, {1, 2, 3, 4, 5, 6.25});
  file["b"] = numbers({2, 1, 3}, {1e-300, -0.0, 3, HUGE_VAL, 5, 6});
  file["l"] = numbers({1, 3}, {1, 0, 1});
  file["l"].kind = Kind::logical;
  file["t"].kind = Kind::text;
  file["t"].size = {1, 5};
  file["t"].text = "hello";
  MatVariable& s = file["s"];
  s.kind = Kind::structure;
  s.size = {1, 2};
  s.elements = {{{"x", file["a"]}, {"y", file["t"]}}, {{"x", numbers({1, 1}, {7})}, {"y", file["t"]}}};
  MatVariable& c = file["c"];
  c.kind = Kind::cells;
  c.size = {2, 1};
  c.cells = {numbers({1, 2}, {1, 2}), file["t"]};
  return file;
}

std::string refusal(const std::function<void()>& call, Exit code = Exit::data) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    return error.what();
  }
  return "none";
}

TEST(Mat, RoundTripAndTheSameBytesAgain) {
  const tests::ScratchFolder folder;
  write_mat(example(), folder / "a.mat");
  write_mat(example(), folder / "b.mat");
  EXPECT_EQ(read_file(folder / "a.mat"), read_file(folder / "b.mat"));
  const MatFile back = read_mat(folder / "a.mat"), was = example();
  ASSERT_EQ(back.size(), was.size());
  EXPECT_EQ(back.at("a").values, was.at("a").values);
  EXPECT_THAT(back.at("b").size, ElementsAre(2, 1, 3));
  EXPECT_EQ(back.at("b").values, was.at("b").values);
  EXPECT_EQ(back.at("l").kind, Kind::logical);
  EXPECT_EQ(back.at("l").values, was.at("l").values);
  EXPECT_EQ(back.at("t").text, "hello");
  EXPECT_THAT(back.at("s").size, ElementsAre(1, 2));
  EXPECT_EQ(back.at("s").elements.at(1).at("x").values.at(0), 7);
  EXPECT_EQ(back.at("s").elements.at(0).at("y").text, "hello");
  EXPECT_EQ(back.at("c").cells.at(0).values.at(1), 2);
  EXPECT_EQ(back.at("c").cells.at(1).text, "hello");
}

TEST(Mat, ReadsWhatMatlabWrote) {
  GONIO_NEEDS_DATA("nrsfm/totem_perspective");
  const MatFile file = read_mat(tests::data("nrsfm/totem_perspective/data_cushion.mat"));
  EXPECT_EQ(file.at("p").kind, Kind::structure);
  ASSERT_EQ(file.at("p").elements.size(), 4);
  EXPECT_THAT(file.at("p").elements[3].at("p").size, ElementsAre(3, 80));
  EXPECT_NEAR(file.at("p").elements[0].at("p").values[0], 1315.36792, 1e-5);
  EXPECT_THAT(file.at("v").size, ElementsAre(4, 80));
  const MatFile yoga = read_mat(tests::data("nrsfm/pta_mocap/yoga.mat"));
  EXPECT_EQ(yoga.at("K").values.at(0), 11);
  EXPECT_EQ(yoga.at("filename").text.substr(0, 4), "yoga");
}

TEST(Mat, RefusesDamageInWords) {
  const tests::ScratchFolder folder;
  write_mat(example(), folder / "a.mat");
  const std::string good = read_file(folder / "a.mat");
  const auto refused = [&](const std::string& bytes) {
    write_file(folder / "bad.mat", bytes);
    return refusal([&] { read_mat(folder / "bad.mat"); });
  };
  EXPECT_THAT(refused(good.substr(0, good.size() - 5)), HasSubstr("the file is truncated"));
  EXPECT_THAT(refused(good.substr(0, 132)), HasSubstr("ends within the tag of variable 1"));
  EXPECT_THAT(refused(good.substr(0, 128)), HasSubstr("holds no variable"));
  EXPECT_THAT(refused(good.substr(0, 60)), HasSubstr("60 bytes"));
  EXPECT_THAT(refused(""), HasSubstr("0 bytes"));
  EXPECT_THAT(refused(std::string(500, 'x')), HasSubstr("is no MATLAB file"));
  EXPECT_THAT(refused(good.substr(0, 128) + std::string(64, 'x')), HasSubstr("variable 1 (byte 128) has type"));
  std::string garbage = good;  // inside the first compressed variable
  for (std::size_t i = 140; i < 170; ++i) garbage[i] = static_cast<char>(i * 37);
  EXPECT_THAT(refused(garbage), HasSubstr("bad.mat"));
  EXPECT_THAT(refusal([&] { read_mat(folder / "none.mat"); }, Exit::no_input), HasSubstr("none.mat"));
}

// Any byte of a file changed: an answer or one line, never a crash.
TEST(Mat, SurvivesChangedBytes) {
  const tests::ScratchFolder folder;
  write_mat(example(), folder / "a.mat");
  const std::string good = read_file(folder / "a.mat");
  Random random(5);
  int refused = 0;
  for (int k = 0; k < 150; ++k) {
    std::string bytes = good;
    bytes[random.below(bytes.size())] = static_cast<char>(random.below(256));
    std::ofstream(folder / "bad.mat", std::ios::binary) << bytes;
    try {
      read_mat(folder / "bad.mat");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::data);
      ++refused;
    }
  }
  EXPECT_GT(refused, 30);
}

std::string npy(const std::string& descr, bool fortran, const std::string& shape, const std::string& data) {
  std::string head =
      "{'descr': '" + descr + "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': " + shape + ", }";
  while ((10 + head.size() + 1) % 64 != 0) head += ' ';
  head += '\n';
  return std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(head.size() & 255) +
         static_cast<char>(head.size() >> 8) + head + data;
}

template <class T>
std::string bytes_of(std::vector<T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

TEST(Npz, OrdersTypesAndEndianness) {
  NpyArray a;
  ASSERT_TRUE(parse_npy(npy("<f8", false, "(2, 3)", bytes_of<double>({1, 2, 3, 4, 5, 6})), "a", a));
  EXPECT_THAT(a.size, ElementsAre(2, 3));
  EXPECT_THAT(a.values, ElementsAre(1, 2, 3, 4, 5, 6));
  ASSERT_TRUE(parse_npy(npy("<f4", true, "(2, 3)", bytes_of<float>({1, 4, 2, 5, 3, 6})), "a", a));
  EXPECT_THAT(a.values, ElementsAre(1, 2, 3, 4, 5, 6));
  ASSERT_TRUE(parse_npy(npy(">i2", false, "(2,)", std::string("\x01\x00\xff\xfe", 4)), "a", a));
  EXPECT_THAT(a.values, ElementsAre(256, -2));
  ASSERT_TRUE(parse_npy(npy("|b1", false, "(3,)", std::string("\x01\x00\x01", 3)), "a", a));
  EXPECT_THAT(a.values, ElementsAre(1, 0, 1));
  ASSERT_TRUE(parse_npy(npy("<f2", false, "(3,)", bytes_of<std::uint16_t>({0x3c00, 0xc100, 0x0001})), "a", a));
  EXPECT_THAT(a.values, ElementsAre(1, -2.5, std::ldexp(1, -24)));
  ASSERT_TRUE(parse_npy(npy("<U3", false, "()", std::string("p\0\0\0t\0\0\0a\0\0\0", 12)), "a", a));
  EXPECT_EQ(a.text, "pta");
  EXPECT_FALSE(parse_npy(npy("|O", false, "(2,)", "pickled"), "a", a));
}

TEST(Npz, RefusesDamageInWords) {
  NpyArray a;
  const auto refused = [&a](const std::string& bytes) { return refusal([&] { parse_npy(bytes, "a", a); }); };
  EXPECT_THAT(refused(npy("<f8", false, "(2, 3)", std::string(40, 0))),
              HasSubstr("40 bytes of data where its head makes 48"));
  EXPECT_THAT(refused("NUMPY"), HasSubstr("is no NumPy array"));
  EXPECT_THAT(refused(npy("<c16", false, "(1,)", std::string(16, 0))), HasSubstr("type c16"));
  EXPECT_THAT(refused(npy("<f8", false, "(99999999, 99999999)", "")), HasSubstr("more numbers than a file can hold"));
  EXPECT_THAT(refused(npy("<f8", false, "(2, x)", "")), HasSubstr("cannot be read"));
  EXPECT_THAT(refused(npy("<f8", false, "(2,)", "").substr(0, 40)), HasSubstr("ends within its head"));
  const tests::ScratchFolder folder;
  write_file(folder / "x.npz", "PK\x03\x04 and not much more");
  EXPECT_THAT(refusal([&] { read_npz(folder / "x.npz"); }), HasSubstr("is no whole NumPy archive"));
}

}  // namespace
}  // namespace gonio::io
