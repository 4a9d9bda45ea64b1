// cmake/units.pl: sources share a unit only where neither sees a private name of the other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "data.h"

namespace gonio::tests {
namespace {

// Which unit each source of lib/room came into, by the source's name.
class Units : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder_ / "lib" / name).parent_path());
    std::ofstream(folder_ / "lib" / name) << text;
    if (name.ends_with(".cpp")) group_ += " " + (folder_ / "lib" / name).string();
  }
  std::map<std::string, std::string> grouped(int lines = 1000) {
    std::ofstream(folder_ / "request") << "room" << group_ << "\n";
    const std::string out = (folder_ / "units").string(), lib = (folder_ / "lib").string();
    const std::string call = "perl '" GONIO_SOURCE "/cmake/units.pl' '" + out + "' '" + lib + "' '" + lib + "' " +
                             std::to_string(lines) + " < '" + (folder_ / "request").string() + "' > /dev/null";
    EXPECT_EQ(std::system(call.c_str()), 0);
    std::map<std::string, std::string> unit_of;
    for (const auto& unit : std::filesystem::directory_iterator(out + "/room")) {
      std::ifstream file(unit.path());
      for (std::string line; std::getline(file, line);)
        if (line.starts_with("#include \"") && line.ends_with(".cpp\""))
          unit_of[line.substr(10, line.size() - 11)] = unit.path().filename();
    }
    return unit_of;
  }
  bool together(const std::string& first, const std::string& second) {
    group_.clear();
    write("a.cpp", first);
    write("b.cpp", second);
    const auto unit_of = grouped();
    return unit_of.at("a.cpp") == unit_of.at("b.cpp");
  }

 private:
  ScratchFolder folder_;
  std::string group_;
};

std::string private_in(const std::string& space, const std::string& text) {
  return "namespace " + space + " {\nnamespace {\n" + text + "\n}\nint open_" + std::to_string(text.size()) +
         "() { return 1; }\n}\n";
}

TEST_F(Units, NamesThatNobodyElseMentionsShareAUnit) {
  EXPECT_TRUE(together(private_in("g", "int one() { return 1; }"), private_in("g", "int two_() { return 2; }")));
}

TEST_F(Units, TheSamePrivateNameTwiceDoesNot) {
  for (const char* text :
       {"struct cell { int x; };", "int cell(int a = 0) { return a; }", "constexpr double a = 1, cell = 2;",
        "enum { first, cell };", "[[noreturn]] void cell(const char* why = {}) { throw why; }",
        "template <class T> T cell(T t) { return t; }", "const int cell[] = {1, 2};", "using cell = int;",
        "bool operator==(A, A) { return true; }\nint cell() { return 1; }"})
    EXPECT_FALSE(together(private_in("g", text), private_in("g", "double cell(double x) { return x; }"))) << text;
}

TEST_F(Units, APrivateNameThatTheOtherMentionsDoesNotEither) {
  // Alone, the second calls g::mean of a header; behind the first it would call another function.
  const std::string mean = "double mean(double x) { return x; }";
  EXPECT_FALSE(together(private_in("g", mean), "namespace g { int f() { return mean(1); } }\n"));
  EXPECT_TRUE(together(private_in("g", mean), "namespace g { int f(S s) { return s.mean(1); } }\n"))
      << "a member is another name";
  EXPECT_TRUE(together(private_in("g::x", mean), "namespace g::y { int f() { return mean(1); } }\n"))
      << "the one namespace is not seen from the other";
  EXPECT_FALSE(together("#define mean 1\n", "namespace g::y { int f() { return mean; } }\n"));
}

TEST_F(Units, AHeaderThatOneBringsAlongMayNotDeclareWhatIsPrivateInTheOther) {
  write("h.h", "#pragma once\nnamespace g { double size_of(int); }\n");
  EXPECT_FALSE(together("#include \"h.h\"\nnamespace g { int f() { return 1; } }\n",
                        private_in("g", "double size_of(double x) { return x; }")));
}

TEST_F(Units, TheSameAliasTwiceIsNoCollision) {
  const auto source = [](const std::string& space, const std::string& name) {
    return "namespace g { using " + space + "::Value;\nint " + name + "() { return Value(); } }\n";
  };
  EXPECT_TRUE(together(source("m", "first"), source("m", "second")));
  EXPECT_FALSE(together(source("m", "first"), source("n", "second")));
}

TEST_F(Units, AWholeNamespaceIsTakenInBesideSourcesThatUseNoneOfItsNames) {
  write("n.h", "#pragma once\nnamespace n { int size(int); int run(int); }\n");
  write("o.h", "#pragma once\nnamespace g { int run(int); }\n");
  const std::string all = "#include \"n.h\"\nnamespace g { using namespace n; int f() { return size(1); } }\n";
  EXPECT_TRUE(together(all, "namespace g { int f2() { return length(1); } }\n"));
  EXPECT_FALSE(together(all, "namespace g { int f2() { return size(1); } }\n"));
  EXPECT_FALSE(together("#include \"n.h\"\nnamespace g { using namespace n; using namespace m; int f(); }\n",
                        "namespace g { int f2() { return size(1); } }\n"))
      << "the second of two";
  EXPECT_TRUE(together(all, "#include \"o.h\"\nnamespace g { int f2() { return run(1); } }\n"))
      << "the namespace's own run hides the other";
}

TEST_F(Units, EverySourceIsInOneUnitOfAboutTheLength) {
  for (int i = 0; i < 12; ++i) {
    const std::string n = std::to_string(i);
    write("s" + n + ".cpp", "namespace g { int f" + n + "(); }\n" + std::string(99, '\n'));
  }
  const auto unit_of = grouped(400);
  EXPECT_EQ(unit_of.size(), 12u);
  std::map<std::string, int> count;
  for (const auto& [source, unit] : unit_of) ++count[unit];
  EXPECT_EQ(count.size(), 3u);
  for (const auto& [unit, sources] : count) EXPECT_EQ(sources, 4) << unit;
}

}  // namespace
}  // namespace gonio::tests
