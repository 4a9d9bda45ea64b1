// MERL tables: round trip, and damaged files.
#include "io/merl.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/random.h"
#include "data.h"

namespace gonio::io {
namespace {

MerlTable random_table() {
  MerlTable table{{3, 4, 5}, {}};
  Random random(6);
  for (int i = 0; i < 180; ++i) table.brdf_per_sr.push_back(static_cast<float>(random.normal()));
  return table;
}

std::string refusal(std::string_view bytes) {
  try {
    parse_merl(bytes, "t.binary");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data);
    return error.problem();
  }
  return "none";
}

TEST(Merl, RoundTrip) {
  const tests::ScratchFolder folder;
  const MerlTable table = random_table();
  write_merl(folder / "t.binary", table);
  const MerlTable back = read_merl(folder / "t.binary");
  EXPECT_EQ(back.bins, table.bins);
  ASSERT_EQ(back.brdf_per_sr.size(), table.brdf_per_sr.size());
  for (std::size_t i = 0; i < table.brdf_per_sr.size(); ++i) ASSERT_FLOAT_EQ(back.brdf_per_sr[i], table.brdf_per_sr[i]);
}

// Planes of red, green, blue one after the other; 1 / 1500, 1.15 / 1500, 1.66 / 1500.
TEST(Merl, LayoutAndFactors) {
  std::string bytes(12 + 24 * 8, '\0');
  const std::int32_t bins[] = {2, 2, 2};
  std::memcpy(bytes.data(), bins, 12);
  const auto put = [&](std::size_t i, double v) { std::memcpy(bytes.data() + 12 + 8 * i, &v, 8); };
  put(1, 1500);      // red of phi_d bin 1
  put(8 + 2, 3000);  // green of theta_d bin 1
  put(16 + 4, -1);   // blue of theta_h bin 1: not measured
  const MerlTable table = parse_merl(bytes, "t");
  EXPECT_FLOAT_EQ(table.brdf_per_sr[3 * 1], 1);
  EXPECT_FLOAT_EQ(table.brdf_per_sr[3 * 2 + 1], 2.3f);
  EXPECT_LT(table.brdf_per_sr[3 * 4 + 2], 0);
  put(0, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(refusal(bytes), testing::HasSubstr("entry 0 is not a finite reflectance"));
}

TEST(Merl, DamagedFilesAreRefusedBeforeTheyAreBelieved) {
  const tests::ScratchFolder folder;
  write_merl(folder / "t.binary", random_table());
  std::string bytes = read_file(folder / "t.binary");
  for (const std::size_t length : {std::size_t{0}, std::size_t{11}, std::size_t{12}, bytes.size() - 1})
    EXPECT_NE(refusal(bytes.substr(0, length)), "none") << length;
  EXPECT_THAT(refusal(bytes + "x"), testing::HasSubstr("bytes where"));
  const std::int32_t huge[] = {4096, 4096, 4096}, negative[] = {-1, 4, 5};
  std::memcpy(bytes.data(), huge, 12);
  EXPECT_THAT(refusal(bytes), testing::HasSubstr("bytes where 1649267441676 hold"));
  std::memcpy(bytes.data(), negative, 12);
  EXPECT_THAT(refusal(bytes), testing::HasSubstr("claims -1 bins"));
}

}  // namespace
}  // namespace gonio::io
