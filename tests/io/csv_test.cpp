// CSV after RFC 4180, and a place for everything that is wrong.
#include "io/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"

namespace gonio::io {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string refusal(const std::string& text) {
  try {
    parse_csv(text, "t.csv");
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    return e.what();
  }
  return "accepted";
}

TEST(Csv, ReadsQuotesBlanksLineEndsMarksAndComments) {
  const Csv csv =
      parse_csv("\xef\xbb\xbf# made by hand\n a , \"b \"\"x\"\"\" ,c\r\n1, 2,3\r\n\n4,\"5,\n5\",6", "t.csv");
  EXPECT_THAT(csv.header, ElementsAre("a", "b \"x\"", "c"));
  ASSERT_EQ(csv.rows.size(), 2u);
  EXPECT_THAT(csv.rows[0], ElementsAre("1", "2", "3"));
  EXPECT_THAT(csv.rows[1], ElementsAre("4", "5,\n5", "6"));
  EXPECT_EQ(csv.place(0), "t.csv:3");
  EXPECT_EQ(csv.place(1), "t.csv:5");
}

TEST(Csv, SaysWhereItStopsBeingATable) {
  EXPECT_THAT(refusal(""), HasSubstr("t.csv: is empty"));
  EXPECT_THAT(refusal("a,b\n"), HasSubstr("a header and no rows"));
  EXPECT_THAT(refusal("a,a\n1,2\n"), HasSubstr("t.csv:1: names column \"a\" twice"));
  EXPECT_THAT(refusal("a,\n1,2\n"), HasSubstr("t.csv:1: column 2 has no name"));
  EXPECT_THAT(refusal("a;b\n1;2\n"), HasSubstr("has no comma"));
  EXPECT_THAT(refusal("a,b\n1,2\n1,2,3\n"), HasSubstr("t.csv:3: has 3 fields, the header names 2"));
  EXPECT_THAT(refusal("a,b\n\"1\"x,2\n"), HasSubstr("t.csv:2: has text behind a closing quote"));
  EXPECT_THAT(refusal(std::string("a,b\n1,\0", 7)), HasSubstr("zero byte"));
}

TEST(Csv, NumbersAreWholeAndFinite) {
  EXPECT_EQ(csv_number("-1.5e-3", ""), -1.5e-3);
  EXPECT_EQ(csv_number("+2", ""), 2);
  for (const char* bad : {"", "1,5", "1 mm", "nan", "inf", "0x10", "1e999"})
    EXPECT_THROW(csv_number(bad, "here"), Error) << bad;
}

// Ten thousand texts of the characters that matter: a table, or Error(data).
TEST(Csv, AnyTextIsATableOrRefused) {
  Random random(7, 7);
  constexpr char letters[] = {',', '"', '\n', '\r', ' ', 'a', '1', '#'};
  for (int n = 0; n < 10000; ++n) {
    std::string text;
    for (std::uint32_t k = random.below(24); k > 0; --k) text += letters[random.below(sizeof letters)];
    try {
      const Csv csv = parse_csv(text, "t.csv");
      for (const auto& row : csv.rows) ASSERT_EQ(row.size(), csv.header.size()) << text;
    } catch (const Error& e) {
      ASSERT_EQ(e.code(), Exit::data) << text;
    }
  }
}

}  // namespace
}  // namespace gonio::io
