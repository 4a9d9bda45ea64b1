// NAME=VALUE and lists as people type them.
#include "base/assignment.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace gonio {
namespace {

TEST(Assignment, PartsAtTheFirstEqualsSign) {
  EXPECT_EQ(parse_assignment("alpha=0.1", "--set", ""), std::pair(std::string("alpha"), std::string("0.1")));
  EXPECT_EQ(parse_assignment("model=a=b", "--set", "").second, "a=b");
}

TEST(Assignment, NeedsBothSides) {
  for (const char* text : {"", "alpha", "=1", "alpha=", "="}) try {
      parse_assignment(text, "--set", "write --set alpha=0.1");
      ADD_FAILURE() << text;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::usage);
      EXPECT_EQ(std::string(e.what()), "--set: \"" + std::string(text) + "\" is not NAME=VALUE; write --set alpha=0.1");
    }
}

TEST(Assignment, PiecesKeepEmptyPlaces) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(pieces("a,b", ','), (Words{"a", "b"}));
  EXPECT_EQ(pieces("a,,b,", ','), (Words{"a", "", "b", ""}));
  EXPECT_EQ(pieces("", ','), (Words{""}));
}

}  // namespace
}  // namespace gonio
